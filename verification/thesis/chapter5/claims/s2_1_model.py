"""Chapter 5, section 2.1: the particle model and its Lagrangian."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from typing import Any

import numpy as np

from verification.claims import Evidence, Verdict, at_least, at_most, proved, put_right
from verification.formal.algebra import identity, library
from verification.thesis.chapter5.general import even, pair_force
from verification.thesis.chapter5.instant import (
    Floats,
    System,
    general_instant,
    instant,
    pulls,
)
from verification.thesis.text.quoted import claim

# What central differences of numbers that are right to rounding leave.
TOL = 1e-8
# Far above it: what a wrong term makes here.
WRONG = 1e-4


def odd(r: Floats) -> Floats:
    """A potential that fulfils all that is printed after (5.4)."""
    return np.asarray((r**3).sum(axis=-1))


@claim(
    "c5.non-interacting",
    "The particles exert no forces on each other.",
    "section 2.1",
    Verdict.CORRECTED,
)
def _non_interacting() -> Evidence:
    at = general_instant()
    without = instant(at.system._replace(V=lambda r: 0.0 * r[..., 0]), at.X, at.y, at.v)
    change, same = float(np.abs(at.a - without.a).max()), float(np.abs(at.U - without.U).max())
    pull = float(np.abs(pulls(at.system, at.X)).max())
    return Evidence(
        f"By (5.4) and (5.6a) they pull at each other, here with up to {pull:.2f}, which changes ÿ by {change:.2f} "
        f"(the conclusion too asks to add such forces). Only (5.11b) is without: the velocities change by {same:g}.",
        printed=(at_most("largest force between two particles", pull, 0.0, TOL),),
        corrected=(
            at_least("largest force between two particles", pull, WRONG),
            at_least("change of ÿ by these forces", change, WRONG),
            at_most("change of Ẋ_i by these forces", same, 0.0, TOL),
        ),
    )


@claim(
    "c5.pair-force",
    "The force of a pair is the negative slope of its potential energy.",
    "(5.4)",
    Verdict.PROVED,
    chosen="the gradient of −V, as section 3.3 recalls it: −∇_{X_i} V(X_j − X_i); for the sign c5.pair-force-sign",
)
def _pair_force() -> Evidence:
    return proved(
        pair_force(
            "N times the negative slope in X_i of the energy of a pair in (5.8) is K(X_k, X_i)/N, for every even 𝒱",
            "−K for K",
        )
    )


@claim(
    "c5.even-potential",
    "The symmetry of the potential energy of a pair.",
    "after (5.4)",
    Verdict.CORRECTED,
    tried_on="one even potential",
)
def _even() -> Evidence:
    at = general_instant()

    def lack(system: System) -> float:
        found = pulls(system, at.X)
        return float(np.abs(found + found.transpose(1, 0, 2)).max())

    printed, right = lack(at.system._replace(V=odd)), lack(at.system)
    pairs = at.X[:, None] - at.X[None]
    energy = float(abs(odd(pairs).sum()))
    even = float(abs(at.system.V(pairs) - at.system.V(-pairs)).max())
    return Evidence(
        f"V(r) = Σr³ fulfils all three: then |K(X, X′) + K(X′, X)| is up to {printed:.1f} against (A2a), and the "
        f"energy of all pairs is {energy:.0e} wherever they are. With V(−X) = V(X) the sum is {right:.0e}.",
        printed=(at_most("|K(X, X′) + K(X′, X)| for an odd V", printed, 0.0, TOL),),
        corrected=(
            at_most("|K(X, X′) + K(X′, X)| for an even V", right, 0.0, TOL),
            at_most("|V(r) − V(−r)| of it", even, 0.0, TOL),
        ),
    )


@claim(
    "c5.lagrangian",
    "The Lagrangian whose multipliers enforce the constraints.",
    "(5.8)",
    Verdict.CORRECTED,
)
def _lagrangian() -> Evidence:
    """The slope in lambda at the start, where g has some value."""
    return put_right(
        identity(
            "the slope of L in λ_j, −γ(g(X_j, y) − g(X_jⁱⁿⁱᵗ, yⁱⁿⁱᵗ)), vanishes at the start, and keeps g as "
            "(5.6c) does",
            lambda s, gamma, start: -gamma * (start - s * start),
            "−γ g(X_j, y) vanishes at the start",
            0,
        )
    )


@claim(
    "c5.equations",
    "The equations for the accelerations are those of the Lagrangian.",
    "(5.6a), (5.6b)",
    Verdict.PROVED,
    chosen="an even 𝒱, as (A2a) needs it; for (5.6c) see c5.lagrangian",
)
def _equations() -> Evidence:
    """One coordinate x of X_i and one of y, the others being p and q; sums over particles and components are linear."""
    sp = library()
    t, n, m, level, p, q = sp.symbols("t N m lambda p q")
    x, z, y = (sp.Function(name)(t) for name in "xzy")
    W0, W1, g, V = sp.Function("W0"), sp.Function("W1"), sp.Function("g"), even("w")
    pairs = (V(z - x, p) + V(x - z, -p)) / (2 * n**2)
    lagrangian = y.diff(t) ** 2 / 2 - W0(y, q) - pairs
    lagrangian += (m * x.diff(t) ** 2 / 2 - W1(x, p) - level * g(x, p, y, q)) / n

    def euler(of: Any) -> Any:
        return lagrangian.diff(of.diff(t)).diff(t) - lagrangian.diff(of)

    def residuals(s: Any) -> Any:
        K = -V(z - x, p).diff(x) / n
        first = m * x.diff(t, 2) + W1(x, p).diff(x) - K + s * level * g(x, p, y, q).diff(x)
        return [
            n * euler(x) - first,
            euler(y) - y.diff(t, 2) - W0(y, q).diff(y) - s * level * g(x, p, y, q).diff(y) / n,
        ]

    return proved(
        identity(
            "the Euler-Lagrange equations of (5.8) with α = β = γ = 1/N are (5.6a) and (5.6b), each coordinate, any 𝒱 "
            "that is even",
            residuals,
            "−λ for λ",
        )
    )
