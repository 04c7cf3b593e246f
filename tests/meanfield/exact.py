"""Starts, and solutions in closed form to 40 digits, for tests of all particle solvers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import mpmath
import numpy as np

from meanfield import LinearFibre, State, StraightFibre

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from meanfield import Motion

M, K0, REST, K1 = 0.7, 1.2, 0.9, 0.4
FIBRE = {"m": M, "k0": K0, "y_rest": REST, "k1": K1}
Y0, V0 = 1.3, 0.4
TIMES = np.linspace(0.0, 4.0, 9)


def fibre_start(n: int = 20) -> State:
    return State(X=0.2 + 1.3 * np.random.default_rng(3).random((n, 1)), y=[Y0], v=[V0])


class Exact(NamedTuple):
    y: NDArray[np.float64]
    v: NDArray[np.float64]
    X: NDArray[np.float64]
    U: NDArray[np.float64]
    multipliers: NDArray[np.float64]


def harmonic(stiffness: Any, pull: Any, mass: Any, times: NDArray[np.float64]) -> list[tuple[Any, Any, Any]]:
    """Compute y, y' and y'' of mass y'' = pull - stiffness y at each time, to 40 digits."""
    with mpmath.workdps(40):
        omega, rest = mpmath.sqrt(stiffness / mass), pull / stiffness
        a, b = mpmath.mpf(Y0) - rest, mpmath.mpf(V0) / omega
        waves = [(mpmath.cos(omega * t), mpmath.sin(omega * t)) for t in map(mpmath.mpf, times)]
        return [(rest + a * c + b * s, omega * (b * c - a * s), -(omega**2) * (a * c + b * s)) for c, s in waves]


def straight(start: State, t: NDArray[np.float64]) -> Exact:
    """Solve Example 5.2: X_i = c_i y, lambda_i = y (F1 - m c_i y'') from m X_i'' = F1 - lambda_i/y, y from (5.6b)."""
    c = [mpmath.mpf(x) / mpmath.mpf(Y0) for x in np.asarray(start.X)[:, 0]]
    square = sum(x**2 for x in c) / len(c)
    motion = harmonic(K0 + K1 * square, mpmath.mpf(K0) * REST, 1 + M * square, t)
    return exact(
        motion, lambda y: [x * y for x in c], lambda v: [x * v for x in c], lambda y, x, a: y * (-K1 * x - M * a)
    )


def linear(start: State, t: NDArray[np.float64]) -> Exact:
    """Solve Example 5.3: X_i = y + d_i, lambda_i = F1 - m y''; (5.6b) with g_y = -1 gives (1 + m) y'' = F0 + <F1>."""
    d = [mpmath.mpf(x) - mpmath.mpf(Y0) for x in np.asarray(start.X)[:, 0]]
    mean = sum(d) / len(d)
    motion = harmonic(mpmath.mpf(K0) + K1, mpmath.mpf(K0) * REST - K1 * mean, 1 + mpmath.mpf(M), t)
    return exact(motion, lambda y: [y + x for x in d], lambda v: [v] * len(d), lambda _, x, a: -K1 * x - M * a)


def exact(
    motion: list[tuple[Any, Any, Any]],
    positions: Callable[[Any], list[Any]],
    rate: Callable[[Any], list[Any]],
    multiplier: Callable[[Any, Any, Any], Any],
) -> Exact:
    """Build arrays from y, y', y'' and the particles as functions of them; ``rate`` maps y' to X' and y'' to X''."""
    multipliers = [
        [multiplier(y, x, a) for x, a in zip(positions(y), rate(second), strict=True)] for y, _, second in motion
    ]
    return Exact(
        np.array([[y] for y, _, _ in motion], dtype=float),
        np.array([[v] for _, v, _ in motion], dtype=float),
        np.array([positions(y) for y, _, _ in motion], dtype=float)[..., None],
        np.array([rate(v) for _, v, _ in motion], dtype=float)[..., None],
        np.array(multipliers, dtype=float)[..., None],
    )


def worst(motion: Motion, other: Any) -> float:
    """Compute the largest difference of a motion from an exact solution, over all its arrays."""
    return max(float(np.abs(getattr(motion, name) - getattr(other, name)).max()) for name in Exact._fields)


CLOSED = {"straight": (StraightFibre, straight), "linear": (LinearFibre, linear)}
