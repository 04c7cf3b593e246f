"""A fibre with forces and interaction that fulfils all assumptions of chapter 5, section 2.4.

g = X + sin(X)/2 - y, W0 = -cos y, W1 = sqrt(1 + X^2), V(r) = sqrt(1 + r^2); Phi and Omega do not depend on y.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from verification.thesis.chapter5.instant import Floats
from verification.thesis.chapter5.wavy import soft

M = 0.7


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
