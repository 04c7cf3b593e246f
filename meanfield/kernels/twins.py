"""Plain NumPy twins of the kernels: same arguments, same results to rounding, written to be read."""

from __future__ import annotations

import numpy as np

from meanfield.kernels.finite_volume import VANISHING, Floats


def _fluxes(f: Floats, speed: Floats) -> Floats:
    """Fluxes across all faces of the first axis; none across the walls."""
    steps = np.diff(f, axis=0)
    left, right = steps[:-1], steps[1:]
    half = np.zeros_like(f)
    limited = np.minimum(0.25 * np.abs(left + right), np.minimum(np.abs(left), np.abs(right)))
    half[1:-1] = np.where(np.sign(left) == np.sign(right), np.sign(left) * limited, 0.0)
    upper, lower = (np.where(f >= VANISHING, f + side * half, 0.0) for side in (1.0, -1.0))
    flux = np.zeros_like(speed)
    flux[1:-1] = speed[1:-1] * np.where(speed[1:-1] < 0.0, lower[1:], upper[:-1])
    return flux


def _given(f: Floats, speed: Floats) -> tuple[Floats, float]:
    """Speed out of each cell of the first axis, and the flux held back by the two walls."""
    outward = np.maximum(np.maximum(speed[1:], -speed[:-1]), 0.0)
    held = np.maximum(-speed[0], 0.0) * f[0] + np.maximum(speed[-1], 0.0) * f[-1]
    return outward, float(held.sum())


def euler_step(
    f: Floats, speed0: Floats, speed1: Floats, ratio: Floats, base: Floats, keep: float, out: Floats
) -> tuple[float, float]:
    """Twin of ``finite_volume.euler_step``."""
    new = f - ratio[0] * np.diff(_fluxes(f, speed0), axis=0) - ratio[1] * np.diff(_fluxes(f.T, speed1.T), axis=0).T
    out[...] = new + keep * (base - new)
    (given0, held0), (given1, held1) = _given(f, speed0), _given(f.T, speed1.T)
    share = 2.0 * (ratio[0] * given0 + ratio[1] * given1.T).max()
    return float(share), ratio[0] * held0 + ratio[1] * held1
