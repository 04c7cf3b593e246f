"""Chapter 5, sections 3.1 and 3.2: the mean-field equations, particles as measures, weak solutions."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, FormalProof, Kind, at_least, at_most, proved
from verification.formal.algebra import identity, library
from verification.thesis.chapter5 import bounded
from verification.thesis.chapter5.bounded import FlowState, force, mass
from verification.thesis.chapter5.general import eliminated
from verification.thesis.chapter5.instant import Floats, System, instant
from verification.thesis.chapter5.wavy import soft, wavy_flow

# What central differences of a bisection leave.
DIFFERENCE = 1e-6
# Far above: what a wrong term makes here.
WRONG = 1e-2
# A distribution of the particles: its mean and width.
MEAN, WIDTH = 0.3, 0.3
Y, YDOT = 0.4, 1.5


def _system() -> System:
    """The fibre of ``bounded`` as functions of the Lagrangian."""

    def sqrt(x: Floats) -> Floats:
        found: Floats = np.sqrt(1 + (x**2).sum(axis=-1))
        return found

    return System(bounded.M, lambda X, y: X + np.sin(X) / 2 - y, lambda y: -np.cos(y[0]), sqrt, sqrt)


def density(count: int) -> tuple[Floats, Floats]:
    """A bell that is not symmetric: points of a line, and values there that sum to 1."""
    line = np.linspace(MEAN - 9 * WIDTH, MEAN + 9 * WIDTH, count)
    f = np.exp(-((line - MEAN) ** 2) / (2 * WIDTH**2)) * (1.5 + np.tanh(line))
    return line, f / f.sum()


def spread(count: int) -> Floats:
    """Points of equal weight that stand for the density, by its distribution function."""
    line, share = density(20001)
    return np.interp((np.arange(count) + 0.5) / count, share.cumsum() - share / 2, line)


@claim(
    "c5.limit-force",
    "Constrained particles that stand for a density accelerate y as the integrals over the density say.",
    source="section 1, (5.40a), (5.41)",
    quote="(∫ m_eff⁽¹⁾(x, y) f dx) ÿ = ∫ (F_eff⁽¹⁾(x, y, ẏ) + ∫ K_eff(x′, x) f(x′, t) dx′) f(x, t) dx",
    recorded=Kind.NOT_REFUTED,
    chosen="F_eff⁽¹⁾ with −mΦᵀΩ, as in (5.14)",
    tried_on="g = X + sin(X)/2 − y, one density",
)
def _limit_force() -> Evidence:
    """The acceleration of constrained particles, for more and more of them, against the integrals over a density."""
    at = FlowState(*density(1001), Y, YDOT)
    limit = force(at) / mass(at)
    off = []
    for count in (5, 200):
        found = instant(_system(), spread(count)[:, None], np.array([Y]), np.array([YDOT])).a.item()
        off.append(abs(found - limit))
    part = abs(limit - force(at._replace(v=0.0)) / mass(at))
    return Evidence(
        f"ÿ of 5 and 200 constrained particles with interaction that stand for a density differs from that of the "
        f"integrals ({limit:.4f}) by {off[0]:.0e} and {off[1]:.0e}; the term with ẏ makes {part:.2f} of it "
        "(any limit between the last two decides alike).",
        printed=(
            at_most("ÿ of 200 particles against the limit", off[1], 0.0, WRONG),
            at_most("error of 200 particles over that of 5", off[1] / off[0], 1.0),
            at_least("what the term with ẏ contributes", part, WRONG),
        ),
    )


def transported(x: Floats, y: float) -> Floats:
    """The density that the flow of g = X + sin(X)/2 - y makes of a bell while y goes from 0 to y."""
    start = wavy_flow(x, -y)
    return np.asarray(np.exp(-((start - MEAN) ** 2) / 2) * soft(start) / soft(x))


def volumes(what: str) -> FormalProof:
    """Prove Jacobi's formula: det J of a flow with dJ/dt = (slope of the velocity) J grows at the rate of its trace."""
    sp = library()
    J, slope = (sp.Matrix(3, 3, sp.symbols(f"{name}:9")) for name in ("J", "u"))
    rate = sum(J.det().diff(each) * moved for each, moved in zip(J, slope * J, strict=True))
    return identity(
        f"d/dt det J = det J div({what}) for the slope J of the flow, written out for nx = 3",
        lambda s: rate - s * J.det() * slope.trace(),
        "−div",
    )


