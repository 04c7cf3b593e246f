"""State of a tissue at one time, and the numbers of a run: plain values, without a rule."""
