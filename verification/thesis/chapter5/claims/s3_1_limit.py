"""Chapter 5, sections 3.1 and 3.2: the mean-field equations, particles as measures, weak solutions."""

from __future__ import annotations

from math import ceil
from statistics import NormalDist
from typing import Any

import numpy as np

from verification.claims import (
    Correction,
    Effect,
    Evidence,
    FormalProof,
    Verdict,
    at_least,
    at_most,
    claim,
    proved,
    put_right,
)
from verification.formal.algebra import identity, library
from verification.thesis.chapter5.instant import WRONG, Floats, effective_force, effective_mass, general_instant, phi
from verification.thesis.chapter5.lemmas import means_apart, reduced
from verification.thesis.chapter5.wavy import runge_kutta, soft, symbolic_soft

# What rounding leaves.
TOL = 1e-9
# Runs with independent starts, in batches whose spread gives the interval; numbers of particles.
SEED, BATCHES, RUNS, FEW, MANY = 31, 20, 100, 4, 32
# Particles that are heavy enough to be felt by each other through y, their spread at first, and the time.
M, SPREAD, TIME, STEPS = 5.0, 0.5, 3.0, 40


@claim(
    "c5.limit-force",
    "In the limit integrals over the density give the effective mass and the effective force.",
    source="section 1, (5.40a), (5.41)",
    quote="(∫ m_eff⁽¹⁾(x, y) f dx) ÿ = ∫ (F_eff⁽¹⁾(x, y, ẏ) + ∫ K_eff(x′, x) f(x′, t) dx′) f(x, t) dx",
    recorded=Verdict.PROVED,
    rests_on=(
        "c5.effective",
        "c5.consistency",
        "c5.dual",
    ),
    chosen="F_eff⁽¹⁾ with −mΦᵀΩ, as in (5.14)",
)
def _limit_force() -> Evidence:
    """Particles have the integrals over their empirical measure; these tend to those over the density with W1."""
    return proved(atoms(), reduced(), means_apart())


@claim(
    "c5.transport",
    "The density of the particles is carried with the velocity Φ[ẏ].",
    source="section 1, (5.42b)",
    quote="∂_t f(x, t) = −div_x(f(x, t) Φ(x, y)[ẏ])",
    recorded=Verdict.PROVED,
    rests_on=("c5.velocity",),
)
def _transport() -> Evidence:
    """f det J is constant along the flow: Jacobi's formula for det J, and the rate in one coordinate, others alike."""
    sp = library()
    x, t = sp.symbols("x t")
    f, u, volume = sp.Function("f")(x, t), sp.Function("u")(x, t), sp.Symbol("J")
    J, slope = (sp.Matrix(3, 3, sp.symbols(f"{name}:9")) for name in ("J", "u"))
    rate = sum(J.det().diff(each) * moved for each, moved in zip(J, slope * J, strict=True))

    def residual(s: Any) -> Any:
        along = (f.diff(t) + u * f.diff(x)) * volume + f * volume * u.diff(x)
        return along - volume * (f.diff(t) + s * (f * u).diff(x))

    return proved(
        identity(
            "d/dt det J = det J div(Φ[ẏ]) for the slope J of the flow, written out for nx = 3",
            lambda s: rate - s * J.det() * slope.trace(),
            "−div",
        ),
        identity(
            "so d/dt(f det J) = det J (∂_t f + div(fΦ[ẏ])), which is 0 for a density that is carried", residual, "−div"
        ),
    )


@claim(
    "c5.weak-bracket",
    "The mean of a test function ξ changes at the rate −⟨ξ, div(Φẏ) f⟩.",
    source="proof of Lemma 5.10",
    quote="d/dt ⟨ξ, f⁽ᴺ⁾⟩ = … = −⟨ξ, div(Φẏ) f⁽ᴺ⁾⟩",
    correction=Correction(
        "−⟨ξ, div(Φẏ f⁽ᴺ⁾)⟩",
        Effect.PROOF,
        "nothing: the line above it has f under the divergence",
        why="integration by parts moves the derivative from ξ to the whole product Φẏ f",
        place=3676,
    ),
    rests_on=("c5.moved-measure",),
)
def _weak_bracket() -> Evidence:
    """One coordinate: the integrand, up to the derivative of xi u f, which vanishes at the ends; u = Phi y'."""
    sp = library()
    x = sp.Symbol("x")
    xi, u, f = (sp.Function(name)(x) for name in ("xi", "u", "f"))
    return put_right(
        identity(
            "ξ′uf = (ξuf)′ − ξ(uf)′: d/dt⟨ξ, f⟩ = −⟨ξ, div(Φẏf)⟩",
            lambda s: xi.diff(x) * u * f - (xi * u * f).diff(x) + xi * ((u * f).diff(x) if s == 1 else u.diff(x) * f),
            "−⟨ξ, div(Φẏ)f⟩",
        )
    )


