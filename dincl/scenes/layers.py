"""Loose layers of discs or balls, one resting on the other: the start of a pile."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

# Mean radius, and how far single ones differ from it: enough that the pile does not crystallise.
RADIUS = 0.5
SPREAD = 0.05
# Largest sideways displacement from the lattice, and its period: neighbours in a layer never overlap.
JITTER = 0.02
PERIOD = 2 * (RADIUS + SPREAD + JITTER)
# Largest gap between a disc and the lower ones that carry it: at speed 1 it closes within a few time steps.
GAP = 1e-3


class LooseLayers(NamedTuple):
    """Centres (n, d), radii (n,), and the width of the box around them along each horizontal axis [length]."""

    x: NDArray[np.float64]
    radius: NDArray[np.float64]
    width: float


# A scene of more does not fit into memory with its contacts.
MOST_DISCS = 10_000_000


def layers(n: int, d: int, rng: np.random.Generator) -> LooseLayers:
    """n discs or balls without overlap above the floor x_d = 0, numbered layer by layer from below.

    Each layer is a jittered lattice, shifted by half a period against the one below; its heights are the lowest that
    clear the two layers below, plus a random gap. Layers farther below cannot be met: a disc lies at least 0.89 above
    the one of its place two layers below and 0.25 above its neighbours one layer below (the smallest radii, the largest
    sideways shifts, d = 3), so always more than 2 r_max = 1.1 above those three or more layers below.
    """
    side = _side(n, d)
    shape = (-(-n // side ** (d - 1)), *(side,) * (d - 1))
    radius = RADIUS + SPREAD * rng.uniform(-1, 1, shape)
    lateral = np.moveaxis(np.indices(shape)[1:], 0, -1) + 0.5 * _parity(shape[0]).reshape(-1, *(1,) * d)
    lateral = PERIOD * (lateral + 0.5) + JITTER * rng.uniform(-1, 1, (*shape, d - 1))
    gap = GAP * rng.uniform(0, 1, shape)
    height = _heights(lateral, radius, gap)
    x = np.concatenate((lateral, height[..., None]), axis=-1).reshape(-1, d)
    return LooseLayers(x[:n], radius.reshape(-1)[:n], (side + 0.5) * PERIOD)


def _side(n: int, d: int) -> int:
    """The smallest integer with side^d >= n: about as many layers as there are discs along a layer."""
    side = int(n ** (1 / d) + 0.5)
    if side**d < n:
        side += 1
    return side


def _parity(count: int) -> NDArray[np.int64]:
    return np.arange(count) % 2


def _heights(
    lateral: NDArray[np.float64], radius: NDArray[np.float64], gap: NDArray[np.float64]
) -> NDArray[np.float64]:
    height = radius + gap
    sideways = lateral.shape[-1]
    for k in range(1, len(radius)):
        lowest = height[k] - gap[k]
        if k >= 2:
            _clear(lowest, (lateral[k], radius[k]), (lateral[k - 2], radius[k - 2], height[k - 2]))
        for corner in product((0, 1), repeat=sideways):
            shift = [c if k % 2 else c - 1 for c in corner]
            here, there = _overlap(shift, radius.shape[1])
            below = (lateral[k - 1][there], radius[k - 1][there], height[k - 1][there])
            _clear(lowest[here], (lateral[k][here], radius[k][here]), below)
        height[k] = lowest + gap[k]
    return height


def _overlap(shift: list[int], side: int) -> tuple[tuple[slice, ...], tuple[slice, ...]]:
    """The places of a layer, and the places that lie ``shift`` away in another, where both exist."""
    here = tuple(slice(max(0, -s), side - max(0, s)) for s in shift)
    there = tuple(slice(max(0, s), side - max(0, -s)) for s in shift)
    return here, there


def _clear(
    lowest: NDArray[np.float64],
    disc: tuple[NDArray[np.float64], NDArray[np.float64]],
    below: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]],
) -> None:
    """Raise ``lowest`` in place until the discs clear those below them."""
    reach = (disc[1] + below[1]) ** 2 - ((disc[0] - below[0]) ** 2).sum(axis=-1)
    np.maximum(lowest, below[2] + np.sqrt(reach), out=lowest)
