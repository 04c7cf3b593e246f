"""Closed forms of Examples 5.2 and 5.3 with linear forces, from (5.6) by hand."""

from typing import NamedTuple

import numpy as np

from meanfield import LinearFibre, State, StraightFibre

M, K0, REST, K1 = 0.7, 1.2, 0.9, 0.4
FIBRE = {"m": M, "k0": K0, "y_rest": REST, "k1": K1}
Y0, V0 = 1.3, 0.4
TIMES = np.linspace(0.0, 4.0, 9)


def fibre_start(n=20):
    return State(X=0.2 + 1.3 * np.random.default_rng(3).random((n, 1)), y=[Y0], v=[V0])


class Exact(NamedTuple):
    """y, v (K, 1), X, U and multipliers (K, N, 1) at K times."""

    y: np.ndarray
    v: np.ndarray
    X: np.ndarray
    U: np.ndarray
    multipliers: np.ndarray


def harmonic(stiffness, pull, mass, t):
    """Compute y, y' and y'' of mass y'' = pull - stiffness y, (K, 1, 1) each."""
    omega, rest, t = np.sqrt(stiffness / mass), pull / stiffness, t[:, None, None]
    a, b, cos, sin = Y0 - rest, V0 / omega, np.cos(omega * t), np.sin(omega * t)
    return rest + a * cos + b * sin, omega * (b * cos - a * sin), -(omega**2) * (a * cos + b * sin)


def straight(start, t):
    """Solve Example 5.2: X_i = c_i y, lambda_i = y (F1 - m c_i y'') from m X_i'' = F1 - lambda_i/y, y from (5.6b)."""
    c = start.X[None] / Y0
    square = (c**2).mean()
    y, v, a = harmonic(K0 + K1 * square, K0 * REST, 1 + M * square, t)
    return Exact(y[:, 0], v[:, 0], c * y, c * v, -y * (K1 * c * y + M * c * a))


def linear(start, t):
    """Solve Example 5.3: X_i = y + d_i, lambda_i = F1 - m y''; (5.6b) with g_y = -1 gives (1 + m) y'' = F0 + <F1>."""
    d = start.X[None] - Y0
    y, v, a = harmonic(K0 + K1, K0 * REST - K1 * d.mean(), 1 + M, t)
    return Exact(y[:, 0], v[:, 0], y + d, v + 0 * d, -K1 * (y + d) - M * a)


def worst(motion, other):
    """Compute the largest difference of a motion from an exact solution, over all its arrays."""
    return max(float(np.abs(getattr(motion, name) - getattr(other, name)).max()) for name in Exact._fields)


CLOSED = {"straight": (StraightFibre, straight), "linear": (LinearFibre, linear)}
