"""The direction in which a set curves away from a normal the fastest."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dincl.projection.cone import split

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.rows.base import StackedRows

# Central differences of the gradients, with this step relative to the largest coordinate: the cube root of rounding.
STEP = float(np.cbrt(np.finfo(float).eps))
# Alternations between the direction and its multipliers; two or three are enough, more polish.
ALTERNATIONS = 6
# Newton steps onto the rows that push; from a distance of reach^2 three are enough.
NEWTON = 3
# Multipliers below this part of the largest do not push.
PUSHING = 1e-6


class Bending:
    r"""max over w of sum_k lambda_k w^T (Hess g_k) w with |w| = 1 and grad g_k . w = 0 for the rows that push.

    Along such a w the set leaves the tangent plane of the normal n = -sum_k lambda_k grad g_k, |n| = 1, by half of
    that: a point y of S near x has n . (y - x) = |y - x|^2 / (2 eta), 1/eta the maximum. Direction and multipliers
    are improved in turn; each turn raises the ratio.
    """

    def __init__(self, rows: StackedRows, keep: NDArray[np.bool_], x: NDArray[np.float64]) -> None:
        self._x, self._rows, self._keep = x, rows, keep
        self._gradients: csr_array = rows.jacobian(x)[keep]
        self._dense = self._gradients.toarray()
        step = STEP * max(1.0, float(np.abs(x).max()))
        self._hessians = np.empty((*self._dense.shape, x.size))
        for place in range(x.size):
            shift = np.zeros(x.size)
            shift[place] = step
            ahead, behind = (rows.jacobian(x + sign * shift.reshape(x.shape))[keep] for sign in (1, -1))
            self._hessians[:, :, place] = (ahead.toarray() - behind.toarray()) / (2 * step)

    def direction(self, weights: NDArray[np.float64]) -> NDArray[np.float64]:
        """The w (n,) for multipliers (m,), of unit length."""
        pushing = self._dense[weights > PUSHING * weights.max()]
        _, sizes, right = np.linalg.svd(pushing)
        rank = int((sizes > PUSHING * sizes[0]).sum())
        free = right[rank:].T
        if not free.size:
            return np.array(right[-1])
        curvature = free.T @ np.tensordot(weights, self._hessians, 1) @ free
        w: NDArray[np.float64] = free @ np.linalg.eigh((curvature + curvature.T) / 2)[1][:, -1]
        return w

    def climb(
        self, weights: NDArray[np.float64], reach: float, nearest: Callable[[NDArray[np.float64]], NDArray[np.float64]]
    ) -> list[NDArray[np.float64]]:
        """Points y of S at a distance of about ``reach``, found from multipliers (m,) to start with."""
        found = []
        for _ in range(ALTERNATIONS):
            w = self.direction(weights).reshape(self._x.shape)
            y = nearest(self._onto(self._x + reach * w, weights > PUSHING * weights.max()))
            found.append(y)
            weights = split((self._x - y).ravel(), self._gradients).multipliers
            if not weights.max(initial=0.0) > 0:
                break
        return found

    def _onto(self, y: NDArray[np.float64], pushing: NDArray[np.bool_]) -> NDArray[np.float64]:
        """y moved along the gradients to where the gaps of the rows that push are zero; exact where these agree."""
        for _ in range(NEWTON):
            gap = self._rows.values(y)[self._keep][pushing]
            matrix = self._rows.jacobian(y)[self._keep].toarray()[pushing]
            y = y - np.linalg.lstsq(matrix, gap, rcond=PUSHING)[0].reshape(y.shape)
        return y
