"""What a tissue is at one time, and the numbers of a run: plain values, without a rule."""
