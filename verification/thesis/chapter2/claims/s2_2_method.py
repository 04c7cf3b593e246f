"""Chapter 2, sections 2.2 and 2.3: second- and first-order PBD, what a sweep leaves, and alternating projections."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import dincl
from verification.claims import (
    Correction,
    Effect,
    Evidence,
    Tables,
    Verdict,
    at_least,
    at_most,
    claim,
    equal,
    proved,
    put_right,
)
from verification.formal.algebra import identity, library
from verification.formal.reals import implication
from verification.thesis.chapter2.methods import PBD

# A ball that meets an elastic wall at t = 1 with speed 1.
IMPACT_STEPS = (0.1, 0.01, 0.001)
# Steps of the four discs, and how far from 1 an order may be that is read off two of them.
STEPS, ORDER_BAND = (1 / 160, 1 / 320), 0.1


def bounced(dt: float) -> float:
    """Return where Method 2.2 has a ball at t = 2 that meets a wall at t = 1."""
    problem = dincl.Problem([[1.0]], lambda _t, x: 0 * x, [dincl.HalfSpace(normal=(1,))])
    return float(dincl.solve(problem, dincl.SecondOrderPBD(dt=dt, v0=[[-1.0]]), t=2.0).final[0, 0])


@claim(
    "c2.elastic",
    "However small the step, the second-order method misses elastic collisions.",
    source="introduction",
    quote="it does not converge to exact solutions of the underlying second-order contact problems",
)
def _elastic() -> Evidence:
    """A ball at 1 with velocity -1 and an elastic wall at 0: it is back at 1 at t = 2."""
    error = min(abs(1.0 - bounced(dt)) for dt in IMPACT_STEPS)
    steps = ", ".join(f"{dt:g}" for dt in IMPACT_STEPS)
    return Evidence(printed=(at_least(f"least error after an elastic collision, steps {steps} [length]", error, 0.5),))


@claim(
    "c2.mass",
    "In a step the velocity of a body of mass m grows by Δt F.",
    source="(2.3)",
    quote="m ẍ = F(x) … ṽ_{k+1} := v_k + Δt F(x_k, v_k)",
    correction=Correction(
        "ṽ_{k+1} = v_k + Δt F(x_k, v_k)/m; (2.3) as printed is for m = 1",
        Effect.MODEL,
        "Method 2.2; not the first-order Method 2.3, where μ = 1 was agreed",
        why="m ẍ = F gives the acceleration F/m; Δt F is a momentum",
        place=1269,
    ),
)
def _mass() -> Evidence:
    return put_right(
        identity(
            "m(ṽ − v)/Δt = F for ṽ = v + ΔtF/m",
            lambda s, m, v, F, h: m * ((v + h * F / m**s) - v) / h - F,
            "ṽ = v + ΔtF for every m",
            0,
        )
    )


@claim(
    "c2.symplectic",
    "The prediction of velocities and then positions is a symplectic map.",
    source="section 2.2",
    quote="The first part (2.3) and (2.4) is the symplectic Euler method",
    recorded=Verdict.PROVED,
    rests_on=("c2.mass",),
    chosen="forces that depend on the positions only and have a potential",
)
def _symplectic() -> Evidence:
    """The slope of (x, v) -> (x + h v', v'), v' = v - h grad U(x), H the Hessian of U, any number of variables."""
    sp = library()
    h, H = sp.Symbol("h"), sp.Symbol("H", commutative=False)
    form = sp.Matrix([[0, 1], [-1, 0]])

    def residual(s: Any) -> Any:
        slope, transposed = ([[1 - h**2 * H, h], [-s * h * H, 1]], [[1 - h**2 * H, -s * h * H], [h, 1]])
        return sp.Matrix(transposed) * form * sp.Matrix(slope) - form

    return proved(
        identity("DᵀJD = J for one step in any potential, its Hessian being symmetric", residual, "+Δt∇U in (2.3)")
    )


@claim(
    "c2.infeasible",
    "After a sweep of projections a state may still be infeasible.",
    source="section 2.3",
    quote="it can happen that even the corrected state is not feasible, i.e. x_{k+1} ∉ S",
    recorded=Verdict.PROVED,
)
def _infeasible() -> Evidence:
    """Discs of diameter 1 at -1 + h, 0 and 1 - h; a, b, c after the first pair is moved apart, then d, e the second."""
    return proved(
        implication(
            "three discs in a row, the outer ones pressed inwards by h: after one sweep the first pair overlaps "
            "by ¾h > 0",
            lambda s, h, a, b, d, e: (
                [h > 0, h < 0.5, a == -1 + h - h / 2, b == h / 2, d == b - (1 - (1 - h - b)) / 2, e == 1 - h + (b - d)],
                [b - a == 1, e - d == 1, 1 - (d - a) == s * 0.75 * h, d - a < 1],
            ),
            "by ½h",
            2 / 3,
        )
    )


