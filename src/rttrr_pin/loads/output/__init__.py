"""Files that loads are written to, in blocks, whole or not at all."""
