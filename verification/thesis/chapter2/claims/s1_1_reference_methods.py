"""Chapter 2, section 1.1: the three methods that PBD is compared with."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

import dincl
from verification.claims import Evidence, Verdict, at_least, at_most, equal, proved
from verification.formal.algebra import identity, library
from verification.formal.reals import implication
from verification.thesis.chapter2.runs import exact
from verification.thesis.text.quoted import claim

# Two discs that slide along each other, of which the exact solution is known; at this time they are in contact.
SCENE, END = dincl.scenes.two_disks(), 2.0
STEPS = (0.04, 0.02)
QP_TOL = 1e-10
# An error of order 1 is halved with the step, up to terms of order 2.
HALVED = 0.1
# Accuracy of event-driven runs [length], and the numbers of discs whose events are counted to a time.
EVENT_TOL, CROWDS, CROWDED = 1e-8, (4, 8), 0.3


def catch_up(dt: float) -> dincl.Scheme:
    """Moreau's scheme with exact projections."""
    return dincl.CatchUp(dt=dt, projection=dincl.Daqp(tol=QP_TOL))


def linearised(dt: float) -> dincl.Scheme:
    """The scheme with the inner convex approximation."""
    return dincl.LinearisedCatchUp(dt=dt, projection=dincl.Daqp(tol=QP_TOL))


def error(scheme: dincl.Scheme) -> float:
    """The largest distance of a disc from where it should be at END."""
    final = dincl.solve(SCENE, scheme, t=END).final
    return float(np.linalg.norm(final - exact(SCENE, END), axis=-1).max())


def event_driven() -> dincl.Scheme:
    """From contact to contact."""
    return dincl.EventDriven(tol=EVENT_TOL)


@claim(
    "c2.event-driven",
    "Following every contact gives nearly exact solutions, at a cost that grows with the contacts.",
    "section 1",
    Verdict.NOT_REFUTED,
    chosen="two discs with a known solution; small piles of discs",
    tried_on="two discs with a known solution, and piles of 4 and 8 discs",
)
def _event_driven() -> Evidence:
    """Its error beside that of time steps, and its events in crowds of two sizes."""
    own, steps = error(event_driven()), error(catch_up(STEPS[1]))
    few, many = (len(dincl.solve(dincl.scenes.pile(n), event_driven(), t=CROWDED).events) for n in CROWDS)
    return Evidence(
        f"Two discs, t = {END:g}: the event-driven error is {own:.0e}, that of catch-up at dt = {STEPS[1]:g} is "
        f"{steps:.0e}. But a pile of {CROWDS[0]} discs has {few} events to t = {CROWDED:g}, one of {CROWDS[1]} has "
        f"{many}, and each is a stop.",
        (
            at_most("error, event-driven", own, 0.0, 10 * EVENT_TOL),
            at_least("error of time steps", steps, 1e-3),
            at_least("events of twice as many discs over those", many / max(few, 1), 1.5),
        ),
    )


@claim(
    "c2.damping",
    "A damping other than 1 changes the time scale of a solution, and nothing else.",
    "(2.1)",
    Verdict.PROVED,
    chosen="a force that does not depend on time",
)
def _damping() -> Evidence:
    """The chain rule for z(t) = x(t/mu); the force does not depend on t, and N is a cone."""
    sp = library()
    t, tau, mu = sp.symbols("t tau mu", positive=True)
    x = sp.Function("x")
    return proved(
        identity(
            "μż = ẋ(t/μ) for z(t) = x(t/μ): if ẋ ∈ F(x) − N(S, x) then μż ∈ F(z) − N(S, z), for every μ > 0",
            lambda s: mu**s * x(t / mu).diff(t) - x(tau).diff(tau).subs(tau, t / mu),
            "ż/μ",
        )
    )


@claim(
    "c2.catch-up",
    "Moreau's catch-up scheme converges to the solution of the differential inclusion.",
    "section 1.1.1",
    Verdict.NOT_REFUTED,
    tried_on="two discs in contact",
)
def _catch_up() -> Evidence:
    coarse, fine = (error(catch_up(dt)) for dt in STEPS)
    return Evidence(
        f"Two discs in contact, t = {END:g}: the error is {coarse:.2e} at dt = {STEPS[0]:g} and {fine:.2e} at half of "
        "it. The projections are exact to 1e-10.",
        (equal("error over that of half the step", coarse / fine, 2.0, HALVED),),
    )


@claim(
    "c2.inner",
    "Where the linearised constraints hold, the discs do not overlap: the polytope lies inside of S.",
    "section 1.1.2",
    Verdict.PROVED,
)
def _inner() -> Evidence:
    """a, b: the distance of two centres at x and at y, p = the product of the differences, at most a b; L = 2R."""
    return proved(
        implication(
            "g(x) + ∇g(x)·(y − x) = a − L + (p − a²)/a ≥ 0 gives b ≥ p/a ≥ L: y is in S",
            lambda s, a, b, p, L: ([a > 0, b >= 0, L > 0, p <= a * b, s * (a * a - L * a + p - a * a) >= 0], b >= L),
            "g(x) + ∇g(x)·(y − x) ≤ 0",
        )
    )


@claim(
    "c2.linearised",
    "The catch-up scheme converges as well if it projects onto the polytope at the last state.",
    "section 1.1.2",
    Verdict.NOT_REFUTED,
    tried_on="two discs in contact",
)
def _linearised() -> Evidence:
    coarse, fine = (error(linearised(dt)) for dt in STEPS)
    moreau = error(catch_up(STEPS[1]))
    return Evidence(
        f"Two discs in contact, t = {END:g}: the error is {coarse:.2e} and, with half the step, {fine:.2e}; that of "
        f"the catch-up scheme with the same step is {moreau:.2e}.",
        (
            equal("error over that of half the step", coarse / fine, 2.0, HALVED),
            at_most("error over that of the catch-up scheme", fine / moreau, 1.0, HALVED),
        ),
    )
