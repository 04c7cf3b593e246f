"""Chapter 5, sections 2.4 and 2.5: boundedness and Lipschitz constants of the terms of the equations."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_least, at_most, equal
from verification.thesis.chapter5.bounded import FlowState, constants, force, mass
from verification.thesis.chapter5.claims.s2_3_examples import ONE
from verification.thesis.chapter5.instant import (
    STEP,
    Floats,
    effective_mass,
    general_instant,
    general_system,
    instant,
    kernel,
    omega,
    phi,
    wavy_system,
)

# What central differences of numbers that are right to rounding leave.
TOL = 1e-8
ROUNDING = 1e-12
# Far above: what a wrong term makes here.
WRONG = 1e-2
SEED, SAMPLES = 57, 200
M, SPEED = 0.7, 3.0
LINE = np.linspace(-np.pi, np.pi, 2001)[:, None]


def wavy_slopes(v: float) -> Floats:
    """The derivative of Phi(X)[v] in X along the line, for g = X + sin(X)/2 - y."""
    system, y = wavy_system(M), np.zeros(1)
    there, back = (phi(system, LINE + s, y)[:, 0, 0] * v for s in (STEP, -STEP))
    return np.abs(there - back) / (2 * STEP)


def pair(rng: np.random.Generator, count: int, apart: float) -> tuple[FlowState, FlowState]:
    """Two states of ``count`` particles at a distance of about ``apart``, with |v| <= SPEED."""
    X, y, v = rng.normal(0.0, 2.0, count), rng.normal(), SPEED * rng.uniform(-1, 1)
    w = np.full(count, 1 / count)
    moved = FlowState(X + apart * rng.uniform(-1, 1, count), w, y + apart * rng.uniform(-1, 1), v)
    return FlowState(X, w, y, v), moved._replace(v=float(np.clip(v + apart * rng.uniform(-1, 1), -SPEED, SPEED)))


def steepest(f: Callable[[FlowState], float], count: int) -> float:
    """The largest |f(a) - f(b)| over max_i |X_i - X_i'| + |y - y'| + |v - v'| of random pairs."""
    rng, found = np.random.default_rng(SEED), 0.0
    for apart in np.repeat([1e-3, 0.1, 2.0], SAMPLES // 3):
        a, b = pair(rng, count, float(apart))
        found = max(found, abs(f(a) - f(b)) / (np.abs(a.X - b.X).max() + abs(a.y - b.y) + abs(a.v - b.v)))
    return found


@claim(
    "c5.globally-lipschitz",
    "The right side of the reduced equations is Lipschitz continuous for all positions.",
    source="section 2.5",
    quote="(A1a) to (A5b) are chosen such that the ODE model is globally Lipschitz",
    recorded=Kind.NOT_REFUTED,
    chosen="read with the sentences after it, for ‖v‖ ≤ M_v: Φ[v] and Ω[v, v] have no constant for all v",
    tried_on="g = X + sin(X)/2 − y",
)
def _global() -> Evidence:
    """Difference quotients of Phi(X, y)[v] in X, for the largest speed that is allowed."""
    at_most_speed, unit = float(wavy_slopes(SPEED).max()), constants(1.0).l_phi
    return Evidence(
        f"Φ of g = X + sin(X)/2 − y fulfils (A4) with L_Φ = {unit:.2f}: for ‖v‖ = M_v = {SPEED:g} the slope of Φ(X, "
        f"y)[v] in X is at most {at_most_speed:.2f} for all X, L_Φ M_v = {unit * SPEED:.2f}. Without a bound of ‖v‖ "
        "it has none.",
        printed=(at_most("slope of Φ(X, y)[v] in X, ‖v‖ ≤ M_v", at_most_speed, unit * SPEED, 1e-6),),
    )


@claim(
    "c5.any-number",
    "Effective mass and force have bounds and Lipschitz constants that do not depend on N.",
    source="Lemma 5.6",
    quote="m_eff and F_eff are bounded and Lipschitz continuous … The derived bounds do not depend on N",
    recorded=Kind.NOT_REFUTED,
    chosen="distance of positions: the largest over the particles",
    tried_on="g = X + sin(X)/2 − y, N = 1, 4, 16, 64",
)
def _any_number() -> Evidence:
    """Slopes of m_eff and F_eff for few and many particles, over the constants of the rule for products."""
    c, counts = constants(SPEED), (1, 4, 16, 64)
    masses = [steepest(mass, n) / c.l_mass for n in counts]
    forces = [steepest(force, n) / c.l_force for n in counts]
    rng = np.random.default_rng(SEED)
    largest = max(abs(force(pair(rng, n, 1.0)[0])) for n in counts for _sample in range(20)) / c.m_force
    return Evidence(
        f"Forces and interaction that are bounded, N = 1, 4, 16, 64: slopes of m_eff reach at most {max(masses):.2f}, "
        f"of F_eff {max(forces):.2f} of constants without N, and |F_eff| {largest:.2f} of its bound (‖v‖ ≤ {SPEED:g}).",
        printed=(
            at_most("slope of m_eff over its constant", max(masses), 1.0),
            at_most("slope of F_eff over its constant", max(forces), 1.0),
            at_most("|F_eff| over its bound", largest, 1.0),
        ),
        seed=SEED,
    )


@claim(
    "c5.one-particle",
    "The effective force of one particle.",
    source="proof of Lemma 5.6",
    quote="F_eff⁽¹⁾ = F₀(y) + Φ(X, y)ᵀF₁(X) + mΩ(X_i, y)[v, v]",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "F_eff⁽¹⁾ = F₀(y) + Φ(X, y)ᵀ(F₁(X) − mΩ(X, y)[v, v])",
        Effect.MODEL,
        "the force in (5.41b), to which this definition belongs; (5.14) is right, the lemma stands",
        why=("(5.14) has −mΦᵀΩ: mΩ[v, v] is in ℝ^nx and cannot be added to F₀ in ℝ^ny, and its sign is the other one"),
        place=3492,
    ),
    tried_on="one particle, g = X + sin(X)/2 − y",
)
def _one_particle() -> Evidence:
    """m_eff y'' of one particle with g = X + sin(X)/2 - y and no forces."""
    at = instant(wavy_system(M), np.array([[1.1]]), *ONE)
    moved, curved = phi(at.system, at.X, at.y).item(), omega(at.system, at.X, at.y, at.v, at.v).item()
    needed = (effective_mass(at.system, at.X, at.y) @ at.a).item()
    printed, right = abs(M * curved - needed), abs(-moved * M * curved - needed)
    nx, ny = omega(*general_instant()[:3], *[general_instant().v] * 2).shape[1], general_instant().y.size
    return Evidence(
        f"mΩ[v, v] ∈ ℝ^{nx} cannot be added to F₀ ∈ ℝ^{ny}; with nx = ny = 1 (g = X + sin(X)/2 − y) it misses m_eff ÿ "
        f"by {printed:.2f}. With −mΦᵀΩ[v, v], as in (5.14), by {right:.0e}; Lemma 5.6 itself is not affected.",
        printed=(at_most("|m_eff ÿ − mΩ[v, v]|", printed, 0.0, TOL),),
        corrected=(at_most("|m_eff ÿ + mΦᵀΩ[v, v]|", right, 0.0, TOL),),
    )


