"""Chapter 1, section 1.3: normals as subdifferentials, and the two forms of the model of discs."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from itertools import combinations
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import nnls

import dincl
from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_least, at_most, equal
from verification.thesis.chapter1.sets import Floats, contact_gradients

SAMPLES, SEED = 300, 14
ROUNDING = 1e-12
# Points of the edge of the unit disc, and what the largest product with them may lack.
EDGE = np.stack([f(np.linspace(0, 2 * np.pi, 720, endpoint=False)) for f in (np.cos, np.sin)], axis=1)
BLIND = 1e-4
# How far two discs are moved along a vector, in diameters.
FAR = 1e4
# The four discs of Figure 4 of chapter 2, radius 1/2; a time, and steps of catch-up.
END, STEPS = 1.0, (0.02, 0.01)
# Of gaps and multipliers at events of the integration with multipliers, and of that integration.
TOUCH, TIGHT = 1e-8, 1e-10

Pairs = list[tuple[int, int]]


def inside(y: Floats) -> Floats:
    """The projection onto the unit disc."""
    return np.asarray(y / max(float(np.linalg.norm(y)), 1.0))


def subgradient(v: Floats, x: Floats) -> bool:
    """(1.9) for the indicator function of the unit disc, x in it."""
    return bool(((EDGE - x) @ v).max() <= BLIND)


def proximal(v: Floats, x: Floats) -> bool:
    """Whether x = P_S(x + v/2)."""
    return bool(np.abs(inside(x + v / 2) - x).max() <= ROUNDING)


@claim(
    "c1.outward-normals",
    "The subdifferential of the indicator function of a set is its normal cone.",
    source="before Model 1.3",
    quote="∂W(x) is the set of all outward pointing normal vectors of S, e.g. ∂W(x) = ∂I_S(x) = N(S, x)",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "for convex S; otherwise ∂ is the proximal subdifferential, which (1.9) is not",
        Effect.PROOF,
        "the step to Model 1.3, which stands with N(S, x) of Definition 1.23",
        why="(1.9) bounds W from below at all y, and behind a touching disc there are feasible y again: at two "
        "touching discs (1.9) gives {0}, the cone has a normal",
        place=359,
    ),
    tried_on="the unit disc, and two touching discs",
)
def _outward() -> Evidence:
    """Random unit vectors and the outward ones at points of the disc, and at two discs in contact."""
    rng = np.random.default_rng(SEED)
    places = [inside(y) for y in rng.normal(size=(SAMPLES, 2))]
    vectors = [w / np.linalg.norm(w) for w in (*rng.normal(size=(SAMPLES, 2)), *places)]
    found = [(subgradient(v, x), proximal(v, x)) for v, x in zip(vectors, places * 2, strict=True)]
    unlike, both = sum(a != b for a, b in found), sum(a and b for a, b in found)
    touching = np.array([[-0.5, 0.0], [0.5, 0.0]])
    apart = [np.diff(touching + FAR * v, axis=0) for v in (-touching, *rng.normal(size=(SAMPLES, 2, 2)))]
    refuted = sum(float(np.linalg.norm(arrow)) >= 1 for arrow in apart)
    return Evidence(
        f"Unit disc, {2 * SAMPLES} points with unit vectors: {unlike} are in one of ∂I_S(x) and N(S, x) only, {both} "
        f"in both. For two touching discs (1.9) gives {{0}} instead: for {refuted} of {len(apart)} vectors v, their "
        f"normal included, x + {FAR:g} v is in S, so v is no subgradient.",
        printed=(equal("normals of two touching discs that (1.9) misses", float(np.linalg.norm(apart[0]) >= 1), 0),),
        corrected=(
            equal("vectors in one of the sets only, convex S", unlike, 0),
            at_least("vectors in both", both, SAMPLES // 10),
        ),
        seed=SEED,
    )


def gaps(x: Floats, pairs: Pairs) -> Floats:
    """g_k of discs of radius 1/2."""
    return np.array([np.linalg.norm(x[i] - x[j]) - 1.0 for i, j in pairs])


def gap(x: Floats, pair: tuple[int, int]) -> float:
    """g_k of one pair."""
    return float(gaps(x, [pair])[0])


def multipliers(x: Floats, pairs: Pairs) -> Floats:
    """λ of (1.4) that keeps the g_k of the pairs as they are, d/dt g_k = 0, for F = -x."""
    gradients = contact_gradients(x, pairs)
    return np.asarray(np.linalg.solve(gradients @ gradients.T, gradients @ x.ravel()))


def multiplier(x: Floats, k: int, on: Pairs) -> float:
    """λ_k of the pairs ``on``."""
    return float(multipliers(x, on)[k])


def moving(_t: float, flat: Floats, on: Pairs) -> Floats:
    """(1.4) with the multipliers of some pairs."""
    x = flat.reshape(-1, 2)
    return np.asarray(-flat + multipliers(x, on) @ contact_gradients(x, on))


def pressed(x: Floats, pairs: Pairs) -> Pairs:
    """The pairs in contact with λ > 0."""
    touching = [pair for pair, gap in zip(pairs, gaps(x, pairs), strict=True) if gap <= TOUCH]
    if not touching:
        return []
    forces = nnls(-contact_gradients(x, touching).T, -x.ravel())[0]
    return [pair for pair, force in zip(touching, forces, strict=True) if force > TOUCH]


def watch(value: Callable[[Floats], float]) -> Any:
    """An event of an integration: ``value`` falls to 0."""

    def event(_t: float, flat: Floats) -> float:
        return value(flat.reshape(-1, 2))

    event.terminal, event.direction = True, -1.0  # type: ignore[attr-defined]
    return event


def with_multipliers(x: Floats) -> tuple[Floats, int, float, float]:
    """(1.4), (1.5) from event to event: the end, the number of parts, the least λ, the largest |λ_k g_k|."""
    pairs = list(combinations(range(len(x)), 2))
    t, parts, least, product = 0.0, 0, math.inf, 0.0
    while t < END:
        on = pressed(x, pairs)
        off = [pair for pair in pairs if pair not in on]
        events = [watch(partial(gap, pair=pair)) for pair in off]
        events += [watch(partial(multiplier, k=k, on=on)) for k in range(len(on))]
        run = solve_ivp(partial(moving, on=on), (t, END), x.ravel(), events=events, rtol=TIGHT, atol=TIGHT)
        for state in run.y.T.reshape(-1, len(x), 2) if on else ():
            forces = multipliers(state, on)
            least, product = min(least, forces.min()), max(product, np.abs(forces * gaps(state, on)).max())
        t, x, parts = float(run.t[-1]), run.y[:, -1].reshape(-1, 2), parts + 1
    return x, parts, float(least), float(product)


@claim(
    "c1.equivalent",
    "The inclusion with the normal cone and the equations with multipliers have the same solutions.",
    source="section 1.3",
    quote="we will see that this model is equivalent to (1.4) and (1.5).",
    chosen="the four discs of Figure 4 of chapter 2",
    recorded=Kind.NOT_REFUTED,
    tried_on="four discs, one start",
)
def _equivalent() -> Evidence:
    scene = dincl.scenes.four_disks()
    final, parts, least, product = with_multipliers(scene.x0)
    schemes = (dincl.CatchUp(dt=dt, projection=dincl.Daqp(tol=TIGHT)) for dt in STEPS)
    off = [float(np.abs(dincl.solve(scene, scheme, t=END).final - final).max()) for scheme in schemes]
    return Evidence(
        f"Four discs to t = {END:g}: (1.4), (1.5) solved as an ODE with multipliers in {parts} parts between contacts "
        f"(λ ≥ {least:.0e}, |λ g| ≤ {product:.0e}), against projections onto S, i.e. (1.10): {off[0]:.1e} and "
        f"{off[1]:.1e} apart for dt = {STEPS[0]:g} and {STEPS[1]:g}.",
        printed=(
            equal("distance over that of half the step", off[0] / off[1], 2.0, 0.2),
            at_least("least multiplier", least, 0.0, 10 * TOUCH),
            at_most("largest |λ g|", product, 0.0, 1e-6),
        ),
    )
