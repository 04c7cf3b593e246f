"""Chapter 5, section 2.3: the linearised constraint (Example 5.3)."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from verification.claim import Claim, Tables, Verdict, corrected_if, holds_if
from verification.claims.chapter5_examples import ONE, PLANE, X0, M, shifted, tissue, with_springs
from verification.claims.instant import effective_mass, force0, force1, instant, omega, phi, slopes
from verification.claims.measure import shift_rate, tested

# What central differences of numbers that are right to rounding leave.
TOL = 1e-8
N, Y_C = 50, 2.0


def scaled(x: float, y_c: float, x_c: float) -> float:
    """X~ = (y_c/X_c) X."""
    return y_c / x_c * x


def _length(_: Tables) -> Verdict:
    """X~ - y in metres and in millimetres: a length is a thousand times as many."""

    def unfit(x_c: Callable[[float], float]) -> float:
        x, y, unit = 0.03, 1.9, 1000.0
        small, large = (scaled(x * s, Y_C * s, x_c(Y_C * s)) - y * s for s in (1.0, unit))
        return abs(large / (unit * small) - 1)

    printed, right = unfit(lambda _: 1 / N), unfit(lambda y_c: y_c / N)
    return corrected_if(
        printed < TOL,
        right < TOL,
        f"X_c must be a length, as in O(y_c/N): from m to mm X̃ − y with X̃ = N y_c X grows by {1 + printed:.1f} times "
        f"what a length does, with X_c = y_c/N, so X̃ = N X, by {1 + right:g} times. Then (5.24) ends in − y/(N y_c)",
    )


def _linearised(_: Tables) -> Verdict:
    """The slopes of X/y where it is linearised, against those of (5.24)."""
    g = with_springs(lambda X, y: X / y).g
    at, y = np.array([[1 / N]]), np.array([Y_C])
    found = slopes(lambda x: g(x, y), at).item(), slopes(lambda z: g(at, z), y).item()
    off = max(abs(found[0] - 1 / Y_C), abs(found[1] + 1 / (N * Y_C**2)))
    return holds_if(
        off < TOL,
        f"for this X_c the slopes of X/y are those of (5.24) to {off:.0e}; a constant is left out, which is fine",
    )


def _coordinates(_: Tables) -> Verdict:
    """The effective mass of y from the linearised constraint (5.24) in the coordinate X, with X_c = y_c/N."""
    ratio = 1 / N
    at = instant(with_springs(lambda X, y: X / Y_C - ratio * y / Y_C), X0 * ratio, *ONE)
    force = force0(at.system, at.y) + ratio * force1(at.system, at.X).mean()
    found = (force / at.a).item()
    return corrected_if(
        abs(found - 1 - M) < TOL,
        abs(found - 1 - M * ratio**2) < TOL,
        f"a coordinate of the particles cannot change the mass of y: with X_c/y_c = {ratio:g}, m = {M:g} it is "
        f"{found:.5f} = 1 + m(X_c/y_c)², not 1 + m: for m and F₁, (5.26) and (5.27) must have those of X̃, which are "
        "m(X_c/y_c)² and (X_c/y_c)F₁",
    )


def _linear_mass(_: Tables) -> Verdict:
    at = shifted()
    off = abs((effective_mass(at.system, at.X, at.y) - (M + 1)).item())
    return holds_if(off < TOL, f"read as 1 + m, both being numbers (ny = 1), it agrees with (5.13) to {off:.0e}")


def _linear_newton(_: Tables) -> Verdict:
    at = shifted()
    force = force0(at.system, at.y) + force1(at.system, at.X).mean()
    printed, right = (float(np.abs(mass * at.a - force).max()) for mass in (M, 1 + M))
    return corrected_if(
        printed < TOL,
        right < TOL,
        f"mÿ misses the force by {printed:.2f}, (1 + m)ÿ, as (5.26) says, by {right:.0e}: the mass of y itself is "
        "left out; (5.30) likewise",
    )


def _linear_velocity(_: Tables) -> Verdict:
    at = shifted()
    printed, right = (float(np.abs(side - at.v).max()) for side in (at.X, at.U))
    return corrected_if(
        printed < TOL, right < TOL, f"X̃_i differs from ẏ by {printed:.2f}, its derivative by {right:.0e}"
    )


def _linear_transport(_: Tables) -> Verdict:
    v = ONE[1][0]
    by_flow, by_formula = tested(lambda x: 0 * x + v, lambda x, f: shift_rate(x, f, v), 1)
    off = abs(by_flow - by_formula)
    return holds_if(
        off < TOL < abs(by_flow), f"∫ξf dx of a smooth ξ changes by (5.31) as by moving the particles, to {off:.0e}"
    )


def _linear_map(_: Tables) -> Verdict:
    """g = G y - X, and the level of the positions that are said to solve X' = G y'."""
    G = np.array([[0.3, -0.2, 0.7], [0.5, 0.1, -0.4]])
    at = instant(with_springs(lambda X, y: G @ y - X), tissue().X, *PLANE)
    later = at.y + np.array([0.4, -0.9, 1.3])
    level = at.system.g(at.X + G @ (later - at.y), later) - at.system.g(at.X, at.y)
    curved = np.abs(omega(at.system, at.X, at.y, at.v, at.v)).max()
    off = max(np.abs(phi(at.system, at.X, at.y) - G).max(), curved, np.abs(level).max())
    return holds_if(off < TOL, f"Φ = G, Ω = 0, and g keeps its value at X_iⁱⁿⁱᵗ + G(y − yⁱⁿⁱᵗ), to {off:.0e}")


CLAIMS = (
    Claim("c5.characteristic-length", "Example 5.3", "X_iⁱⁿⁱᵗ ∈ O(y_c/N) … X_i ≈ X_c = 1/N", _length),
    Claim("c5.linearised", "(5.24)", "g(X_i, y) ≈ X_i/y_c − y/(N y_c²)", _linearised),
    Claim(
        "c5.coordinates",
        "Example 5.3",
        "the coordinate change X̃_i = y_c/X_c X_i yields … m_eff = m I + 1",
        _coordinates,
    ),
    Claim("c5.linear-mass", "(5.26)", "for g_L = X̃_i − y: m_eff = m I + 1", _linear_mass),
    Claim("c5.linear-newton", "(5.28), (5.30)", "mÿ = F₀(y) + 1/N Σ_j F₁(X̃_j)", _linear_newton),
    Claim("c5.linear-velocity", "(5.29)", "X̃_i = ẏ", _linear_velocity),
    Claim("c5.linear-transport", "(5.31)", "∂_t f(x, t) = −∂_x(f(x, t) ẏ(t))", _linear_transport),
    Claim(
        "c5.linear-map",
        "after (5.31)",
        "g = Gy − X_i imply that Φ = G is constant and Ω = 0 … X_i(t) = X_iⁱⁿⁱᵗ + G(y(t) − yⁱⁿⁱᵗ)",
        _linear_map,
    ),
)