def clipped(x: Floats, bound: float) -> Floats:
    """x, cut off: bounded, with slopes of at most 1."""
    return np.clip(x, -bound, bound)


@claim(
    "c5.product",
    "Products of bounded Lipschitz continuous functions are such functions.",
    source="proof of Lemma 5.6",
    quote="if h₁, h₂ are both bounded and Lipschitz continuous, then the product h₁h₂ is also bounded and Lipschitz",
    recorded=Kind.NOT_REFUTED,
    tried_on="three pairs of cut-off functions of a line",
)
def _product() -> Evidence:
    """Slopes of products of cut-off functions, for all pairs of points of a wide line, and of x times x."""
    x = np.concatenate([-np.logspace(-2, 6, 200)[::-1], np.logspace(-2, 6, 200)])
    ratios = []
    for first, second in ((1.0, 1.0), (0.5, 3.0), (2.0, 20.0)):
        product = clipped(x, first) * clipped(x, second)
        steep = float((np.abs(np.diff(product)) / np.diff(x)).max())
        ratios.append((steep / (first + second), float(np.abs(product).max()) / (first * second)))
    free = float((np.abs(np.diff(x * x)) / np.diff(x)).max())
    return Evidence(
        f"Products of functions with slopes ≤ 1 and bounds M₁, M₂, on |x| ≤ 10⁶: slopes reach up to "
        f"{max(r[0] for r in ratios):.3f} of M₁ + M₂, values {max(r[1] for r in ratios):g} of M₁M₂. Bounds are needed: "
        f"the slopes of x · x reach {free:.0e}.",
        printed=(
            at_most("slope of the product over M₁ Lip(h₂) + M₂ Lip(h₁)", max(r[0] for r in ratios), 1.0, ROUNDING),
            at_most("size of the product over M₁M₂", max(r[1] for r in ratios), 1.0, ROUNDING),
        ),
    )


