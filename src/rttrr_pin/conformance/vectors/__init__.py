"""Vectors: states and proven true values as files."""
