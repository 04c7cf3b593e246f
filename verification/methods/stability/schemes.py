"""The methods of the maps, and what a map is. Distances are in units of a diameter, tolerances far below."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

import dincl
from dincl import FixedStep
from dincl.study import Study
from verification.instruments.stability import StabilityRuns

TOL = 1e-9
# dt times the strength of tied springs: stable for |J J^T| < 6.6, so for every packing of discs.
TIED = 0.3
# The strength of the force as printed; it holds loads below this one only [length / time].
PUSH = 10.0
Maker = Callable[..., FixedStep]


def tied(dt: float) -> dincl.Penalty:
    """Return springs as strong as steps of this length allow."""
    return dincl.Penalty(dt=dt, strength=TIED / dt)


# Label -> dt -> scheme.
SCHEMES: Mapping[str, Maker] = {
    "PBD": dincl.PBD,
    "PBD with 4 sweeps": partial(dincl.PBD, sweeps=4),
    "PBD with 16 sweeps": partial(dincl.PBD, sweeps=16),
    "XPBD with 16 sweeps": partial(dincl.XPBD, sweeps=16),
    "second-order PBD": dincl.SecondOrderPBD,
    "catch-up with Ipopt": partial(dincl.CatchUp, projection=dincl.Ipopt(tol=TOL)),
    "catch-up with Daqp": partial(dincl.CatchUp, projection=dincl.Daqp(tol=TOL)),
    "linearised with Daqp": partial(dincl.LinearisedCatchUp, projection=dincl.Daqp(tol=TOL)),
    "midpoint with Daqp": partial(dincl.MidpointCatchUp, projection=dincl.Daqp(tol=TOL)),
    f"springs of {TIED:g}/dt": tied,
    "springs of 100": partial(dincl.Penalty, strength=100.0),
    f"force as printed of {PUSH:g}": partial(dincl.Penalty, strength=PUSH, exponent=1),
}


def some(*labels: str) -> dict[str, Maker]:
    """Return the schemes of these labels."""
    return {label: SCHEMES[label] for label in labels}


@dataclass(frozen=True)
class Map:
    """A map of the page.

    Attributes
    ----------
    name, title
        Of its table, ``stability_<name>``, and of its study.
    runs
        The runs.
    """

    name: str
    title: str
    runs: StabilityRuns

    def study(self, smallest: bool = False) -> Study:
        """Return the runs as a study."""
        return self.runs.study(f"stability_{self.name}", f"Map: {self.title}", smallest)


def geometric(low: float, high: float, count: int) -> tuple[float, ...]:
    """Return ``count`` values from low to high with equal ratios."""
    return tuple(float(value) for value in np.geomspace(low, high, count))