def atoms() -> FormalProof:
    """Prove that integrals over atoms of weight 1/N are means, for one atom (two of a pair) and one coordinate."""
    sp = library()
    x, z, X, Z, n = sp.symbols("x z X Z N", real=True)
    single, pair = sp.Function("h")(x), sp.Function("k")(x, z)

    def atom(at: Any, where: Any, s: Any) -> Any:
        return sp.DiracDelta(at - s * where) / n

    def residuals(s: Any) -> Any:
        once = sp.integrate(single * atom(x, X, s), (x, -sp.oo, sp.oo))
        inner = sp.integrate(pair * atom(z, Z, s), (z, -sp.oo, sp.oo))
        twice = sp.integrate(inner * atom(x, X, s), (x, -sp.oo, sp.oo))
        return [once - single.subs(x, X) / n, twice - pair.subs({x: X, z: Z}) / n**2]

    return identity(
        "∫h dμ^emp = 1/N Σ h(X_j) and ∬k dμ^emp dμ^emp = 1/N² ΣΣ k(X_k, X_j) for all h, k, as in (5.13), (5.14)",
        residuals,
        "atoms at −X_j",
    )


@claim(
    "c5.consistency",
    "The motion of particles solves the mean-field equations for their empirical measure.",
    source="Lemma 5.10; (5.44) to (5.46)",
    also=("c5.empirical",),
    quote="we can construct X … such that (X, y) is a solution of the … equations (5.40a) to (5.40c)",
    recorded=Verdict.PROVED,
    rests_on=(
        "c5.moved-measure",
        "c5.weak-bracket",
    ),
)
def _consistency() -> Evidence:
    """The flow at X_j(0) moves by Phi[y'], as X_j(t) does in (5.11b): with h(X^t(x)) for h(x) (5.40a) is (5.11a)."""
    return proved(atoms(), reduced())


def ends(count: int, rng: np.random.Generator) -> Floats:
    """Return the positions of ``count`` particles on g = X + sin(X)/2 - y at the time TIME, (BATCHES, RUNS, count)."""
    start = np.zeros((BATCHES * RUNS, count + 2))
    start[:, 1], start[:, 2:] = 1.0, SPREAD * rng.normal(size=(len(start), count))

    def rate(z: Floats) -> Floats:
        v, X = z[:, 1:2], z[:, 2:]
        curved = np.sin(X) / 2 * soft(X) ** 3 * v**2
        force, mass = -M * (soft(X) * curved), 1 + M * soft(X) ** 2
        return np.concatenate([v, force.mean(1, keepdims=True) / mass.mean(1, keepdims=True), soft(X) * v], axis=1)

    return np.asarray(runge_kutta(rate, start, TIME, STEPS))[-1, :, 2:].reshape(BATCHES, RUNS, count)


def correlations(found: Floats) -> Floats:
    """Return the correlation of two particles in each batch: all pairs of a run are alike."""
    count = found.shape[-1]
    together, alone = found.sum(axis=-1).var(axis=1), found.var(axis=1).sum(axis=-1)
    return np.asarray((together / alone - 1) / (count - 1))


