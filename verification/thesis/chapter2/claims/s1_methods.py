"""Chapter 2, section 1: the methods that PBD is compared with."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import dincl
from verification.claims import Correction, Effect, Evidence, at_least, at_most, claim, equal
from verification.claims.formal.algebra import library
from verification.claims.formal.reals import follows, reals, solver_library
from verification.claims.formal.stated import argument, identity
from verification.instruments.references import reference

sp, z3 = library(), solver_library()

# Two discs that slide along each other, of which the exact solution is known; at this time they are in contact.
SCENE, END = dincl.scenes.two_disks(), 2.0
STEPS = (0.04, 0.02)
QP_TOL = 1e-10
# An error of order 1 is halved with the step, up to terms of order 2.
HALVED = 0.1
# Accuracy of event-driven runs [length], and the numbers of discs whose events are counted to a time.
EVENT_TOL, CROWDS, CROWDED = 1e-8, (4, 8), 0.3
# A point that is pressed onto the wall x >= 0 with force 1, g(x) = x [length / time, time].
PRESSED, DT, STRENGTH = -1.0, 0.01, 20.0


def catch_up(dt: float) -> dincl.Scheme:
    """Return Moreau's scheme with exact projections."""
    return dincl.CatchUp(dt=dt, projection=dincl.Daqp(tol=QP_TOL))


def linearised(dt: float) -> dincl.Scheme:
    """Return the scheme with the inner convex approximation."""
    return dincl.LinearisedCatchUp(dt=dt, projection=dincl.Daqp(tol=QP_TOL))


def error(scheme: dincl.Scheme) -> float:
    """Return the largest distance of a disc from where it should be at END."""
    final = dincl.solve(SCENE, scheme, t=END).final
    return float(np.linalg.norm(final - reference(SCENE, EVENT_TOL)(END).x[0], axis=-1).max())


def event_driven() -> dincl.Scheme:
    """Return the event-driven scheme."""
    return dincl.EventDriven(tol=EVENT_TOL)


@claim(
    "c2.event-driven",
    "Event-driven methods are the most rigorous, but their cost grows with the contacts.",
    source="section 1",
    quote=(
        "The most rigorous methods are typically event-driven methods, however, these methods are … less performant "
        "for large systems."
    ),
    tried_on="two discs with a known solution, and piles of 4 and 8 discs",
)
def _event_driven() -> Evidence:
    own, steps = error(event_driven()), error(catch_up(STEPS[1]))
    few, many = (len(dincl.solve(dincl.scenes.pile(n), event_driven(), t=CROWDED).events) for n in CROWDS)
    return Evidence(
        printed=(
            at_most("event-driven error, two discs, t = 2 [length]", own, 0.0, 10 * EVENT_TOL),
            at_least("error of catch-up there, step 0.02 [length]", steps, 1e-3),
            at_least("events to t = 0.3 of a pile of 8 discs over a pile of four", many / max(few, 1), 1.5),
        )
    )


# The chain rule; F of (2.1) is a function of x alone, and N is a cone.
t, f, e = sp.symbols("t f epsilon", positive=True)
x = sp.Function("x")


@claim(
    "c2.catch-up",
    "Moreau's catch-up scheme converges to the solution of the inclusion.",
    source="section 1.1.1",
    quote="x_{k+1} = P_S(x_k + Δt F(x_k)) … a proof of the convergence for this numerical method",
    rests_on=("c1.existence",),
    tried_on="two discs in contact",
)
def _catch_up() -> Evidence:
    coarse, fine = (error(catch_up(dt)) for dt in STEPS)
    return Evidence(printed=(equal("error at t = 2, step 0.04 over half of it", coarse / fine, 2.0, HALVED),))


# The distances here and there of two centres at x and at y, and the product of the differences; length = 2R.
here, there, product, length = reals("a b p L")
PAIR, SLOPE_AT = [here > 0, there >= 0, length > 0, product <= here * there], product - length * here
INNER = follows(
    [*PAIR, SLOPE_AT >= 0],
    there >= length,
    ([*PAIR, SLOPE_AT <= 0], there >= length),
    "g(x) + ∇g(x)·(y − x) = a − L + (p − a²)/a ≥ 0 gives b ≥ p/a ≥ L: y is in S",
    "g(x) + ∇g(x)·(y − x) ≤ 0",
)


@claim(
    "c2.linearised",
    "The catch-up scheme converges as well if it projects onto the inner convex approximation.",
    source="section 1.1.2",
    also=("c2.inner",),
    quote="one can replace S with S̃(x) in the catch-up scheme without loss of convergence",
    rests_on=("c2.catch-up",),
    tried_on="two discs in contact",
)
def _linearised() -> Evidence:
    coarse, fine = (error(linearised(dt)) for dt in STEPS)
    moreau = error(catch_up(STEPS[1]))
    return Evidence(
        printed=(
            equal("error at t = 2, step 0.04 over half of it", coarse / fine, 2.0, HALVED),
            at_most("error over that of the catch-up scheme, t = 2, same step", fine / moreau, 1.0, HALVED),
            INNER(),
        )
    )


