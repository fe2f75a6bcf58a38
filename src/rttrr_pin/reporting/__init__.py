"""What the features' reports share: output, progress, JSON, files, LaTeX."""
