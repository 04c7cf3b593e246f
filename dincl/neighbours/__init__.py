"""Pairs of discs that are close to each other, and how far searches look beyond what is needed now.

A list of pairs or rows is made for more than the search radius asked for and serves until particles and sets have moved
by the difference. All factors of this policy stand here; ``lists`` applies them to discs, ``dincl.steps.programs``,
``dincl.events.location`` and ``dincl.constraints.selection`` to rows.
"""

# Up to this number of discs comparing all pairs is faster than a grid (measured for d = 2 and 3).
ALL_PAIRS = 90
# The skin of a list of discs in smallest radii: the first one, and the widest.
FIRST_SKIN, WIDEST_SKIN = 0.05, 1.0
# A list of discs is to serve this many sweeps, at least and at most: the skin is doubled or halved.
FEWEST_SWEEPS, MOST_SWEEPS = 16, 128
# Rows are listed for this many times the radius that a step needs.
ROW_MARGIN = 4.0
# The same for the search for events, where the steps between events are short; and the factor from which on a list is
# too long to be kept.
EVENT_MARGIN, TOO_WIDE = 100.0, 400.0
