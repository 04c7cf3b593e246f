"""The seed of each run of a study."""

from __future__ import annotations

from collections.abc import Iterable
from hashlib import sha256

import numpy as np
from numpy.random import SeedSequence


def run_seeds(study_seed: int, scenario: str, replicates: Iterable[int]) -> list[int]:
    """One integer in [0, 2^63) for each replicate, a function of (study_seed, scenario, replicate) alone.

    Runs of different scenarios are independent, and another scenario in the study changes the seed of none.
    """
    name = np.frombuffer(sha256(scenario.encode()).digest(), dtype="<u4")
    return [_seed([*name.tolist(), study_seed], replicate) for replicate in replicates]


def _seed(entropy: list[int], replicate: int) -> int:
    state = SeedSequence(entropy, spawn_key=(replicate,)).generate_state(1, np.uint64)
    return int(state[0] >> np.uint64(1))  # as int64 in tables
