"""What the twins of the substeps in three dimensions work on."""

from typing import NamedTuple

import numpy as np

from tissue.state.cells import Floats, Integers
from tissue.state.surface import FLAT_SURFACE, Surface


class SpaceTissue(NamedTuple):
    """Points (3, n), what each cell has of its own (n,), and edges (m, 2)."""

    x: Floats
    a: Floats
    b: Floats
    radius: Floats
    stiff_ax: Floats
    stiff_bx: Floats
    stiff_axb: Floats
    l_ax: Floats
    l_bx: Floats
    b_moves: Floats
    held: Floats
    runs: Floats  # [1/h]
    junctions: Integers
    rest: Floats
    k_aa: Floats
    neighbours: Integers


class Steps(NamedTuple):
    """The numbers of one dt."""

    h: float = 0.00125
    substeps: int = 1
    mu: float = 0.2
    power: int = 2
    repulsion: float = 0.5
    max_basal_distance: float = 1 / 3
    variance: float = 0.0  # of the noise per coordinate and hour, in substeps
    key: tuple[int, int] = (7, 8)
    surface: Surface = FLAT_SURFACE


def still(state: SpaceTissue) -> SpaceTissue:
    """Without springs, bending, junctions or basal points that run: with no repulsion nothing acts but projections."""
    off = {name: 0.0 * getattr(state, name) for name in ("stiff_ax", "stiff_bx", "stiff_axb", "k_aa", "runs")}
    return state._replace(**off)


def mapped(state: SpaceTissue, image) -> SpaceTissue:
    """All points (3, n) taken to their images."""
    return state._replace(**{name: image(getattr(state, name)) for name in ("x", "a", "b")})


def distance(one: SpaceTissue, other: SpaceTissue) -> float:
    """The largest difference of a coordinate; NaN if there is one."""
    return float(max(np.abs(getattr(one, name) - getattr(other, name)).max() for name in ("x", "a", "b")))
