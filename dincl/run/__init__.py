"""A run: the grid of times, the loop over the steps, and what lies between the kept times."""
