"""Solutions with proved bounds, of exact and of random scenes."""
