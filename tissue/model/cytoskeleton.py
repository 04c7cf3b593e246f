"""A cap on the length that the cytoskeleton of a cell grows to.

Without a cap, rest lengths follow the springs wherever they go, (3.2), (3.3): in the long run a cell resists no
length. The public programs of the author cap rest lengths, too, not distances. A constraint |A - X| <= L would be
another set S: it competes with (C1) in a crowd, so that S may be empty, and its sweep moves nuclei that discs have just
parted. A cap of the rest lengths leaves S as it is, and the energy, of which they are coefficients: so minimisers and
the judge need nothing new. Beyond the cap a cell is an elastic spring, in place of one that gives way.

Those programs relax both rest lengths once more in a dt, towards shares of L, where their sum is above L by more than
R_soft. There the sum ends in the middle between L and what the springs want, however long that is: no cap. Here it is
what they want that is capped.
"""

from __future__ import annotations

from dincl.compiled import inner
from tissue.events.known import FIRST

# The bits of these events.
A, B = 1 << FIRST.index("a"), 1 << FIRST.index("b")


@inner
def capped(wanted_ax: float, wanted_bx: float, events: int, largest: float) -> tuple[float, float]:
    """The desired rest lengths eta* of both springs, scaled so that their sum is ``largest`` at most; inf for no cap.

    The spring to a point that is free, after [A] or [B], wants 0 in place of its eta*. With equal rates k a sum of rest
    lengths that is below the cap stays so; one that begins above it relaxes to it.
    """
    total = (0.0 if events & A else wanted_ax) + (0.0 if events & B else wanted_bx)
    if total > largest:
        return wanted_ax * (largest / total), wanted_bx * (largest / total)
    return wanted_ax, wanted_bx
