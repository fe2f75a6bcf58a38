"""Motion over time: read from files, differentiated, or made; in blocks, so that it may be larger than memory."""
