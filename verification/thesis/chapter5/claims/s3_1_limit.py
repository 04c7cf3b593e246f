"""Chapter 5, sections 3.1 and 3.2: the mean-field equations, particles as measures, weak solutions."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from verification.claims import Correction, Effect, claim
from verification.evidence import Evidence, Kind, at_least, at_most
from verification.thesis.chapter5 import bounded
from verification.thesis.chapter5.bounded import FlowState, force, mass
from verification.thesis.chapter5.instant import Floats, System, instant
from verification.thesis.chapter5.wavy import T, soft, wavy_flow, wavy_motion

# What rounding leaves of sums, what steps of a Runge-Kutta method leave, and central differences of a bisection.
TOL, RUN_TOL, DIFFERENCE = 1e-8, 1e-7, 1e-6
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


@claim(
    "c5.transport",
    "How the density of the particles changes.",
    source="section 1, (5.42b)",
    quote="∂_t f(x, t) = −div_x(f(x, t) Φ(x, y)[ẏ])",
    recorded=Kind.NOT_REFUTED,
    tried_on="g = X + sin(X)/2 − y, one density",
)
def _transport() -> Evidence:
    """df/dt by differences against -(f Phi y')' by differences, y' = 1.5."""
    x, h = np.linspace(-3.0, 4.0, 36), 1e-4
    rate = YDOT * (transported(x, Y + h) - transported(x, Y - h)) / (2 * h)
    flux = [transported(x + s, Y) * soft(x + s) * YDOT for s in (h, -h)]
    off = float(np.abs(rate + (flux[0] - flux[1]) / (2 * h)).max())
    largest = float(np.abs(rate).max())
    return Evidence(
        f"g = X + sin(X)/2 − y: the density that the particles carry along changes at rates of up to {largest:.2f}, "
        f"which is −div(fΦẏ) to {off:.0e}.",
        printed=(
            at_most("|∂_t f + div(fΦẏ)|", off, 0.0, DIFFERENCE),
            at_least("|∂_t f|", largest, WRONG),
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


@claim(
    "c5.empirical",
    "For point masses the integrals are the effective mass and force of the particles.",
    source="(5.44) to (5.46)",
    quote="m_eff(μ^emp, y) = m_eff⁽ᴺ⁾(X⁽ᴺ⁾, y), F_eff(μ^emp, y, v) = F_eff⁽ᴺ⁾(X⁽ᴺ⁾, y, v)",
    recorded=Kind.NOT_REFUTED,
    chosen="F_eff⁽¹⁾ with −mΦᵀΩ, as in (5.14)",
    tried_on="g = X + sin(X)/2 − y, three particles",
)
def _empirical() -> Evidence:
    """The integrals (5.41) over point masses at the particles, against m_eff y'' of the constrained system."""
    X = np.array([0.3, -0.8, 1.7])
    at = FlowState(X, np.full(X.size, 1 / X.size), Y, YDOT)
    found = instant(_system(), X[:, None], np.array([Y]), np.array([YDOT])).a.item()
    off = abs(mass(at) * found - force(at))
    return Evidence(
        f"Three particles: the integrals (5.41) over their empirical measure and ÿ of the constrained system, which "
        f"comes from the Lagrangian, fulfil m_eff ÿ = F_eff = {force(at):.3f} to {off:.0e}.",
        printed=(
            at_most("|m_eff(μ) ÿ − F_eff(μ)|", off, 0.0, TOL),
            at_least("|F_eff|", abs(force(at)), WRONG),
        ),
    )


@claim(
    "c5.consistency",
    "The motion of particles solves the mean-field equations for their empirical measure.",
    source="Lemma 5.10",
    quote="we can construct X … such that (X, y) is a solution of the … equations (5.40a) to (5.40c)",
    recorded=Kind.NOT_REFUTED,
    tried_on="g = X + sin(X)/2 − y, three particles",
)
def _consistency() -> Evidence:
    """Three particles, two in one place, and the measure of two atoms with the weights 2/3 and 1/3."""
    particles = wavy_motion(np.array([0.2, 1.5, 1.5]), np.full(3, 1 / 3))
    measure = wavy_motion(np.array([1.5, 0.2]), np.array([2, 1]) / 3)
    same = float(np.abs(particles[[0, 1, 3, 2]] - measure).max())
    flowed = float(np.abs(wavy_flow(np.array([0.2, 1.5, 1.5]), particles[0]) - particles[2:]).max())
    return Evidence(
        f"g = X + sin(X)/2 − y, three particles, two of them in one place: y, ẏ and X_i at t = {T:g} are those of "
        f"(5.40) for their empirical measure to {same:.0e}, and the flow at X_iⁱⁿⁱᵗ is X_i(t), (5.48), to "
        f"{flowed:.0e}.",
        printed=(
            at_most("particles against their empirical measure", same, 0.0, RUN_TOL),
            at_most("X_i(t) against the flow", flowed, 0.0, RUN_TOL),
        ),
    )
