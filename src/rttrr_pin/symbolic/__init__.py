"""Closed forms: the specification run on symbols."""