@claim(
    "c5.kernel-lipschitz",
    "The interaction is Lipschitz continuous in both positions.",
    source="proof of Lemma 5.6",
    quote="K is bounded and Lipschitz by (A2b) and (A2c)",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "K is bounded and Lipschitz by (A2a) to (A2c)",
        Effect.PROOF,
        "nothing: (A2a) is among the assumptions",
        why="(A2b) is about the first position only; (A2a) carries it over to the second one",
        place=3500,
    ),
    tried_on="𝒱(r) = √(1 + |r|²), 200 pairs in the plane",
)
def _kernel() -> Evidence:
    """K of V = sqrt(1 + r^2): differences in both positions; and sin(X) cos(Z^2), which has (A2b), (A2c) only."""
    system = wavy_system(M)._replace(V=lambda r: np.sqrt(1 + (r**2).sum(axis=-1)))
    X, other, Z = 2 * np.random.default_rng(SEED).normal(size=(3, SAMPLES, 2))
    apart = np.linalg.norm(X - other, axis=-1)

    def slope(there: Floats, back: Floats) -> float:
        return float((np.linalg.norm(there - back, axis=-1) / apart).max())

    first = slope(kernel(system, X, Z), kernel(system, other, Z))
    second = slope(kernel(system, Z, X), kernel(system, Z, other))
    size = float(np.linalg.norm(kernel(system, X, Z), axis=-1).max())
    line = np.linspace(0.0, 1.0, 100001)
    near, far = (float((np.abs(np.diff(np.cos((s * line) ** 2))) / np.diff(s * line)).max()) for s in (10, 100))
    return Evidence(
        f"sin(X)cos(Z²) has (A2b), (A2c), but its slopes in Z reach {near:.0f} for |Z| ≤ 10, {far:.0f} for |Z| ≤ 100. "
        f"With (A2a) as well, 𝒱(r) = √(1 + |r|²), L_K = M_K = 1, {SAMPLES} pairs in the plane have quotients of up to "
        f"{first:.2f} in the first position, {second:.2f} in the second, |K| ≤ {size:.2f}.",
        printed=(at_most("slope in Z without (A2a), |Z| ≤ 100 over |Z| ≤ 10", far / near, 1.0, ROUNDING),),
        corrected=(
            at_most("slope in the first position", first, 1.0, ROUNDING),
            at_most("slope in the second position", second, 1.0, ROUNDING),
            at_most("|K|", size, 1.0, ROUNDING),
        ),
        seed=SEED,
    )


@claim(
    "c5.acceleration-lipschitz",
    "The acceleration of the macroscopic component is Lipschitz continuous at bounded speed.",
    source="Lemma 5.8",
    quote="(X⁽ᴺ⁾, y, v) ↦ (m_eff⁽ᴺ⁾)⁻¹ F_eff⁽ᴺ⁾ is Lipschitz continuous … with ‖v‖ ≤ M_v",
    recorded=Kind.NOT_REFUTED,
    tried_on="g = X + sin(X)/2 − y, N = 1, 8, 64",
)
def _acceleration() -> Evidence:
    """Slopes of F_eff/m_eff, over the constant by Lemma 5.7 with delta = 1 and the rule for products."""
    c, counts = constants(SPEED), (1, 8, 64)
    bound = c.l_force + c.m_force * c.l_mass
    found = max(steepest(lambda s: force(s) / mass(s), n) for n in counts)
    return Evidence(
        f"The same states: slopes of m_eff⁻¹F_eff reach {found:.2f}, the constant Lip(F_eff) + max|F_eff| Lip(m_eff) "
        f"is {bound:.1f}.",
        printed=(at_most("slope of m_eff⁻¹F_eff over its constant", found / bound, 1.0),),
        seed=SEED,
    )


@claim(
    "c5.elliptic",
    "The effective mass is symmetric and at least the mass of the macroscopic component.",
    source="proof of Lemma 5.8",
    quote="m_eff is symmetric, wᵀ m_eff w ≥ ‖w‖² for all w ∈ ℝ^ny",
    recorded=Kind.NOT_REFUTED,
    tried_on="20 states of three particles, one g",
)
def _elliptic() -> Evidence:
    """m_eff of random sets of three particles."""
    rng = np.random.default_rng(SEED)
    states = [(rng.normal(size=(3, 2)), rng.normal(size=3)) for _ in range(20)]
    masses = np.array([effective_mass(general_system(), X, y) for X, y in states])
    lowest, skew = float(np.linalg.eigvalsh(masses).min()), float(np.abs(masses - masses.transpose(0, 2, 1)).max())
    return Evidence(
        f"Least eigenvalue {lowest:.3f} ≥ 1 for 20 random states with nx = 2, ny = 3, skew part {skew:g}.",
        printed=(
            at_least("least eigenvalue of m_eff", lowest, 1.0, ROUNDING),
            equal("skew part of m_eff", skew, 0.0, ROUNDING),
        ),
        seed=SEED,
    )
