"""Reference implementation of ``meanfield.solvers.grid.finite_volume`` in NumPy: same arguments, same results."""

from __future__ import annotations

import numpy as np

from meanfield.solvers.grid.finite_volume import VANISHING, Floats


def _fluxes(f: Floats, speed: Floats) -> Floats:
    """Compute the fluxes across all faces of the first axis; none across the walls."""
    steps = np.diff(f, axis=0)
    left, right = steps[:-1], steps[1:]
    half = np.zeros_like(f)
    limited = np.minimum(0.25 * np.abs(left + right), np.minimum(np.abs(left), np.abs(right)))
    half[1:-1] = np.where(np.sign(left) == np.sign(right), np.sign(left) * limited, 0.0)
    upper, lower = (np.where(f >= VANISHING, f + side * half, 0.0) for side in (1.0, -1.0))
    flux = np.zeros_like(speed)
    flux[1:-1] = speed[1:-1] * np.where(speed[1:-1] < 0.0, lower[1:], upper[:-1])
    return flux


def _outward(f: Floats, speed: Floats) -> tuple[Floats, float]:
    """Compute the speed out of each cell of the first axis, and the flux that the two walls hold back."""
    outward = np.maximum(np.maximum(speed[1:], -speed[:-1]), 0.0)
    blocked = np.maximum(-speed[0], 0.0) * f[0] + np.maximum(speed[-1], 0.0) * f[-1]
    return outward, float(blocked.sum())


def euler_step(
    f: Floats, speed0: Floats, speed1: Floats, ratio: Floats, start: Floats, start_weight: float, out: Floats
) -> tuple[float, float]:
    """Compute the same as ``finite_volume.euler_step``."""
    new = f - ratio[0] * np.diff(_fluxes(f, speed0), axis=0) - ratio[1] * np.diff(_fluxes(f.T, speed1.T), axis=0).T
    out[...] = new + start_weight * (start - new)
    (outward0, blocked0), (outward1, blocked1) = _outward(f, speed0), _outward(f.T, speed1.T)
    outflow = 2.0 * (ratio[0] * outward0 + ratio[1] * outward1.T).max()
    return float(outflow), ratio[0] * blocked0 + ratio[1] * blocked1
