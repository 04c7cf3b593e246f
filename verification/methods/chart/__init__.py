"""The chart of speed against accuracy, with baselines and references for large scenes."""
