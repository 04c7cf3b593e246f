"""Chapter 5, sections 3.1 to 3.3: the mean-field equations, particles as measures, the space of flows."""

from __future__ import annotations

from math import ceil
from statistics import NormalDist
from typing import Any

import numpy as np

from verification.claims import Correction, Effect, Evidence, at_least, at_most, claim
from verification.claims.formal.algebra import library, vanishes
from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument, identity
from verification.thesis.chapter5.instant import (
    WRONG,
    Floats,
    effective_force,
    effective_mass,
    general_instant,
    phi,
    runge_kutta,
    soft,
    symbolic_soft,
)
from verification.thesis.chapter5.lemmas import PRODUCTS, REDUCED, WEIGHTED

sp = library()
t, x, z, X, Z, n = sp.symbols("t x z X Z N", real=True)

# What rounding leaves.
TOL = 1e-9
# Runs with independent starts, in batches whose spread gives the interval; numbers of particles.
SEED, BATCHES, RUNS, FEW, MANY = 31, 20, 100, 4, 32
# Particles that are heavy enough to be felt by each other through y, their spread at first, and the time.
M, SPREAD, TIME, STEPS = 5.0, 0.5, 3.0, 40

# f det J is constant along the flow: Jacobi's formula for det J, nx = 3, and the rate in one coordinate, others alike.
J, slope = (sp.Matrix(3, 3, sp.symbols(f"{name}:9")) for name in ("J", "u"))
f, u, volume = sp.Function("f")(x, t), sp.Function("u")(x, t), sp.Symbol("J")
GROWTH = sum(J.det().diff(each) * moved for each, moved in zip(J, slope * J, strict=True))
ALONG = (f.diff(t) + u * f.diff(x)) * volume + f * volume * u.diff(x)

_transport = argument(
    "c5.transport",
    "section 1, (5.42b)",
    "∂_t f(x, t) = −div_x(f(x, t) Φ(x, y)[ẏ])",
    "The density of the particles is carried with the velocity Φ[ẏ].",
    vanishes(
        GROWTH - J.det() * slope.trace(),
        GROWTH + J.det() * slope.trace(),
        "d/dt det J = det J div(Φ[ẏ]) for the slope J of the flow, written out for nx = 3",
        "−div",
    ),
    vanishes(
        ALONG - volume * (f.diff(t) + (f * u).diff(x)),
        ALONG - volume * (f.diff(t) - (f * u).diff(x)),
        "so d/dt(f det J) = det J (∂_t f + div(fΦ[ẏ])), which is 0 for a density that is carried",
        "−div",
    ),
    rests_on=("c5.derivation-constraint",),
)


def atoms(sign: int) -> list[Any]:
    """Return integrals over atoms of weight 1/N less means: one atom (two of a pair), one coordinate, any h and k."""
    h, k = sp.Function("h"), sp.Function("k")
    first, second = sp.DiracDelta(x - sign * X) / n, sp.DiracDelta(z - sign * Z) / n
    inner = sp.integrate(k(x, z) * second, (z, -sp.oo, sp.oo))
    once, twice = (sp.integrate(each * first, (x, -sp.oo, sp.oo)) for each in (h(x), inner))
    return [once - h(X) / n, twice - k(X, Z) / n**2]


_consistency = argument(
    "c5.consistency",
    "Lemma 5.10; (5.44) to (5.46); section 1, (5.40a), (5.41)",
    "we can construct X … such that (X, y) is a solution of the … equations (5.40a) to (5.40c)",
    "The motion of particles solves the mean-field equations for their empirical measure.",
    vanishes(
        atoms(1),
        atoms(-1),
        "∫h dμ^emp = 1/N Σ h(X_j) and ∬k dμ^emp dμ^emp = 1/N² ΣΣ k(X_k, X_j) for all h, k, as in (5.13), (5.14)",
        "atoms at −X_j",
    ),
    REDUCED,
    also=("c5.empirical", "c5.limit-force"),
    rests_on=("c5.moved-measure",),
)


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
    rests_on=("c5.reduced-model",),
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
    rests_on=("c5.reduced-model",),
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


# The flow X + sin(X)/2 = x + sin(x)/2 + y by implicit differentiation.
SLOPE = (x + sp.sin(x) / 2).diff(x) / (X + sp.sin(X) / 2).diff(X)
thinner = symbolic_soft(x) / symbolic_soft(X)
moved = sp.Function("xi")(X) * sp.Function("f")(x)

_moved_measure = identity(
    "c5.moved-measure",
    "proof of Lemma 5.10",
    "∫ξ(x) dμᵗ(x) = ∫ξ(Xᵗ(x′)) dμⁱⁿⁱᵗ(x′)",
    "Integrals over the measure at a time are integrals over the initial one along the flow.",
    right=moved * thinner * SLOPE - moved,
    wrong=moved / thinner * SLOPE - moved,
    rests_on=("c5.transport",),
    tried_on="g = X + sin(X)/2 − y, all densities and all ξ",
)


# The part of the flow at one point: n = |phi - phi'|_Y, e = |y - y'|, u = |v - v'|, k = L_Phi M_v, r = |x|. Then the
# rule for products with the constants of Lemma 5.7: i = |m_eff^-1|, lip its Lipschitz constant.
d, far, e, u, k, most, s, MF, LF, Lm, i, lip = reals("d n e u k M r MF LF Lm i l")
FLOW = [far >= 0, e >= 0, u >= 0, k > 0, most >= 0, s >= 0, d <= k * (far * (1 + s) + e) + most * u]
INVERSE = [d > 0, MF > 0, LF >= 0, Lm > 0, i >= 0, lip >= 0, i * d <= 1, lip * d * d <= Lm]

_right_side = argument(
    "c5.right-side",
    "proof of Theorem 5.12; section 2.5; Lemma 5.8",
    "(φ, y, y) ↦ h(φ, y, ẏ; μⁱⁿⁱᵗ) is Lipschitz continuous provided ‖v‖ ≤ M_v … depends on M_v and C_μ",
    "The right side of the mean-field equations is Lipschitz continuous on Z at bounded speed.",
    WEIGHTED,
    *PRODUCTS,
    follows(
        INVERSE,
        (i * LF + lip * MF) * d * d <= d * LF + Lm * MF,
        (i * LF + lip * MF) * d * d <= d * LF - Lm * MF,
        "with |m_eff⁻¹| ≤ 1/δ and Lip(m_eff⁻¹) ≤ Lip(m_eff)/δ² m_eff⁻¹F_eff has the constant L_F/δ + M_F Lip(m_eff)/δ²",
        "L_F/δ − M_F Lip(m_eff)/δ²",
    ),
    follows(
        FLOW,
        d <= (k * (far + e) + most * u) * (1 + s),
        d <= (k * (far - e) + most * u) * (1 + s),
        "|Φ[v] − Φ′[v′]| ≤ (L_Φ M_v (‖φ − φ′‖_𝒴 + ‖y − y′‖) + M_Φ‖v − v′‖)(1 + ‖x‖)",
        "−‖y − y′‖",
    ),
    also=("c5.globally-lipschitz", "c5.acceleration-lipschitz"),
    rests_on=("c5.any-number", "c5.inverse", "c5.product"),
    chosen="the notation of c5.right-side-letters",
)
