"""What the noise of a step draws from its generator."""

from __future__ import annotations

import math

from numpy.random import Generator

from dincl.compiled import inner
from tissue.kernels.normals import WORDS
from tissue.state.cells import Integers
from tissue.state.space import SPATIAL
from tissue.state.store import CELLS, Store


@inner
def add_noise(store: Store, variance: float, noise: Generator) -> None:
    """Add N(0, variance) to each coordinate of the nuclei, (3.35); draw nothing if there is no variance."""
    if variance == 0.0:
        return
    deviation, x, y, z = math.sqrt(variance), store.cells.x, store.cells.y, store.cells.z
    for i in range(store.sizes[CELLS]):
        x[i] += deviation * noise.standard_normal()
        y[i] += deviation * noise.standard_normal()
        if store.space.dimension == SPATIAL:
            z[i] += deviation * noise.standard_normal()


@inner
def draw_key(noise: Generator, key: Integers) -> None:
    """The two words of the key of the noise in substeps."""
    key[0], key[1] = int(WORDS * noise.random()), int(WORDS * noise.random())
