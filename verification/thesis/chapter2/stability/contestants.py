"""The methods of the maps. Distances are in units of a diameter, so tolerances of 1e-9 are far below all else."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import dincl
from dincl import FixedStep
from verification.thesis.chapter2 import methods
from verification.thesis.chapter2.methods import NamedMethod

TOL = 1e-9
# dt times the strength of tied springs: stable for |J J^T| < 6.6, so for every packing of discs.
TIED = 0.3
# The strength of the force as printed; it holds loads below this one only [length / time].
PUSH = 10.0


@dataclass(frozen=True)
class Contestant:
    """A label for readers, dt [time] -> the scheme, and the look, that of the same method elsewhere."""

    label: str
    scheme: Callable[[float], FixedStep]
    colour: str
    marker: str | tuple[int, int, int]


def _as(method: NamedMethod, label: str, scheme: Callable[[float], FixedStep]) -> Contestant:
    return Contestant(label, scheme, method.colour, method.marker)


def _catch_up(method: NamedMethod, projection: dincl.Projection) -> Contestant:
    label = f"catch-up with {type(projection).__name__}"
    return _as(method, label, lambda dt: dincl.CatchUp(dt=dt, projection=projection))


def _linearised(projection: dincl.Projection, colour: str, marker: str | tuple[int, int, int]) -> Contestant:
    label = f"linearised with {type(projection).__name__}"
    return Contestant(label, lambda dt: dincl.LinearisedCatchUp(dt=dt, projection=projection), colour, marker)


CONTESTANTS = {
    "pbd": _as(methods.PBD, "PBD", lambda dt: dincl.PBD(dt=dt)),
    "pbd_4": Contestant("PBD with 4 sweeps", lambda dt: dincl.PBD(dt=dt, sweeps=4), "#e8834a", "H"),
    "pbd_16": _as(methods.PBD_16, "PBD with 16 sweeps", lambda dt: dincl.PBD(dt=dt, sweeps=16)),
    "xpbd_16": Contestant("XPBD with 16 sweeps", lambda dt: dincl.XPBD(dt=dt, sweeps=16), "#b35900", "X"),
    "second_order": Contestant("second-order PBD", lambda dt: dincl.SecondOrderPBD(dt=dt), "#5d3a9b", "*"),
    "catch_up_ipopt": _catch_up(methods.CATCH_UP, dincl.Ipopt(tol=TOL)),
    "catch_up_daqp": _catch_up(methods.CATCH_UP_DAQP, dincl.Daqp(tol=TOL)),
    "linearised_daqp": _linearised(dincl.Daqp(tol=TOL), methods.LINEARISED_DAQP.colour, methods.LINEARISED_DAQP.marker),
    "linearised_gauss_seidel": _linearised(dincl.GaussSeidel(tol=TOL), "#9acd32", "<"),
    "linearised_clarabel": _linearised(
        dincl.Clarabel(tol=TOL), methods.LINEARISED_CLARABEL.colour, methods.LINEARISED_CLARABEL.marker
    ),
    "midpoint_daqp": _as(
        methods.MIDPOINT,
        "midpoint with Daqp",
        lambda dt: dincl.MidpointCatchUp(dt=dt, projection=dincl.Daqp(tol=TOL)),
    ),
    "penalty_tied": _as(
        methods.PENALTY_TIED, f"springs of {TIED:g}/dt", lambda dt: dincl.Penalty(dt=dt, strength=TIED / dt)
    ),
    "penalty_100": _as(methods.PENALTIES[1], "springs of 100", lambda dt: dincl.Penalty(dt=dt, strength=100.0)),
    "penalty_printed": _as(
        methods.PENALTY_PRINTED,
        f"force as printed of {PUSH:g}",
        lambda dt: dincl.Penalty(dt=dt, strength=PUSH, exponent=1),
    ),
}


def named(*names: str) -> Mapping[str, str]:
    """Return the labels of contestants."""
    return {name: CONTESTANTS[name].label for name in names}
