"""The methods of the report: name, style and a function that makes the scheme. One colour per method everywhere."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import dincl
from dincl.checks import describe
from verification.instruments.method import Method, SchemeOf
from verification.methods.baselines import MoreauJean, chipmunk, lsoda

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


Look = tuple[str, str | tuple[int, int, int], str]


def _named(name: str, label: str, look: Look, scheme: SchemeOf, setting: str = "dt") -> NamedMethod:
    """Set colour, marker and line; markers are hollow where the line is not solid.

    The family is the label without the solver or strength.
    """
    drawn: dict[str, Any] = dict(zip(("color", "marker", "linestyle"), look, strict=True))
    if look[2] != "-":
        drawn["markerfacecolor"] = "none"
    family = re.sub(r" (with|of strength|as printed) .*", "", label)
    return NamedMethod(label, family, scheme, setting=setting, look=drawn, name=name)


def _rimmed(method: NamedMethod) -> NamedMethod:
    return replace(method, look={**method.look, **RIM})


FAMILIES = {
    dincl.CatchUp: "catch-up",
    dincl.LinearisedCatchUp: "linearised catch-up",
    dincl.MidpointCatchUp: "midpoint catch-up",
    MoreauJean: "catch-up at theta = 1/2",
}
SOLVERS = {dincl.CvxpyQP: "cvxpy", dincl.ProjectedCG: "projected CG"}


def _with(name: str, scheme: Any, projection: Any, tol: float, look: Look) -> NamedMethod:
    """Name a scheme with a projection; that of the midpoint rule is as exact as its steps need."""

    def make(dt: float) -> dincl.Scheme:
        enough = max(tol, MIDPOINT_TOL * dt**3) if scheme is dincl.MidpointCatchUp else tol
        made: dincl.Scheme = scheme(dt=dt, projection=projection(tol=enough))
        return made

    return _named(name, f"{FAMILIES[scheme]} with {SOLVERS.get(projection, projection.__name__)}", look, make)


def _penalty(strength: float, colour: str, marker: str) -> NamedMethod:
    label, look = f"penalty of strength {strength:g}", (colour, marker, "-")
    return _named(f"penalty_{strength:g}", label, look, lambda dt: dincl.Penalty(dt=dt, strength=strength))


PBD = _named("pbd", "PBD", ("#d55e00", "o", "-"), lambda dt: dincl.PBD(dt=dt))
PBD_16 = _named("pbd_16", "PBD with 16 sweeps", ("#f2a07b", "8", "-"), lambda dt: dincl.PBD(dt=dt, sweeps=16))
CATCH_UP = _with("catch_up_ipopt", dincl.CatchUp, dincl.Ipopt, REFERENCE_TOL, ("#0072b2", "s", "-"))
CATCH_UP_DAQP = _with("catch_up_daqp", dincl.CatchUp, dincl.Daqp, CHECK_TOL, ("#003f66", "D", ":"))
CATCH_UP_ACTIVE = _rimmed(
    _with("catch_up_active", dincl.CatchUp, dincl.ActiveSet, CHECK_TOL, ("#2a9df4", (4, 0, 45), "-"))
)
LINEARISED_ACTIVE = _rimmed(
    _with("linearised_active", dincl.LinearisedCatchUp, dincl.ActiveSet, CHECK_TOL, ("#00c896", (3, 0, 0), "-"))
)
LINEARISED_DAQP = _with("linearised_daqp", dincl.LinearisedCatchUp, dincl.Daqp, CHECK_TOL, ("#5f9e4a", "P", ":"))
LINEARISED_CLARABEL = _with(
    "linearised_clarabel", dincl.LinearisedCatchUp, dincl.Clarabel, QP_TOL, ("#009e73", "^", "--")
)
LINEARISED_CVXPY = _with("linearised_cvxpy", dincl.LinearisedCatchUp, dincl.CvxpyQP, QP_TOL, ("#56b4e9", "v", ":"))
LINEARISED_PIQP = _with("linearised_piqp", dincl.LinearisedCatchUp, dincl.Piqp, QP_TOL, ("#44bbaa", (3, 0, 180), "-"))
MIDPOINT = _with("midpoint_cg", dincl.MidpointCatchUp, dincl.ProjectedCG, CHECK_TOL, ("#c2003d", "p", "-"))
MIDPOINT_ACTIVE = _rimmed(
    _with("midpoint_active", dincl.MidpointCatchUp, dincl.ActiveSet, CHECK_TOL, ("#ff6f8f", (5, 0, 0), "-"))
)
MOREAU_JEAN = _with("moreau_jean_daqp", MoreauJean, dincl.Daqp, CHECK_TOL, ("#4f7cac", (5, 1, 0), ":"))
PENALTIES = (_penalty(10, "#e3b7d2", "<"), _penalty(100, "#cc79a7", "d"), _penalty(1000, "#8e4572", ">"))
PENALTY_TIED = _named(
    "penalty_tied",
    f"penalty of strength {TIED_STRENGTH:g}/dt",
    ("#6f6f6f", "X", "-"),
    lambda dt: dincl.Penalty(dt=dt, strength=TIED_STRENGTH / dt),
)
PENALTY_PRINTED = _named(
    "penalty_printed",
    "penalty as printed of strength 10",
    ("#b8a33b", "*", "-"),
    lambda dt: dincl.Penalty(dt=dt, strength=10.0, exponent=1),
)
ADAPTIVE = _rimmed(_named("adaptive", "adaptive catch-up", ("#6a3fb5", (6, 1, 0), "-"), dincl.AdaptiveCatchUp, "tol"))
EVENT_DRIVEN = _named("event_driven", "event-driven", ("#000000", "H", "-"), dincl.EventDriven, "tol")
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