@claim(
    "c2.prediction",
    "The prediction adds at most Δt ‖F‖ to the distance from S.",
    source="section 2.3",
    quote="dist(x̃_{k+1}, S) ≤ dist(x_k, S) + Δt ‖F(x_k)‖",
    recorded=Verdict.PROVED,
)
def _prediction() -> Evidence:
    """p is the point of S nearest to x; d = |x - p|, n = |x~ - p|, q = dist(x~, S) <= n."""
    return proved(
        implication(
            "dist(x̃, S) ≤ |x̃ − p| ≤ |x − p| + Δt‖F‖ for the point p of S nearest to x, in any set S",
            lambda s, q, n, d, f: ([d >= 0, f > 0, q <= n, n <= d + f], q <= d + s * f),
            "without Δt‖F‖",
            0,
        )
    )


def largest_overlap(dt: float) -> float:
    """Return the largest overlap of the four discs of Figure 4 over all steps to t = 2."""
    times = np.arange(1, round(2.0 / dt) + 1) * dt
    return float(dincl.solve(dincl.scenes.four_disks(), dincl.PBD(dt=dt), t=times).violation().max())


@claim(
    "c2.smaller",
    "With short enough steps the overlaps left by PBD get small.",
    source="Figure 2",
    quote="by choosing sufficiently small time steps the infeasibility will also decrease",
    tried_on="four discs that are drawn to one point",
    chosen="the four discs of Figure 4, the start is not given",
)
def _smaller() -> Evidence:
    coarse, fine = (largest_overlap(dt) for dt in STEPS)
    order = math.log2(coarse / fine)
    return Evidence(printed=(equal("order of the largest overlap, steps 1/160 and half", order, 1.0, ORDER_BAND),))


@claim(
    "c2.large-steps",
    "PBD stays stable at large steps, at which penalty methods are unstable.",
    source="Figure 2",
    quote="Crucially, the use of large time steps does not make the simulations unstable.",
    needs=("large_steps",),
    tried_on="the scenes of Figures 4 and 5",
    chosen="steps at which explicit Euler without constraints is stable; the starts",
)
def _large(tables: Tables) -> Evidence:
    rows = tables["large_steps"]
    pbd, penalty = rows[rows["method"] == PBD.name], rows[rows["method"] != PBD.name]
    done, thrown = pbd[pbd["status"] == "SUCCESS"], penalty[(penalty["status"] == "SUCCESS") & ~penalty["stable"]]
    steps = f"steps from {pbd['dt'].min():g} to {pbd['dt'].max():g}: unstable runs of PBD"
    return Evidence(
        printed=(
            at_most(steps, float((~done["stable"]).sum()), 0),
            at_least(f"runs of PBD ({len(pbd) - len(done)} more stopped, as centres came to coincide)", len(done), 1),
            at_least(f"unstable runs of penalty methods, from the step {thrown['dt'].min():g} on", len(thrown), 1),
        )
    )


@claim(
    "c2.alternating",
    "Alternating projections find a common point of two sets, in some cases also if they are not convex.",
    source="Remark 2.4",
    quote="alternating projections finds a point in the intersection A ∩ B by iterating x_{k+1} = P_A(P_B(x_k))",
    recorded=Verdict.PROVED_INSTANCE,
    tried_on="the unit disc and y ≥ ½, and three discs in a line",
)
def _alternating() -> Evidence:
    """A point (x, y) of the unit disc with y < 1/2 goes to (x, 1/2) and, if that is outside, to (x, 1/2)/|(x, 1/2)|.

    u = x^2, w is u of the next point, 3/4 that of the common point. Of three discs in a line a and b are the overlaps.
    """
    return proved(
        identity(
            "u = x² becomes w = u/(u + ¼), and w − ¾ = (u − ¾)/(4u + 1)",
            lambda s, u: (
                u / (u + library().Rational(1, 4))
                - library().Rational(3, 4)
                - s * (u - library().Rational(3, 4)) / (4 * u + 1)
            ),
            "−(u − ¾)/(4u + 1)",
        ),
        implication(
            "so each round leaves less than a quarter of the distance to the disc and the half plane",
            lambda s, u, d, new: ([d > 0, u == 0.75 + d, new * (4 * u + 1) == d], new <= s * d / 4),
            "less than an eighth",
            0.5,
        ),
        implication(
            "and a quarter of the overlap of three discs in a line, whose sets are not convex",
            lambda s, a, b, new: ([a == 0, b > 0, new == (a + b / 2) / 2], new == s * b / 4),
            "an eighth",
            0.5,
        ),
    )
