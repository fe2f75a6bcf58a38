"""From the text of an equation to its terms, each with every way it can be read."""
