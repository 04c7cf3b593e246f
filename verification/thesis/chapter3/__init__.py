"""Studies of the tissue: one file for each, and what they share."""
