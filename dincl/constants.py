"""Limits of the numbers that are computed with; compiled code has them, too, and nothing else of ``checks``."""

# Coordinates beyond this overflow when distances are squared.
LARGEST = 1e100
# Lengths, tolerances and steps below this vanish when they are squared.
SMALLEST = 1 / LARGEST
# The largest index, and the largest number that compiled loops count to.
LARGEST_INTEGER = 2**63 - 1