@claim(
    "c5.independent",
    "Particles with independent starts become uncorrelated as their number grows.",
    source="section 3.1",
    quote="we can hope that there exists a statistical distribution … such that X₁(t), …, X_N(t) ~ μᵗ",
    rests_on=("c5.effective",),
    tried_on=f"g = X + sin(X)/2 − y, normal starts, {FEW} and {MANY} particles at t = {TIME:g}",
    chosen=f"a mass of {M:g}, so that few particles feel each other; independence by the correlation of positions",
)
def _independent() -> Evidence:
    """The order in N at which the correlation of two particles falls, with its interval by batches."""
    rng = np.random.default_rng(SEED)
    few, many = (correlations(ends(count, rng)) for count in (FEW, MANY))
    orders = np.log(np.abs(few) / np.abs(many)) / np.log(MANY / FEW)
    order = float(orders.mean())
    error = NormalDist().inv_cdf(0.975) * float(orders.std(ddof=1)) / BATCHES**0.5
    return Evidence(
        printed=(
            at_least(f"−correlation of two of {FEW} particles", -float(few.mean()), 0.1),
            at_least(
                f"order in N at which the correlation of two particles falls, N = {FEW} and {MANY}",
                order,
                0.0,
                interval=(order - error, order + error),
            ),
        ),
        seed=SEED,
        runs_needed=ceil(BATCHES * RUNS * (error / order) ** 2) + 1,
    )


def velocity(at_X: Floats) -> Floats:
    """Return the velocities of all particles of ``general_system`` for all positions; y and y' are given."""
    at = general_instant()
    return np.asarray(phi(at.system, at_X, at.y) @ at.v)


@claim(
    "c5.no-pairs",
    "Neither of the two reduced equations has an interaction of pairs of particles.",
    source="footnote 2",
    quote="the ODE model (5.11a) and (5.11b) since it lacks pairwise interaction between particles",
    correction=Correction(
        "only (5.11b) lacks it: (5.11a) has the forces K, by which particles act on each other through y",
        Effect.MODEL,
        "why independence in the limit is called less surprising; (5.14), (5.16), (5.41b) have these forces",
        why="(5.14), the right side of (5.11a), has the sum of K over all pairs",
        place=3590,
    ),
    rests_on=("c5.effective",),
    tried_on="one state of four particles, nx = 2, ny = 3",
)
def _no_pairs() -> Evidence:
    """The accelerations of y without interaction, and what a shift of one particle changes of all velocities."""
    at = general_instant()
    alone = at.system._replace(V=lambda r: 0.0 * r[..., 0])
    a, without = (
        np.linalg.solve(effective_mass(s, at.X, at.y), effective_force(s, at.X, at.y, at.v)) for s in (at.system, alone)
    )
    pulled = float(np.abs(a - without).max())
    moved = at.X + np.array([0.2, -0.1]) * (np.arange(len(at.X)) == 0)[:, None]
    change = np.abs(velocity(moved) - velocity(at.X)).max(axis=1)
    return Evidence(
        printed=(at_most("change of ÿ of (5.11a) without K", pulled, 0.0, TOL),),
        corrected=(
            at_least("change of ÿ of (5.11a) without K", pulled, WRONG),
            at_most("change of Ẋ_i of (5.11b) if another particle is shifted", float(change[1:].max()), 0.0, TOL),
            at_least("change of Ẋ_i of (5.11b) if the particle itself is shifted", float(change[0]), WRONG),
        ),
    )


@claim(
    "c5.moved-measure",
    "Integrals over the measure at a time are integrals over the initial one along the flow.",
    source="proof of Lemma 5.10",
    quote="∫ξ(x) dμᵗ(x) = ∫ξ(Xᵗ(x′)) dμⁱⁿⁱᵗ(x′)",
    recorded=Verdict.PROVED_INSTANCE,
    rests_on=("c5.transport",),
    tried_on="g = X + sin(X)/2 − y, all densities and all ξ",
)
def _moved_measure() -> Evidence:
    """The flow X + sin(X)/2 = x + sin(x)/2 + y by implicit differentiation."""
    sp = library()
    x, X = sp.symbols("x X", real=True)
    start, xi = sp.Function("f")(x), sp.Function("xi")(X)
    slope = (x + sp.sin(x) / 2).diff(x) / (X + sp.sin(X) / 2).diff(X)
    return proved(
        identity(
            "ξ(X) fᵗ(X) dX/dx = ξ(X) fⁱⁿⁱᵗ(x) under the integral, for fᵗ(X) = fⁱⁿⁱᵗ(x) Φ(x)/Φ(X)",
            lambda s: xi * start * (symbolic_soft(x) / symbolic_soft(X)) ** s * slope - xi * start,
            "fⁱⁿⁱᵗ(x) Φ(X)/Φ(x)",
        )
    )
