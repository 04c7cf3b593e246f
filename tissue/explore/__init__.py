"""The page to explore: parameters on the left, the tissue in motion, and the answer of an ensemble."""

MAKES_NO_NUMBERS = True
