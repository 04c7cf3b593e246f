"""Where the randomness of a run comes from: one stream for each purpose, all from the seed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.random import Generator, SeedSequence

from dincl.checks import seed as checked_seed


class Streams(NamedTuple):
    """Generators that do not know of each other: what one is asked for never changes what another gives.

    No draw depends on a position, so that runs of one seed with other steps, another scheme or other forces meet the
    same noise and the same divisions. A new purpose goes to the end.
    """

    start: Generator  # positions, ages
    cycle: Generator  # durations of cycles, second daughters
    noise: Generator  # of the nuclei
    emt: Generator  # INM and times of the events of EMT cells
    types: Generator  # the same of cells of named types, and their places


def streams(seed: int) -> Streams:
    """The streams of a run; raises InvalidProblem for a seed that is not an integer >= 0."""
    children = SeedSequence(checked_seed("seed", seed)).spawn(len(Streams._fields))
    return Streams(*(np.random.default_rng(child) for child in children))
