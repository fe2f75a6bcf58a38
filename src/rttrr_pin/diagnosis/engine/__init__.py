"""Which hypotheses explain a difference: evidence, predictions, search."""
