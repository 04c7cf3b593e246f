"""The methods of the maps. Distances are in units of a diameter, so tolerances of 1e-9 are far below all else."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import dincl
from dincl.schemes.base import TimeStepping

TOL = 1e-9
# dt times the strength of tied springs: stable for |J J^T| < 6.6, so for every packing of discs.
TIED = 0.3
# The strength of the force as printed; it holds loads below this one only [length / time].
PUSH = 10.0


@dataclass(frozen=True)
class Contestant:
    """A label for readers, and dt [time] -> the scheme."""

    label: str
    scheme: Callable[[float], TimeStepping]


def _pbd(sweeps: int) -> Contestant:
    words = "PBD" if sweeps == 1 else f"PBD, {sweeps} sweeps"
    return Contestant(words, lambda dt: dincl.PBD(dt=dt, sweeps=sweeps))


def _catch_up(projection: dincl.Projection) -> Contestant:
    return Contestant(f"catch-up, {type(projection).__name__}", lambda dt: dincl.CatchUp(dt=dt, projection=projection))


def _linearised(projection: dincl.Projection) -> Contestant:
    return Contestant(
        f"linearised, {type(projection).__name__}", lambda dt: dincl.LinearisedCatchUp(dt=dt, projection=projection)
    )


CONTESTANTS = {
    "pbd": _pbd(1),
    "pbd_4": _pbd(4),
    "pbd_16": _pbd(16),
    "second_order": Contestant("second-order PBD", lambda dt: dincl.SecondOrderPBD(dt=dt)),
    "catch_up_ipopt": _catch_up(dincl.Ipopt(tol=TOL)),
    "catch_up_daqp": _catch_up(dincl.Daqp(tol=TOL)),
    "linearised_daqp": _linearised(dincl.Daqp(tol=TOL)),
    "linearised_gauss_seidel": _linearised(dincl.GaussSeidel(tol=TOL)),
    "linearised_clarabel": _linearised(dincl.Clarabel(tol=TOL)),
    "penalty_tied": Contestant(f"springs, {TIED:g}/dt", lambda dt: dincl.Penalty(dt=dt, strength=TIED / dt)),
    "penalty_100": Contestant("springs, 100", lambda dt: dincl.Penalty(dt=dt, strength=100.0)),
    "penalty_printed": Contestant(
        f"force as printed, {PUSH:g}", lambda dt: dincl.Penalty(dt=dt, strength=PUSH, exponent=1)
    ),
}


def named(*names: str) -> Mapping[str, str]:
    """The labels of contestants."""
    return {name: CONTESTANTS[name].label for name in names}
