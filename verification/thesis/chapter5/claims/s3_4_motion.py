"""Chapter 5, sections 2.2, 2.5 and 3.4: what is proved, seen on motions that the solvers of ``meanfield`` find."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

from meanfield import Motion, solve_characteristics, solve_ode, w1
from verification.claims import claim
from verification.evidence import Evidence, Kind, at_most, proved
from verification.formal.algebra import identity
from verification.thesis.chapter5.cases import CASES, FIBRE, law, model, state
from verification.thesis.chapter5.claims.s2_5_energy import conserved
from verification.thesis.chapter5.general import eliminated, multiplier, particle
from verification.thesis.chapter5.instant import Floats

TIMES = np.array([0.0, 0.5, 1.0, 1.5, 2.0])
DAE_TOLERANCE, ODE_TOLERANCE = 1e-9, 1e-11


@claim(
    "c5.same-motion",
    "Constrained and reduced equations have the same motions, and the multipliers can be recovered.",
    source="before Proposition 5.1",
    quote="Every solution of the DAE model (5.6a) to (5.6c) also solves the ODE model (5.11a) and (5.11b)",
    chosen="the multipliers by (A.12) with K(X_k, X_i), see c5.derivation-multipliers",
    recorded=Kind.PROVED,
)
def _same_motion() -> Evidence:
    """Both directions: elimination of lambda, and lambda of (A.12) put back."""
    p = particle()
    return proved(
        identity("(5.6a), (5.6b) without λ_j are (5.11a), any nx, ny, N", eliminated, "−Ω for Ω"),
        identity(
            "along (5.11a), (5.11b) λ_i of (A.12) fulfils (5.6a)",
            lambda s: p.m * (p.phi * p.a + s * p.curved) - p.f + p.GT * multiplier(p),
            "−Ω in Ẍ_i",
        ),
    )


def pair_energy(r: Floats) -> Floats:
    """V of the case ``interacting``."""
    return np.asarray(1 - np.exp(-(r**2) / 2))


def energy(motion: Motion) -> Floats:
    """(5.37) at all times for the case ``interacting``, nx = ny = 1."""
    y, v, X, U = motion.y[:, 0], motion.v[:, 0], motion.X[..., 0], motion.U[..., 0]
    pairs = pair_energy(X[:, :, None] - X[:, None, :]).mean(axis=(1, 2)) / 2
    each = (FIBRE["m"] * U**2 + FIBRE["k1"] * X**2).mean(axis=1) / 2
    return np.asarray(v**2 / 2 + FIBRE["k0"] / 2 * (y - FIBRE["y_rest"]) ** 2 + each + pairs)


@claim(
    "c5.energy-in-time",
    "The energy is the same at all times of a motion.",
    source="Lemma 5.5",
    quote="the total energy … is a conserved quantity",
    chosen="an even 𝒱, as (A2a) needs it",
    recorded=Kind.PROVED,
)
def _energy() -> Evidence:
    """E' = 0 at each time, see c5.energy, so E is constant where the motion exists."""
    return proved(conserved())


@claim(
    "c5.limit-in-time",
    "More and more particles that stand for a density move y as the mean-field equations do.",
    source="section 3.4",
    quote=(
        "for N → ∞ the behaviour of the ODE model (5.11a) and (5.11b) is well-approximated by the mean-field "
        "characteristic flow"
    ),
    recorded=Kind.NOT_REFUTED,
    chosen="quantiles of a bump; an even 𝒱, as (A2a) needs it",
    tried_on="g = X + sin(X)/2 − y, one density, N = 8 and 32",
)
def _limit() -> Evidence:
    """8 and 32 particles that stand for a density, against the flow equations for this density."""
    name, case = "interacting", CASES["interacting"]
    flow = solve_characteristics(model(name), law(name), case.y0, case.v0, TIMES, DAE_TOLERANCE)
    off, start = [], []
    for count in (8, 32):
        X = law(name).quantiles(count)
        motion = solve_ode(model(name), state(name, X), TIMES, ODE_TOLERANCE)
        off.append(float(np.abs(motion.y - flow.y).max() + np.abs(motion.v - flow.v).max()))
        start.append(w1(X, law(name)))
    return Evidence(
        "Interacting particles on g = X + sin(X)/2 − y that stand for a density, up to t = 2: y and ẏ of 8 and 32 of "
        f"them differ from those of (5.40) for the density by {off[0]:.1e} and {off[1]:.1e}, "
        f"W₁ at the start is {start[0]:.3f} and {start[1]:.3f}: the error falls at least as fast, as (5.60) asks.",
        printed=(
            at_most("error of 32 particles over that of 8", off[1] / off[0], 1.0),
            at_most("the same in units of W₁ at the start", off[1] / off[0] * start[0] / start[1], 1.0),
        ),
    )