@claim(
    "c5.transport",
    "How the density of the particles changes.",
    source="section 1, (5.42b)",
    quote="∂_t f(x, t) = −div_x(f(x, t) Φ(x, y)[ẏ])",
    recorded=Kind.PROVED,
)
def _transport() -> Evidence:
    """f det J is constant along the flow; its rate in one coordinate, the others alike."""
    sp = library()
    x, t = sp.symbols("x t")
    f, u, volume = sp.Function("f")(x, t), sp.Function("u")(x, t), sp.Symbol("J")

    def residual(s: Any) -> Any:
        along = (f.diff(t) + u * f.diff(x)) * volume + f * volume * u.diff(x)
        return along - volume * (f.diff(t) + s * (f * u).diff(x))

    return proved(
        volumes("Φ[ẏ]"),
        identity(
            "so d/dt(f det J) = det J (∂_t f + div(fΦ[ẏ])), which is 0 for a density that is carried", residual, "−div"
        ),
    )


def tested_with(x: Floats) -> Floats:
    """A smooth function with which the density is tested; it is far below rounding at the ends of the line."""
    return np.asarray(np.exp(-((x - 1.0) ** 2)))


@claim(
    "c5.weak-bracket",
    "The rate of the mean of a test function, by the divergence of the flux.",
    source="proof of Lemma 5.10",
    quote="d/dt ⟨ξ, f⁽ᴺ⁾⟩ = … = −⟨ξ, div(Φẏ) f⁽ᴺ⁾⟩",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "−⟨ξ, div(Φẏ f⁽ᴺ⁾)⟩",
        Effect.PROOF,
        "nothing: the line above it has f under the divergence",
        why="integration by parts moves the derivative from ξ to the whole product Φẏ f",
        place=3676,
    ),
    tried_on="g = X + sin(X)/2 − y, one density, one ξ",
)
def _weak_bracket() -> Evidence:
    """d/dt int xi(X^t) f dx by moving the points, against both brackets by differences of the flux, y' = 1.5."""
    x, h = np.linspace(-9.0, 10.0, 3801), 1e-4

    def paired(flux: Callable[[Floats], Floats], weight: Floats) -> float:
        divergence = YDOT * (flux(x + h) - flux(x - h)) / (2 * h)
        return -float((tested_with(x) * divergence * weight).sum() * (x[1] - x[0]))

    there, back = (tested_with(wavy_flow(x, s * YDOT * h)) for s in (1.0, -1.0))
    rate = float(((there - back) * transported(x, 0.0)).sum() * (x[1] - x[0]) / (2 * h))
    printed = abs(paired(soft, transported(x, 0.0)) - rate)
    right = abs(paired(lambda at: soft(at) * transported(at, 0.0), np.ones_like(x)) - rate)
    return Evidence(
        f"∫ξf dx changes at a rate of {rate:.3f} if the points are moved: −∫ξ div(Φẏ)f dx is off by {printed:.2f}, "
        f"−∫ξ div(Φẏf) dx by {right:.0e}.",
        printed=(at_most("|−⟨ξ, div(Φẏ) f⟩ − d/dt ⟨ξ, f⟩|", printed, 0.0, DIFFERENCE),),
        corrected=(at_most("|−⟨ξ, div(Φẏ f)⟩ − d/dt ⟨ξ, f⟩|", right, 0.0, DIFFERENCE),),
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
    "c5.empirical",
    "For point masses the integrals are the effective mass and force of the particles.",
    source="(5.44) to (5.46)",
    quote="m_eff(μ^emp, y) = m_eff⁽ᴺ⁾(X⁽ᴺ⁾, y), F_eff(μ^emp, y, v) = F_eff⁽ᴺ⁾(X⁽ᴺ⁾, y, v)",
    chosen="F_eff⁽¹⁾ with −mΦᵀΩ, as in (5.14)",
    recorded=Kind.PROVED,
)
def _empirical() -> Evidence:
    return proved(atoms())


@claim(
    "c5.consistency",
    "The motion of particles solves the mean-field equations for their empirical measure.",
    source="Lemma 5.10",
    quote="we can construct X … such that (X, y) is a solution of the … equations (5.40a) to (5.40c)",
    recorded=Kind.PROVED,
)
def _consistency() -> Evidence:
    """The flow at X_j(0) moves by Phi[y'], as X_j(t) does in (5.11b): with h(X^t(x)) for h(x) (5.40a) is (5.11a)."""
    return proved(
        atoms(), identity("(5.6a), (5.6b) without λ_j are (5.11a) with (5.13), (5.14)", eliminated, "−Ω for Ω")
    )
