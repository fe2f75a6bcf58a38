"""What a program may do otherwise than the recursion: hypotheses, as data, and errors in the recursion itself."""
