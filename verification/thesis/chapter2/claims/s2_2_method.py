"""Chapter 2, sections 2.2 and 2.3: second- and first-order PBD, what a sweep leaves, and alternating projections."""

from __future__ import annotations

import math

import numpy as np

import dincl
from verification.claims import Evidence, Tables, at_least, at_most, claim, equal
from verification.claims.formal.algebra import library
from verification.claims.formal.reals import follows, reals
from verification.methods.methods import PBD
from verification.methods.page import LARGE_STEPS

sp = library()

# A ball that meets an elastic wall at t = 1 with speed 1.
IMPACT_STEPS = (0.1, 0.01, 0.001)
QP_TOL = 1e-10
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


h = sp.symbols("h")


# The slope D of (x, v) -> (x + h v', v'), v' = v - h grad U(x), H the Hessian of U, any number of variables.
H = sp.Symbol("H", commutative=False)
FORM = sp.Matrix([[0, 1], [-1, 0]])


def kept(sign: int) -> object:
    """Return D^T J D - J for v' = v - sign h grad U."""
    slope = sp.Matrix([[1 - h**2 * H, h], [-sign * h * H, 1]])
    transposed = sp.Matrix([[1 - h**2 * H, -sign * h * H], [h, 1]])
    return transposed * FORM * slope - FORM


# Discs of diameter 1 at -1 + w, 0 and 1 - w; p, q after the first pair is moved apart, then q2, r the second.
w, p, q, q2, r = reals("w p q q2 r")
SWEPT = [w > 0, w < 0.5, p == -1 + w - w / 2, q == w / 2, q2 == q - (1 - (1 - w - q)) / 2, r == 1 - w + (q - q2)]
FIRST_PAIR = follows(
    SWEPT,
    [q - p == 1, r - q2 == 1, 1 - (q2 - p) == 0.75 * w, q2 - p < 1],
    1 - (q2 - p) == 0.5 * w,
    "three discs in a row, the outer ones pressed inwards by h: after one sweep the first pair overlaps by ¾h > 0",
    "by ½h",
)
# far = |x - p| for the point p of S nearest to x, moved = |x~ - p|, left = dist(x~, S), push = dt |F|.
far, moved, left, push = reals("far moved left push")
FAR = follows(
    [far >= 0, push > 0, left <= moved, moved <= far + push],
    left <= far + push,
    left <= far,
    "dist(x̃, S) ≤ |x̃ − p| ≤ |x − p| + Δt‖F‖ for the point p of S nearest to x, in any set S",
    "without Δt‖F‖",
)


def largest_overlap(dt: float) -> float:
    """Return the largest overlap of the four discs of Figure 4 over all steps to t = 2."""
    times = np.arange(1, round(2.0 / dt) + 1) * dt
    return float(dincl.solve(dincl.scenes.four_disks(), dincl.PBD(dt=dt), t=times).violation().max())


@claim(
    "c2.smaller",
    "With short enough steps the overlaps left by PBD get small.",
    source="Figure 2; section 2.3; Ideas for proving convergence of PBD",
    also=("c2.infeasible", "c2.prediction", "c6.bounded", "c6.feasible"),
    quote="by choosing sufficiently small time steps the infeasibility will also decrease",
    tried_on="four discs that are drawn to one point",
    chosen="the four discs of Figure 4, the start is not given",
)
def _smaller() -> Evidence:
    coarse, fine = (largest_overlap(dt) for dt in STEPS)
    order, times = math.log2(coarse / fine), np.arange(1, 41) / 20
    moreau = dincl.CatchUp(dt=0.05, projection=dincl.Daqp(tol=QP_TOL))
    kept = float(dincl.solve(dincl.scenes.four_disks(), moreau, t=times).violation().max())
    return Evidence(
        printed=(
            equal("order of the largest overlap, steps 1/160 and half", order, 1.0, ORDER_BAND),
            at_most("largest overlap of catch-up, step 0.05, projections to 1e-10", kept, 0.0, 10 * QP_TOL),
            FIRST_PAIR(),
            FAR(),
        )
    )


@claim(
    "c2.large-steps",
    "PBD stays stable at large steps, at which penalty methods are unstable.",
    source="Figure 2",
    quote="Crucially, the use of large time steps does not make the simulations unstable.",
    needs=(LARGE_STEPS,),
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
