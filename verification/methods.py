"""The methods of the report: a name, a look and a way to make the scheme. One colour per method everywhere."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import dincl

# The tolerance of section 4.1 of chapter 2, for the reference; that of the projections that check it: a projection onto
# a curved set by quadratic programs stops just below its tolerance in every step, and that adds up over a run; and that
# of the others [length].
REFERENCE_TOL = 1e-11
CHECK_TOL = 1e-12
QP_TOL = 1e-10
# Explicit Euler is stable for dt strength |J J^T| <= 2, and a disc in a dense packing has |J J^T| up to about 6.
TIED_STRENGTH = 0.3


@dataclass(frozen=True)
class Method:
    """A way to solve a problem with step ``dt``.

    Attributes
    ----------
    name, label
        In tables; for readers.
    colour, marker, line
        In figures.
    scheme
        dt [time] -> the scheme.
    costly
        Whether a step calls a solver of a foreign library: the short studies give such a method fewer step sizes.
    """

    name: str
    label: str
    colour: str
    marker: str
    line: str
    scheme: Callable[[float], dincl.Scheme]
    costly: bool = False


def _penalty(strength: float, colour: str, marker: str) -> Method:
    return Method(
        f"penalty_{strength:g}",
        f"penalty, strength {strength:g}",
        colour,
        marker,
        "-",
        lambda dt: dincl.Penalty(dt=dt, strength=strength),
    )


PBD = Method("pbd", "PBD", "#d55e00", "o", "-", lambda dt: dincl.PBD(dt=dt))
CATCH_UP = Method(
    "catch_up_ipopt",
    "catch-up, Ipopt",
    "#0072b2",
    "s",
    "-",
    lambda dt: dincl.CatchUp(dt=dt, projection=dincl.Ipopt(tol=REFERENCE_TOL)),
    costly=True,
)
CATCH_UP_DAQP = Method(
    "catch_up_daqp",
    "catch-up, Daqp",
    "#003f66",
    "D",
    ":",
    lambda dt: dincl.CatchUp(dt=dt, projection=dincl.Daqp(tol=CHECK_TOL)),
)
LINEARISED_DAQP = Method(
    "linearised_daqp",
    "linearised catch-up, Daqp",
    "#5f9e4a",
    "P",
    ":",
    lambda dt: dincl.LinearisedCatchUp(dt=dt, projection=dincl.Daqp(tol=CHECK_TOL)),
)
LINEARISED_CLARABEL = Method(
    "linearised_clarabel",
    "linearised catch-up, Clarabel",
    "#009e73",
    "^",
    "--",
    lambda dt: dincl.LinearisedCatchUp(dt=dt, projection=dincl.Clarabel(tol=QP_TOL)),
    costly=True,
)
LINEARISED_CVXPY = Method(
    "linearised_cvxpy",
    "linearised catch-up, cvxpy",
    "#56b4e9",
    "v",
    ":",
    lambda dt: dincl.LinearisedCatchUp(dt=dt, projection=dincl.CvxpyQP(tol=QP_TOL)),
    costly=True,
)
PENALTIES = (_penalty(10, "#e3b7d2", "<"), _penalty(100, "#cc79a7", "d"), _penalty(1000, "#8e4572", ">"))
PENALTY_TIED = Method(
    "penalty_tied",
    f"penalty, strength {TIED_STRENGTH:g}/dt",
    "#6f6f6f",
    "X",
    "-",
    lambda dt: dincl.Penalty(dt=dt, strength=TIED_STRENGTH / dt),
)
PENALTY_PRINTED = Method(
    "penalty_printed",
    "penalty as printed, strength 10",
    "#b8a33b",
    "*",
    "-",
    lambda dt: dincl.Penalty(dt=dt, strength=10.0, exponent=1),
)

COMPARED = (PBD, CATCH_UP, LINEARISED_CLARABEL, LINEARISED_CVXPY, *PENALTIES, PENALTY_TIED, PENALTY_PRINTED)
METHODS = {method.name: method for method in (*COMPARED, CATCH_UP_DAQP, LINEARISED_DAQP)}
