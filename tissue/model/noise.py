"""The noise of the nuclei: once per dt from a generator, or in each substep as a function of a key."""

from __future__ import annotations

import math
from typing import Any

from numpy.random import Generator

from dincl.compiled import inner
from dincl.compiled.lanes import fma, load
from dincl.compiled.lanes import store as put
from tissue.kernels.normals import WORDS, normals
from tissue.state.cells import Integers
from tissue.state.running import CELLS, TissueState
from tissue.state.space import SPATIAL

# Added to the number of a substep where the depth is drawn: along x and y the noise is that of the section z = 0.
DEPTH = 1 << 31


@inner
def add_noise(state: TissueState, variance: float, noise: Generator) -> None:
    """Add N(0, variance) to each coordinate of the nuclei, (3.35); draw nothing if there is no variance."""
    if variance == 0.0:
        return
    deviation, x, y, z = math.sqrt(variance), state.cells.x, state.cells.y, state.cells.z
    for i in range(state.sizes[CELLS]):
        x[i] += deviation * noise.standard_normal()
        y[i] += deviation * noise.standard_normal()
        if state.space.dimension == SPATIAL:
            z[i] += deviation * noise.standard_normal()


@inner
def draw_key(noise: Generator, key: Integers) -> None:
    """The two words of the key of the noise in substeps."""
    key[0], key[1] = int(WORDS * noise.random()), int(WORDS * noise.random())


@inner
def add_substep_noise(work: Any, rows: int, number: int) -> None:
    """Add N(0, deviation^2) to each coordinate of the nuclei, if noise comes in substeps; the workspace is in rows.

    It is a function of the key, the id of the cell and the number of the substep alone.
    """
    deviation, x, y, z = work.deviation, work.x, work.y, work.z
    if deviation > 0.0:
        for i in range(rows):
            along_x, along_y = normals(work.noise_key, work.id, i, number)
            along_z, _ = normals(work.noise_key, work.id, i, DEPTH + number)
            put(x, i, fma(deviation, along_x, load(x, i)))
            put(y, i, fma(deviation, along_y, load(y, i)))
            put(z, i, fma(deviation, along_z, load(z, i)))
