"""The methods of the report: name, style and a function that makes the scheme. One colour per method everywhere."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import dincl
from dincl.checks import describe
from verification.instruments.method import Method, SchemeOf
from verification.methods.chart.chipmunk import chipmunk
from verification.methods.chart.lsoda import lsoda
from verification.methods.moreau_jean import MoreauJean

# The tolerance of section 4.1 of chapter 2, for the reference; that of the projections that check it: a projection onto
# a curved set by quadratic programs stops just below its tolerance in every step, and that adds up over a run; and that
# of the others [length].
REFERENCE_TOL = 1e-11
CHECK_TOL = 1e-12
QP_TOL = 1e-10
# Explicit Euler is stable for dt strength |J J^T| <= 2, and a disc in a dense packing has |J J^T| up to about 6.
TIED_STRENGTH = 0.3
# Projections over dt^3 [length / time^3]: with a hundredth of it errors of order 2 are the same in both first digits.
MIDPOINT_TOL = 10.0
# Of the methods with the active set: the shape of their scheme, and what tells them from it without colours.
RIM = {"markeredgecolor": "black", "markersize": 6.0, "linewidth": 2.0}


@dataclass(frozen=True)
class NamedMethod(Method):
    """A method of the report: ``name`` stands in our tables, ``label`` in those of instruments and in figures."""

    name: str = ""

    @property
    def short(self) -> str:
        """Return the label for the end of a line: the scheme and its solver."""
        return re.sub(r" catch-up with| with| of strength", "", self.label)

    def make(self, setting: float) -> dincl.Scheme:
        """Return the scheme with dt or tol = ``setting``."""
        if self.scheme is None:
            raise dincl.InvalidProblem(f"method {self.name}: run = {describe(self.run)}: a named method is a scheme")
        return self.scheme(setting)

    def __reduce__(self) -> tuple[Callable[[str], NamedMethod], tuple[str]]:
        """Send a method to other processes by its name: the functions that make schemes do not pickle."""
        return by_name, (self.name,)

    @property
    def colour(self) -> str:
        """Return the colour of its curves."""
        return str(self.look["color"])

    @property
    def marker(self) -> str | tuple[int, int, int]:
        """Return the marker of its curves."""
        marker: str | tuple[int, int, int] = self.look["marker"]
        return marker

    @property
    def line(self) -> str:
        """Return the line of its curves."""
        return str(self.look["linestyle"])


def _named(
    name: str,
    label: str,
    family: str,
    look: tuple[str, str | tuple[int, int, int], str],
    scheme: SchemeOf,
    *,
    setting: str = "dt",
    rimmed: bool = False,
) -> NamedMethod:
    """Set colour, marker and line; markers are hollow where the line is not solid, large ones have a black rim."""
    colour, marker, line = look
    drawn: dict[str, Any] = {"color": colour, "marker": marker, "linestyle": line}
    if line != "-":
        drawn["markerfacecolor"] = "none"
    if rimmed:
        drawn |= RIM
    return NamedMethod(label, family, scheme, setting=setting, look=drawn, name=name)


def _penalty(strength: float, colour: str, marker: str) -> NamedMethod:
    return _named(
        f"penalty_{strength:g}",
        f"penalty of strength {strength:g}",
        "penalty",
        (colour, marker, "-"),
        lambda dt: dincl.Penalty(dt=dt, strength=strength),
    )


PBD = _named("pbd", "PBD", "PBD", ("#d55e00", "o", "-"), lambda dt: dincl.PBD(dt=dt))
CATCH_UP = _named(
    "catch_up_ipopt",
    "catch-up with Ipopt",
    "catch-up",
    ("#0072b2", "s", "-"),
    lambda dt: dincl.CatchUp(dt=dt, projection=dincl.Ipopt(tol=REFERENCE_TOL)),
)
CATCH_UP_DAQP = _named(
    "catch_up_daqp",
    "catch-up with Daqp",
    "catch-up",
    ("#003f66", "D", ":"),
    lambda dt: dincl.CatchUp(dt=dt, projection=dincl.Daqp(tol=CHECK_TOL)),
)
CATCH_UP_ACTIVE = _named(
    "catch_up_active",
    "catch-up with ActiveSet",
    "catch-up",
    ("#2a9df4", (4, 0, 45), "-"),
    lambda dt: dincl.CatchUp(dt=dt, projection=dincl.ActiveSet(tol=CHECK_TOL)),
    rimmed=True,
)
LINEARISED_ACTIVE = _named(
    "linearised_active",
    "linearised catch-up with ActiveSet",
    "linearised catch-up",
    ("#00c896", (3, 0, 0), "-"),
    lambda dt: dincl.LinearisedCatchUp(dt=dt, projection=dincl.ActiveSet(tol=CHECK_TOL)),
    rimmed=True,
)
LINEARISED_DAQP = _named(
    "linearised_daqp",
    "linearised catch-up with Daqp",
    "linearised catch-up",
    ("#5f9e4a", "P", ":"),
    lambda dt: dincl.LinearisedCatchUp(dt=dt, projection=dincl.Daqp(tol=CHECK_TOL)),
)
LINEARISED_CLARABEL = _named(
    "linearised_clarabel",
    "linearised catch-up with Clarabel",
    "linearised catch-up",
    ("#009e73", "^", "--"),
    lambda dt: dincl.LinearisedCatchUp(dt=dt, projection=dincl.Clarabel(tol=QP_TOL)),
)
LINEARISED_CVXPY = _named(
    "linearised_cvxpy",
    "linearised catch-up with cvxpy",
    "linearised catch-up",
    ("#56b4e9", "v", ":"),
    lambda dt: dincl.LinearisedCatchUp(dt=dt, projection=dincl.CvxpyQP(tol=QP_TOL)),
)
PENALTIES = (_penalty(10, "#e3b7d2", "<"), _penalty(100, "#cc79a7", "d"), _penalty(1000, "#8e4572", ">"))
PENALTY_TIED = _named(
    "penalty_tied",
    f"penalty of strength {TIED_STRENGTH:g}/dt",
    "penalty",
    ("#6f6f6f", "X", "-"),
    lambda dt: dincl.Penalty(dt=dt, strength=TIED_STRENGTH / dt),
)
PENALTY_PRINTED = _named(
    "penalty_printed",
    "penalty as printed of strength 10",
    "penalty",
    ("#b8a33b", "*", "-"),
    lambda dt: dincl.Penalty(dt=dt, strength=10.0, exponent=1),
)

PBD_16 = _named("pbd_16", "PBD with 16 sweeps", "PBD", ("#f2a07b", "8", "-"), lambda dt: dincl.PBD(dt=dt, sweeps=16))
LINEARISED_PIQP = _named(
    "linearised_piqp",
    "linearised catch-up with Piqp",
    "linearised catch-up",
    ("#44bbaa", (3, 0, 180), "-"),
    lambda dt: dincl.LinearisedCatchUp(dt=dt, projection=dincl.Piqp(tol=QP_TOL)),
)
MIDPOINT = _named(
    "midpoint_cg",
    "midpoint catch-up with projected CG",
    "midpoint catch-up",
    ("#c2003d", "p", "-"),
    lambda dt: dincl.MidpointCatchUp(dt=dt, projection=dincl.ProjectedCG(tol=max(CHECK_TOL, MIDPOINT_TOL * dt**3))),
)
MIDPOINT_ACTIVE = _named(
    "midpoint_active",
    "midpoint catch-up with ActiveSet",
    "midpoint catch-up",
    ("#ff6f8f", (5, 0, 0), "-"),
    lambda dt: dincl.MidpointCatchUp(dt=dt, projection=dincl.ActiveSet(tol=max(CHECK_TOL, MIDPOINT_TOL * dt**3))),
    rimmed=True,
)
ADAPTIVE = _named(
    "adaptive",
    "adaptive catch-up",
    "adaptive catch-up",
    ("#6a3fb5", (6, 1, 0), "-"),
    lambda tol: dincl.AdaptiveCatchUp(tol=tol),
    setting="tol",
    rimmed=True,
)
MOREAU_JEAN = _named(
    "moreau_jean_daqp",
    "catch-up at theta = 1/2 with Daqp",
    "catch-up at theta = 1/2",
    ("#4f7cac", (5, 1, 0), ":"),
    lambda dt: MoreauJean(dt=dt, projection=dincl.Daqp(tol=CHECK_TOL)),
)
EVENT_DRIVEN = _named(
    "event_driven",
    "event-driven",
    "event-driven",
    ("#000000", "H", "-"),
    lambda tol: dincl.EventDriven(tol=tol),
    setting="tol",
)
# The baselines: external programs.
LSODA = NamedMethod(
    "penalty by LSODA",
    run=lsoda,
    setting="tol",
    compiled=False,
    look={"color": "#8b5a2b", "marker": "h", "linestyle": "--", "markerfacecolor": "none"},
    name="lsoda",
)
CHIPMUNK = NamedMethod(
    "Chipmunk",
    run=chipmunk,
    compiled=False,
    look={"color": "#e6a800", "marker": (4, 1, 0), "linestyle": "--", "markerfacecolor": "none"},
    name="chipmunk",
)

COMPARED = (PBD, CATCH_UP, LINEARISED_CLARABEL, LINEARISED_CVXPY, *PENALTIES, PENALTY_TIED, PENALTY_PRINTED)
# Of the chart of speed against accuracy. A scheme with another projection is another method there.
CHARTED = (
    PBD,
    PBD_16,
    PENALTY_TIED,
    CATCH_UP,
    CATCH_UP_DAQP,
    CATCH_UP_ACTIVE,
    LINEARISED_CLARABEL,
    LINEARISED_PIQP,
    LINEARISED_DAQP,
    LINEARISED_ACTIVE,
    MOREAU_JEAN,
    MIDPOINT,
    MIDPOINT_ACTIVE,
    ADAPTIVE,
    EVENT_DRIVEN,
    LSODA,
    CHIPMUNK,
)
METHODS = {method.name: method for method in (*COMPARED, *CHARTED)}


def by_name(name: str) -> NamedMethod:
    """Return the method of this name."""
    return METHODS[name]
