"""Chapter 5, section 2.1: the factors of the Lagrangian (5.8), and what the constraints determine."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from verification.claims import claim
from verification.evidence import Evidence, Kind, at_least, at_most, equal
from verification.thesis.chapter5.instant import STEP, Floats, System, general_instant, general_system, phi, slopes

# What central differences of numbers that are right to rounding leave.
TOL = 1e-8
# Far above it: what a wrong factor makes here.
WRONG = 1e-2
SEED, SAMPLES = 51, 20


def spiral(X: Floats) -> Floats:
    """The complex exponential: its Jacobian is a rotation times exp(X_1), never singular."""
    return np.stack([np.exp(X[..., 0]) * np.cos(X[..., 1]), np.exp(X[..., 0]) * np.sin(X[..., 1])], axis=-1)


@claim(
    "c5.locally",
    "With full rank, y fixes each particle as long as it is followed, not among all positions.",
    source="after (5.5)",
    quote="This implies that the state of the macroscopic component determines locally the position of all particles",
    recorded=Kind.NOT_REFUTED,
    tried_on="g = exp(X) − y, 20 points",
)
def _locally() -> Evidence:
    """g = exp(X) - y, where X and X + 2 pi i have one level, along y from 0 to 1 and back."""
    X = np.random.default_rng(SEED).normal(size=(SAMPLES, 2))
    J = slopes(spiral, X)
    least = float(np.abs(np.linalg.det(J) * np.exp(-2 * X[:, 0])).min())
    apart = float(np.abs(spiral(X + np.array([0.0, 2 * np.pi])) - spiral(X)).max())
    shift, moved = np.array([1e-3, -2e-3]), X.copy()
    for _newton in range(4):
        moved = moved - np.linalg.solve(slopes(spiral, moved), (spiral(moved) - spiral(X) - shift)[..., None])[..., 0]
    followed = float(np.abs(moved - X - np.linalg.solve(J, shift)).max())
    return Evidence(
        f"g = exp(X₁)(cos X₂, sin X₂) − y has full rank (|det| ≥ {least:.2f} exp(2X₁)), and X follows a small change "
        f"of y (its first order is met to {followed:.0e}); but X + (0, 2π) has the same level ({apart:.0e}): locally "
        "only.",
        printed=(
            at_least("|det ∂_X g| exp(−2X₁)", least, WRONG),
            at_most("change of X against (∂_X g)⁻¹ δy", followed, WRONG),
            at_most("level of X + (0, 2π) against that of X", apart, 0.0, TOL),
        ),
        seed=SEED,
    )


@claim(
    "c5.initial-multipliers",
    "Positions and the velocity of the macroscopic component fix the multipliers at the start.",
    source="after (5.7)",
    quote="the Lagrangian multipliers for (5.6c), and their initial value is determined implicitly by the system",
    recorded=Kind.NOT_REFUTED,
    tried_on="20 states of two particles, one g with nx = 2, ny = 3",
)
def _initial_multipliers() -> Evidence:
    """The matrix of the equations for the accelerations and multipliers, at random states."""
    rng, least = np.random.default_rng(SEED), np.inf
    for _sample in range(SAMPLES):
        X, y, v = rng.normal(size=(2, 2)), 0.5 * rng.normal(size=3), rng.normal(size=3)
        found = lagrange(general_system(), X, y, v, Factors(0.5, 0.5, 0.5))
        values = np.linalg.svd(found.matrix, compute_uv=False)
        least = min(least, float(values[-1] / values[0]))
    return Evidence(
        f"nx = 2, ny = 3, {SAMPLES} random states: the equations for accelerations and multipliers have one solution, "
        f"their matrix has singular values of at least {least:.0e} of the largest. (X_i, y and ẏ suffice: Ẋ_i = "
        "Φ_i[ẏ].)",
        printed=(at_least("least singular value over the largest", least, TOL),),
        seed=SEED,
    )


@claim(
    "c5.interaction-scaling",
    "With 1/N before the sum over pairs their influence does not grow with the number of particles.",
    source="section 2.1",
    quote="The choice β ~ 1/N … keeps the relative influence of the interaction forces constant",
    recorded=Kind.NOT_REFUTED,
    tried_on="4 and 8 particles",
)
def _beta() -> Evidence:
    scaled, unscaled = _doubled(Factors(1, 1, 1))[0], _doubled(Factors(1, 0, 1))[0]
    return Evidence(
        f"With twice as many particles in the same places ÿ changes by {scaled:.0e} for β = 1/N, by {unscaled:.2f} for "
        "β = 1: without the factor the forces of the pairs outgrow the others.",
        printed=(
            at_most("change of ÿ, β = 1/N", scaled, 0.0, TOL),
            at_least("change of ÿ, β = 1", unscaled, WRONG),
        ),
    )


class Factors(NamedTuple):
    """The factors of (5.8)."""

    alpha: float
    beta: float
    gamma: float


class Solved(NamedTuple):
    """The accelerations of y and X and the multipliers, with the matrix of the equations for them."""

    a: Floats
    A: Floats
    multipliers: Floats
    matrix: Floats


def lagrange(system: System, X: Floats, y: Floats, v: Floats, factors: Factors) -> Solved:
    """The Lagrange equations of (5.8) with any factors, and d^2 g/dt^2 = 0, as one linear system."""
    size = X.size
    q, rate = np.concatenate([X.ravel(), y]), np.concatenate([(phi(system, X, y) @ v).ravel(), v])

    def positions(z: Floats) -> Floats:
        return z[:size].reshape(X.shape)

    def stored(z: Floats) -> Floats:
        x = positions(z)
        pairs = factors.beta * system.V(x[:, None] - x[None]).sum() / 2
        return np.asarray(system.W0(z[size:]) + factors.alpha * (system.W1(x).sum() + pairs))

    def constraint(z: Floats) -> Floats:
        return system.g(positions(z), z[size:]).ravel()

    J = slopes(constraint, q)
    bend = (slopes(constraint, q + STEP * rate) - slopes(constraint, q - STEP * rate)) @ rate / (2 * STEP)
    inertia = np.diag(np.concatenate([np.full(size, factors.alpha * system.m), np.ones(y.size)]))
    matrix = np.block([[inertia, factors.gamma * J.T], [J, np.zeros((size, size))]])
    solution = np.linalg.solve(matrix, np.concatenate([-slopes(stored, q), -bend]))
    A, a = positions(solution), solution[size : q.size]
    return Solved(a, A, solution[q.size :].reshape(X.shape), matrix)


def _doubled(power: Factors) -> tuple[float, float]:
    """What each particle twice changes of the acceleration and of the multipliers, for the factors N^-power."""
    at, found = general_instant(), []
    for copies in (1, 2):
        X = np.repeat(at.X, copies, axis=0)
        factors = Factors(*(float(len(X)) ** -p for p in power))
        found.append(lagrange(at.system, X, at.y, at.v, factors))
    one, two = found
    apart = np.abs(two.multipliers - np.repeat(one.multipliers, 2, axis=0)).max()
    return float(np.abs(one.a - two.a).max()), float(apart)


@claim(
    "c5.scaling",
    "With 1/N before the particles' part of the Lagrangian their influence and multipliers stay bounded.",
    source="section 2.1",
    quote=(
        "With the choice α ~ 1/N the influence of the particles on the macroscopic component remains of order 1 in the "
        "limit … to ensure that also λ₁, …, λ_N are of order 1. Therefore, we pick γ ~ 1/N"
    ),
    recorded=Kind.NOT_REFUTED,
    tried_on="4 and 8 particles",
)
def _alpha() -> Evidence:
    acceleration, multiplier = _doubled(Factors(1, 1, 1))
    unscaled, unbounded = _doubled(Factors(0, 1, 0))[0], _doubled(Factors(1, 1, 0))[1]
    return Evidence(
        f"With twice as many particles in the same places ÿ changes by {acceleration:.0e}, λ_i by {multiplier:.0e}; "
        f"with α = 1 ÿ would change by {unscaled:.2f}, with γ = 1 λ_i would by {unbounded:.2f}.",
        printed=(
            at_most("change of ÿ, α = 1/N", acceleration, 0.0, TOL),
            at_most("change of λ_i, γ = 1/N", multiplier, 0.0, TOL),
            at_least("change of ÿ, α = 1", unscaled, WRONG),
            at_least("change of λ_i, γ = 1", unbounded, WRONG),
        ),
    )


@claim(
    "c5.total-mass",
    "With α = 1/N all particles together have the mass m.",
    source="section 2.1",
    quote="A side effect of this scaling is that the total mass of the particles is constant in the limit",
    recorded=Kind.NOT_REFUTED,
    tried_on="4 and 8 particles",
)
def _total_mass() -> Evidence:
    """The inertia of all particles in one direction, for 4 and for 8 of them."""
    at, found = general_instant(), []
    for copies in (1, 2):
        X = np.repeat(at.X, copies, axis=0)
        inertia = np.diag(lagrange(at.system, X, at.y, at.v, Factors(1 / len(X), 1.0, 1.0)).matrix)[: X.size]
        found.append(float(inertia.sum() / X.shape[1]))
    return Evidence(
        f"4 particles have the mass {found[0]:.3f} in all, 8 have {found[1]:.3f}: m in both cases.",
        printed=(
            equal("mass of 4 particles over m", found[0] / at.system.m, 1.0, TOL),
            equal("mass of 8 particles over m", found[1] / at.system.m, 1.0, TOL),
        ),
    )


@claim(
    "c5.gamma",
    "The factor before the constraints changes only the multipliers.",
    source="section 2.1",
    quote="the choice of the factor γ is physically irrelevant, since the Lagrangian multipliers … would just scale",
    recorded=Kind.NOT_REFUTED,
    tried_on="four particles, γ and 5γ",
)
def _gamma() -> Evidence:
    at = general_instant()
    share = 1 / len(at.X)
    one = lagrange(at.system, at.X, at.y, at.v, Factors(share, share, share))
    other = lagrange(at.system, at.X, at.y, at.v, Factors(share, share, 5 * share))
    motion = float(max(np.abs(one.a - other.a).max(), np.abs(one.A - other.A).max()))
    scaled = float(np.abs(5 * other.multipliers - one.multipliers).max())
    return Evidence(
        f"A γ five times as large changes the accelerations by {motion:.0e}, and λ_i to a fifth, to {scaled:.0e}.",
        printed=(
            at_most("change of the accelerations", motion, 0.0, TOL),
            at_most("5 λ_i with 5γ against λ_i", scaled, 0.0, TOL),
        ),
    )