def printed_push(x: float) -> float:
    """Return ∇g where g < 0, for g(x) = x."""
    return 1.0 if x < 0 else 0.0


def spring(x: float) -> float:
    """Return max(0, -g) ∇g."""
    return max(0.0, -x)


def implicit_residual(push: Callable[[float], float]) -> float:
    """Measure how far the nearest y is from solving y = x + dt (F + ε push(y)), for x half a step above the wall."""
    start = -PRESSED * DT / 2
    return min(float(abs(y - start - DT * (PRESSED + STRENGTH * push(y)))) for y in np.linspace(-0.1, 0.1, 4001))


def steepest(push: Callable[[float], float]) -> float:
    """Return the largest slope of a force between places 10^-6 apart."""
    h = 1e-6
    return max(abs(push(x + h) - push(x)) / h for x in h * np.arange(-2000.5, 2000.0))


@claim(
    "c2.printed-penalty",
    "With a force ∇g at overlap the inclusion becomes an ordinary differential equation.",
    source="section 1.1.3",
    quote="smoothening approach … F_ℓ(x) := ∇g_ℓ(x) if g_ℓ(x) < 0 … one might apply any numerical scheme for ODEs",
    correction=Correction(
        (
            "with F_ℓ = −g_ℓ ∇g_ℓ where g_ℓ < 0 it is an ODE whose right-hand side is Lipschitz continuous while no "
            "centres coincide; as printed (2.2) is a differential inclusion again"
        ),
        Effect.MODEL,
        "“any numerical scheme for ODEs”; the stiffness for large ε of the next paragraph, which is that of −g∇g",
        why=(
            "∇g does not grow from 0 with the overlap: it jumps where contact begins, so the right-hand side is not "
            "continuous"
        ),
        place=1223,
    ),
    chosen="one constraint, g(x) = x",
)
def _printed_penalty() -> Evidence:
    """The wall x >= 0 and the force -1: the jump where contact begins, and whether an implicit step has a solution."""
    h = 1e-9
    (jump, left), (right_jump, right_left) = (
        (push(-h) - push(0.0), implicit_residual(push)) for push in (printed_push, spring)
    )
    return Evidence(
        printed=(
            at_most("jump of ε∇g where contact begins, over ε", jump, 0.0, 1e-6),
            at_most("least residual of an implicit step with ε∇g [length]", left, 1e-4),
        ),
        corrected=(
            at_most("jump of −εg∇g, over ε", right_jump, 0.0, 1e-6),
            at_most("least residual of an implicit step with −εg∇g [length]", right_left, 1e-4),
            at_most("Lipschitz constant of −εg∇g, over ε", steepest(spring), 1.0, 1e-6),
        ),
    )


# r, the distance of the centres, has r' = 2 (-f + e (L - r)), L = 2R, from r = L; the inclusion keeps r = L.
DEPTH = f / e * (1 - sp.exp(-2 * e * t))

_limit = identity(
    "c2.penalty-limit",
    "(2.2)",
    "For ε → ∞ the dynamics converge to the non-smooth behaviour.",
    "As ε grows, the overlap of the penalty method, (f/ε)(1 − e^{−2εt}), tends to 0.",
    right=[-DEPTH.diff(t) - 2 * (-f + e * DEPTH), DEPTH.subs(t, 0)],
    wrong=DEPTH.diff(t) - 2 * (-f - e * DEPTH),
    rests_on=("c2.printed-penalty",),
    tried_on="two discs that a constant force presses together along their line",
    chosen="the force as corrected in c2.printed-penalty",
)

# Outside of a wall x' = -e x, x the overlap: a step h multiplies x by 1 - h e; k and g: another strength and step.
h, g, s, k = reals("h g e k")
GROWS = (1 - h * s) * (1 - h * s) <= 1
LONGEST = [s > 0, k > 0, h * s == 2, g * k == 2]

_stiffness = argument(
    "c2.stiffness",
    "section 1.1.3",
    "the stiffness typically also increases dramatically for large penalty parameters which forces small …",
    "The longest stable step of an explicit method falls as the penalty parameter grows.",
    follows(
        [s > 0],
        z3.And(h >= 0, h * s <= 2) == GROWS,
        z3.And(h >= 0, h * s <= 1) == GROWS,
        "|1 − Δt ε| ≤ 1 if and only if 0 ≤ Δt ≤ 2/ε",
        "Δt ≤ 1/ε",
    ),
    follows([*LONGEST, k > s], g < h, ([*LONGEST, k < s], g < h), "2/ε falls as ε grows", "as ε falls"),
    also=("c2.strength",),
    rests_on=("c2.printed-penalty",),
    tried_on="a point between two walls, by explicit Euler",
    chosen="the force as corrected in c2.printed-penalty",
)
