"""The file: where it comes from, its words, what it may say, and the model that it describes."""
