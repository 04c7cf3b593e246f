"""Limits of the numbers that are computed with; compiled code has them, too, and nothing else of ``checks``."""

# Coordinates beyond this overflow when distances are squared.
LARGEST = 1e100
# Lengths, tolerances and steps below this vanish when they are squared.
SMALLEST = 1 / LARGEST
# Rows of length 1 with a combination sum_k mu_k a_k, mu >= 0 of sum 1, not longer than OPPOSITE, fifty roundings, are
# opposite to each other: they enclose a slab or nothing. With one not longer than NARROW they enclose a wedge, in which
# rounding and tolerances count 10^4 times in the position, or more.
OPPOSITE, NARROW = 1e-14, 1e-4
# The largest index, and the largest number that compiled loops count to.
LARGEST_INTEGER = 2**63 - 1
