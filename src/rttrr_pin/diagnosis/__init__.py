"""Why two programs differ: the cause, or the smallest set of causes, that brings the difference down to rounding."""
