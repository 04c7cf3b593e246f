"""Scenes of many discs or balls that settle on a floor between walls, from loose layers."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.checks import integer
from dincl.checks import seed as checked_seed
from dincl.constraints import HalfSpace, NonOverlap
from dincl.drifts import constant
from dincl.scenes.base import Scene

if TYPE_CHECKING:
    from dincl.compiled.arrays import Floats

# Mean radius, and how far single ones differ from it: enough that the pile does not crystallise.
RADIUS = 0.5
SPREAD = 0.05
# Largest sideways displacement from the lattice, and its period: neighbours in a layer never overlap.
JITTER = 0.02
PERIOD = 2 * (RADIUS + SPREAD + JITTER)
# Largest gap between a disc and the lower ones that carry it: at speed 1 it closes within a few time steps.
GAP = 1e-3
# A scene of more does not fit into memory with its contacts.
MOST_DISCS = 10_000_000


def pile(n: int, seed: int = 0) -> Scene:
    """X_i' in (0, -1) - N_i, n discs of radius 0.45 ... 0.55 in a box that is open above, about sqrt(n) wide.

    They start in loose rows, numbered row by row from below, each disc almost touching one that carries it. From the
    floor upwards the rows give way sideways and mix, while those above still fall as one. The start depends on n and
    ``seed`` alone.
    """
    return _pile(n, seed, 2, name="pile", bodies="discs")


def ball_pile(n: int, seed: int = 0) -> Scene:
    """X_i' in (0, 0, -1) - N_i, n balls of radius 0.45 ... 0.55 in a box that is open above, about n^(1/3) wide.

    They start in loose layers, numbered layer by layer from below, each ball almost touching one that carries it. From
    the floor upwards the layers give way sideways and mix, while those above still fall as one. The start depends on n
    and ``seed`` alone.
    """
    return _pile(n, seed, 3, name="ball_pile", bodies="balls")


def _pile(n: int, seed: int, d: int, name: str, bodies: str) -> Scene:
    count = integer("n", n, least=1, most=MOST_DISCS)
    x, radius, width = _layers(count, d, np.random.default_rng(checked_seed("seed", seed)))
    axes = np.eye(d, dtype=np.int64)
    walls = [HalfSpace(normal=tuple(axes[-1]), radius=radius)]
    for axis in axes[:-1]:
        walls.append(HalfSpace(normal=tuple(axis), radius=radius))
        walls.append(HalfSpace(normal=tuple(-axis), offset=-width, radius=radius))
    return Scene(
        x,
        constant(np.tile(-axes[-1], (count, 1))),
        [NonOverlap(radius), *walls],
        name=name,
        title=f"A pile of {count} {bodies}",
        times=(1.0, 2.0),
        radius=radius,
    )


def _layers(n: int, d: int, rng: np.random.Generator) -> tuple[Floats, Floats, float]:
    """Place n discs or balls without overlap above the floor x_d = 0, numbered layer by layer from below.

    Returns centres (n, d), radii (n,) and the width of the box along each horizontal axis. Each layer is a jittered
    lattice, shifted by half a period against the one below; its heights are the lowest that clear the two layers below,
    plus a random gap. Layers farther below cannot be met: a disc lies at least 0.89 above the one of its place two
    layers below and 0.25 above its neighbours one layer below (the smallest radii, the largest sideways shifts, d = 3),
    so always more than 2 r_max = 1.1 above discs three or more layers below.
    """
    side = int(n ** (1 / d) + 0.5)  # the smallest integer with side^d >= n: as many layers as discs along a layer
    side += side**d < n
    shape = (-(-n // side ** (d - 1)), *(side,) * (d - 1))
    radius = RADIUS + SPREAD * rng.uniform(-1, 1, shape)
    parity = np.arange(shape[0]) % 2
    lateral = np.moveaxis(np.indices(shape)[1:], 0, -1) + 0.5 * parity.reshape(-1, *(1,) * d)
    lateral = PERIOD * (lateral + 0.5) + JITTER * rng.uniform(-1, 1, (*shape, d - 1))
    height = _heights(lateral, radius, GAP * rng.uniform(0, 1, shape))
    x = np.concatenate((lateral, height[..., None]), axis=-1).reshape(-1, d)
    return x[:n], radius.reshape(-1)[:n], (side + 0.5) * PERIOD


def _heights(lateral: Floats, radius: Floats, gap: Floats) -> Floats:
    """Stack the layers: heights (layers, side, ...) for lateral places of shape (layers, side, ..., d - 1)."""
    height = radius + gap

    def clear(lowest: Floats, disc: tuple[Any, ...], below: tuple[Any, ...]) -> None:
        """Raise ``lowest`` in place until the discs of one layer clear the discs below; both are given by indices."""
        squares = (radius[disc] + radius[below]) ** 2 - ((lateral[disc] - lateral[below]) ** 2).sum(axis=-1)
        np.maximum(lowest, height[below] + np.sqrt(squares), out=lowest)

    for k in range(1, len(radius)):
        lowest = height[k] - gap[k]
        if k >= 2:
            clear(lowest, (k,), (k - 2,))
        for corner in product((0, 1), repeat=lateral.shape[-1]):
            # The places of a layer, and the places that lie ``shift`` away in the layer below, where both exist.
            shift, side = [c if k % 2 else c - 1 for c in corner], radius.shape[1]
            here = tuple(slice(max(0, -s), side - max(0, s)) for s in shift)
            there = tuple(slice(max(0, s), side - max(0, -s)) for s in shift)
            clear(lowest[here], (k, *here), (k - 1, *there))
        height[k] = lowest + gap[k]
    return height
