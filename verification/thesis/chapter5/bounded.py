"""A fibre with forces and interaction that fulfils all assumptions of chapter 5, section 2.4, with its constants.

g = X + sin(X)/2 - y, W0 = -cos y, W1 = sqrt(1 + X^2), V(r) = sqrt(1 + r^2); Phi and Omega do not depend on y.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from verification.formal.enclosures import least_upper_bound
from verification.thesis.chapter5.instant import Floats
from verification.thesis.chapter5.wavy import soft

M = 0.7
# A little more than a period of Phi and Omega.
PERIOD = (-3.1416, 3.1416)


def omega(x: Floats) -> Floats:
    """Return Omega(X)[1, 1] = Phi'(X) Phi(X)."""
    return np.asarray(np.sin(x) / 2 * soft(x) ** 3)


def root(x: Floats) -> Floats:
    """Return x/sqrt(1 + x^2): the slope of sqrt(1 + x^2), bounded by 1 and with slopes of at most 1."""
    return np.asarray(x / np.sqrt(1 + x**2))


class FlowState(NamedTuple):
    """Atoms X with weights w that sum to 1, and y, v of the macroscopic component."""

    X: Floats
    w: Floats
    y: float
    v: float


def mass(at: FlowState) -> float:
    """Return m_eff of (5.41a)."""
    return float(1 + M * (at.w @ soft(at.X) ** 2))


def force(at: FlowState) -> float:
    """Return F_eff of (5.41b), with -m Phi^T Omega[v, v]."""
    pull = at.w @ root(at.X[:, None] - at.X[None, :])
    each = -root(at.X) + pull - M * omega(at.X) * at.v**2
    return float(-np.sin(at.y) + at.w @ (soft(at.X) * each))


class Constants(NamedTuple):
    """Bounds M and Lipschitz constants L, by the rule for products, where |v| <= speed."""

    m_phi: float
    l_phi: float
    m_force: float
    l_force: float
    l_mass: float


@cache
def bounds() -> tuple[float, float, float, float]:
    """Return proved bounds of Phi, Phi', Omega and Omega' over one period, by interval arithmetic."""
    functions: tuple[Callable[[Any], Any], ...] = (
        lambda x: 2 / (2 + x.cos()),
        lambda x: abs(2 * x.sin() / (2 + x.cos()) ** 2),
        lambda x: abs(4 * x.sin() / (2 + x.cos()) ** 3),
        lambda x: abs(4 * (x.cos() * (2 + x.cos()) + 3 * x.sin() * x.sin()) / (2 + x.cos()) ** 4),
    )
    m_phi, l_phi, m_omega, l_omega = (least_upper_bound(each, [PERIOD]) for each in functions)
    return m_phi, l_phi, m_omega, l_omega


def constants(speed: float) -> Constants:
    """Return those of Phi, F_eff and m_eff; the bounds and slopes of F0, F1 and K are 1."""
    m_phi, l_phi, m_omega, l_omega = bounds()
    m_force = 1 + m_phi * 2 + M * m_phi * m_omega * speed**2
    in_x = l_phi * 2 + m_phi * (1 + 2) + M * (l_phi * m_omega + m_phi * l_omega) * speed**2
    in_v = 2 * M * m_phi * m_omega * speed
    return Constants(m_phi, l_phi, m_force, max(1.0, in_x, in_v), 2 * M * m_phi * l_phi)
