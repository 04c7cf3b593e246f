"""Runs of the first-order model: the start, batches of runs side by side, their results as tables."""
