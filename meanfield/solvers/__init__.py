"""Ways from a start to a motion, one per file, and what they share."""
