"""The state of a tissue, its numbers, its energy, and what is measured of it."""
