"""Models of Section 2.3 of chapter 5 with linear forces, and one model whose effective mass changes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.checks import number, shaped
from dincl.errors import InvalidProblem
from meanfield.model.model import Model
from meanfield.model.symbolic import library

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike

# X + a sin(X) is one to one for |a| below this value.
MAX_AMPLITUDE = 1.0


def StraightFibre(*, m: float, k0: float, y_rest: float, k1: float) -> Model:
    """Build Example 5.2, g = X/y: a straight fibre of length y whose cross-bridges stretch with it.

    Phi = X/y, Omega = 0. The effective mass is 1 + m <X^2>/y^2; (5.22) prints m + <X^2>/y^2. It is constant along the
    motion, because X_i/y is constant. The forces are F0 = -k0 (y - y_rest), F1 = -k1 X.
    """
    return Model(g=lambda X, y: X / y, W0=_spring(k0, [y_rest]), W1=_spring(k1, [0.0]), m=m)


def LinearFibre(*, m: float, k0: float, y_rest: float, k1: float) -> Model:
    """Build Example 5.3, g = X - y (5.25): all cross-bridges are shifted by the same distance.

    Phi = 1, Omega = 0. The effective mass is 1 + m; (5.28) and (5.30) print m. The forces are F0 = -k0 (y - y_rest),
    F1 = -k1 X.
    """
    return Model(g=lambda X, y: X - y, W0=_spring(k0, [y_rest]), W1=_spring(k1, [0.0]), m=m)


def WavyFibre(*, m: float, k0: float, y_rest: float, k1: float, amplitude: float = 0.5) -> Model:
    """Build g = X + a sin(X) - y with amplitude |a| < 1: cross-bridges that move faster where the fibre is soft.

    Phi = 1/(1 + a cos X), Omega[v, v] = a sin(X) v^2/(1 + a cos X)^3. The effective mass 1 + m <Phi^2> changes along
    the motion; in the examples of the thesis it is constant. The forces are F0 = -k0 (y - y_rest), F1 = -k1 X.
    """
    a = number("amplitude", amplitude)
    if not abs(a) < MAX_AMPLITUDE:
        raise InvalidProblem(f"amplitude = {a:g}: must be between -1 and 1, or y does not determine X")
    ca = library()
    return Model(g=lambda X, y: X + a * ca.sin(X) - y, W0=_spring(k0, [y_rest]), W1=_spring(k1, [0.0]), m=m)


def TissueElement(*, m: float, k0: float, y_rest: ArrayLike, k1: float) -> Model:
    """Build Example 5.4, g = F(y)^{-1} X with F(y) = ((y1, y3), (y3, y2)): a plane element with stretches and shear.

    Phi[v] = F(v) F(y)^{-1} X and Omega = 0, because X = F(y) xi with xi constant. The effective mass is constant. The
    forces are F0 = -k0 (y - y_rest), F1 = -k1 X; ``y_rest`` has shape (3,).
    """
    ca = library()

    def constraint(X: Any, y: Any) -> Any:
        # 1/det(F) depends on y alone: formed first, it saves a division per particle.
        a, b, c = ca.vertsplit(y * (1 / (y[0] * y[1] - y[2] ** 2)))
        return ca.vertcat(b * X[0] - c * X[1], a * X[1] - c * X[0])

    rest = shaped("y_rest", y_rest, (3,))
    return Model(g=constraint, W0=_spring(k0, rest), W1=_spring(k1, np.zeros(2)), m=m, nx=2, ny=3)


def _spring(stiffness: float, rest: Iterable[float]) -> Any:
    """Return the energy k |z - rest|^2 / 2 as a function of z."""
    k = number("k", stiffness, non_negative=True)
    at = [number("y_rest", value) for value in rest]
    ca = library()
    return lambda z: k / 2 * ca.sumsqr(z - ca.DM(at))
