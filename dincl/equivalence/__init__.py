"""Whether a simpler model answers as a full one does: tests of paired runs, bounds of errors, the simplest model."""
