"""The constant L of the proof of (5.60), bounded by interval arithmetic on the region that motions visit.

With an optimal coupling of the two starts that is carried along, D = |y1 - y2| + |v1 - v2| + W1(mu1, mu2) is at most
D* = |y1 - y2| + |v1 - v2| + int |X1 - X2|, equal to D at t = 0, and D*' <= L D* with

    L = max(M_v Lip_x(Phi) + Lip_x(a),  M_v Lip_y(Phi) + Lip_y(a),  1 + sup |Phi| + Lip_v(a)),
    Lip(a) <= Lip(F) + sup |F| Lip(m)      for a = F_eff/m_eff with m_eff >= 1 (Lemma 5.7),

all on the levels c = g(X, y), y and v: the proof of Theorem 5.16 with C = 1. The region of (X, y) is convex for
StraightFibre (a wedge) and LinearFibre, so that derivatives bound differences; for WavyFibre all y are taken with all X
that belong to some level and y.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from verification.claims.formal.enclosures import least_upper_bound
from verification.thesis.chapter5.cases import FIBRE

# Far above the error of a position that a root finder gives.
ROUNDING = 1e-9


class Shares(NamedTuple):
    """What one particle contributes, with its slopes in X and in y: Phi, Phi Omega and F0 + Phi F1, without V."""

    phi: Any
    phi_x: Any
    phi_y: Any
    bend: Any
    bend_x: Any
    force: Any
    force_x: Any
    force_y: Any


def straight(c: Any, y: Any) -> Shares:
    """Return the shares for g = X/y at X = c y."""
    k0, k1, rest = (FIBRE[name] for name in ("k0", "k1", "y_rest"))
    pull = -k0 * (y - rest) - k1 * c * c * y
    return Shares(c, 1 / y, -c / y, 0 * c, 0 * c, pull, -2 * k1 * c, -k0 + k1 * c * c)


def linear(c: Any, y: Any) -> Shares:
    """Return the shares for g = X - y at X = c + y."""
    k0, k1, rest = (FIBRE[name] for name in ("k0", "k1", "y_rest"))
    return Shares(0 * c + 1, 0 * c, 0 * c, 0 * c, 0 * c, -k0 * (y - rest) - k1 * (c + y), 0 * c - k1, 0 * c - k0)


def wavy(X: Any, y: Any) -> Shares:
    """Return the shares for g = X + sin(X)/2 - y at X; Phi and Omega do not depend on y."""
    k0, k1, rest = (FIBRE[name] for name in ("k0", "k1", "y_rest"))
    phi, sine = 2 / (2 + X.cos()), X.sin() / 2
    phi_x = sine * phi * phi
    bend = sine * phi**4
    bend_x = X.cos() / 2 * phi**4 + 4 * sine * sine * phi**5
    pull = -k0 * (y - rest) - k1 * X * phi
    return Shares(phi, phi_x, 0 * X, bend, bend_x, pull, -k1 * (phi + X * phi_x), 0 * X - k0)


SHARES = {"straight": straight, "linear": linear, "wavy": wavy}
# Of the bounds; those of WavyFibre are reached inside of the region, where it takes many boxes to be near them.
SLACK = {"straight": 1e-6, "linear": 1e-6, "wavy": 1e-4}


def lipschitz(name: str, reached: pd.DataFrame) -> float:
    """Return a bound of L on the levels, y and v that all motions of a model visit, nx = ny = 1."""
    first, y, v = (_axis(reached, axis) for axis in ("level", "y", "v"))
    if name == "wavy":
        first = _positions(first[0] + y[0], first[1] + y[1])
    m, fastest = FIBRE["m"], max(map(abs, v))

    def largest(part: Callable[[Shares], Any]) -> float:
        return least_upper_bound(lambda a, b: abs(part(SHARES[name](a, b))), [first, y], SLACK[name])

    def at_most(part: Callable[[Shares, float], Any]) -> float:
        return max(largest(lambda at: part(at, 0.0)), largest(lambda at: part(at, fastest**2)))

    force = at_most(lambda at, w: at.force - m * w * at.bend)
    force_x, force_y = at_most(lambda at, w: at.force_x - m * w * at.bend_x), largest(lambda at: at.force_y)
    phi, phi_x, phi_y = largest(lambda at: at.phi), largest(lambda at: at.phi_x), largest(lambda at: at.phi_y)
    mass_x, mass_y = largest(lambda at: 2 * m * at.phi * at.phi_x), largest(lambda at: 2 * m * at.phi * at.phi_y)
    along_x, along_y = force_x + force * mass_x, force_y + force * mass_y
    bend = 2 * m * fastest * largest(lambda at: at.bend)
    return float(max(fastest * phi_x + along_x, fastest * phi_y + along_y, 1 + phi + bend))


def _axis(reached: pd.DataFrame, name: str) -> tuple[float, float]:
    return float(reached[f"least_{name}"].min()), float(reached[f"largest_{name}"].max())


def _positions(low: float, high: float) -> tuple[float, float]:
    """Return an interval that holds all X with low <= X + sin(X)/2 <= high; its slope is at least 1/2."""
    least, most = (brentq(lambda x, at: x + np.sin(x) / 2 - at, at - 1, at + 1, (at,)) for at in (low, high))
    return least - ROUNDING, most + ROUNDING
