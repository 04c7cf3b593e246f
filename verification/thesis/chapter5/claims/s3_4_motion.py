"""Chapter 5, sections 2.2, 2.5 and 3.4: what is proved, seen on motions that the solvers of ``meanfield`` find."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

from meanfield import Motion, solve_characteristics, solve_dae, solve_ode, w1
from verification.claims import claim
from verification.evidence import Evidence, Kind, at_least, at_most
from verification.thesis.chapter5.cases import CASES, FIBRE, few, law, model, state
from verification.thesis.chapter5.instant import Floats

TIMES = np.array([0.0, 0.5, 1.0, 1.5, 2.0])
DAE_TOLERANCE, ODE_TOLERANCE = 1e-9, 1e-11
# The errors of the motions and of their multipliers, which solvers control less well.
OFF = 1e-6
# Far above: what a wrong term makes here.
WRONG = 1e-2
PARTICLES = 5


@claim(
    "c5.same-motion",
    "Constrained and reduced equations have the same motions, and the multipliers can be recovered.",
    source="before Proposition 5.1",
    quote="Every solution of the DAE model (5.6a) to (5.6c) also solves the ODE model (5.11a) and (5.11b)",
    recorded=Kind.NOT_REFUTED,
    chosen="the multipliers by (A.12) with K(X_k, X_i), see c5.derivation-multipliers",
    tried_on="five particles, g = X + sin(X)/2 − y and Example 5.4",
)
def _same_motion() -> Evidence:
    """The constrained equations by IDAS, with multipliers as unknowns, and the reduced ones by DOP853."""
    motions, multipliers, moved = [], [], 0.0
    for name in ("interacting", "element"):
        start = few(name, PARTICLES)
        dae = solve_dae(model(name), start, TIMES, DAE_TOLERANCE)
        ode = solve_ode(model(name), start, TIMES, ODE_TOLERANCE)
        motions += [float(np.abs(a - b).max()) for a, b in ((dae.y, ode.y), (dae.v, ode.v), (dae.X, ode.X))]
        multipliers.append(float(np.abs(dae.multipliers - ode.multipliers).max()))
        moved = max(moved, float(np.abs(ode.y[-1] - ode.y[0]).max()))
    return Evidence(
        f"{PARTICLES} particles that interact on g = X + sin(X)/2 − y, and {PARTICLES} in Example 5.4, up to t = 2: "
        f"the constrained and the reduced equations give the same y, ẏ and X_i to {max(motions):.0e}, and (A.12) the "
        f"multipliers to {max(multipliers):.0e}.",
        printed=(
            at_most("motions apart", max(motions), 0.0, OFF),
            at_most("multipliers apart", max(multipliers), 0.0, OFF),
            at_least("way of y", moved, WRONG),
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
    recorded=Kind.NOT_REFUTED,
    chosen="an even 𝒱, as (A2a) needs it",
    tried_on="five particles, g = X + sin(X)/2 − y",
)
def _energy() -> Evidence:
    """The energy along a motion of the reduced equations."""
    motion = solve_ode(model("interacting"), few("interacting", PARTICLES), TIMES, ODE_TOLERANCE)
    drift, speed = float(np.ptp(energy(motion))), float(np.ptp(motion.v**2 / 2))
    return Evidence(
        f"{PARTICLES} particles that interact on g = X + sin(X)/2 − y, up to t = 2: E varies by {drift:.0e}, ‖ẏ‖²/2 by "
        f"{speed:.2f}.",
        printed=(
            at_most("variation of E", drift, 0.0, OFF),
            at_least("variation of ‖ẏ‖²/2", speed, WRONG),
        ),
    )


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
