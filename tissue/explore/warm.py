"""The kernels, compiled or read before the first visitor waits for them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dincl.compiled.lanes import WIDTH
from tissue.explore.frames import stream
from tissue.study.outcomes import outcomes

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters

MAKES_NO_NUMBERS = True


def warm_up(parameters: Parameters) -> None:
    """Make a few steps of all that the page runs; on a new machine this compiles for half a minute."""
    brief = parameters.changed(
        {"numerics.t_end": str(parameters.numerics.dt), "numerics.keep": str(parameters.numerics.dt)}
    )
    for _ in stream(brief, 0):
        pass
    outcomes(brief, range(WIDTH), range(WIDTH))
