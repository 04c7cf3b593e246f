"""Random streams of a run, and what a run is besides its cells: with it, it goes on as if it had not stopped."""

from __future__ import annotations

import tomllib
from typing import Any, NamedTuple

import numpy as np
from numpy.random import PCG64, Generator, SeedSequence
from numpy.typing import NDArray

from dincl.checks import seed as checked_seed
from tissue.state.cells import Emt, Integers


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
    """Return the streams of a run; raises InvalidProblem for a seed that is not an integer >= 0."""
    children = SeedSequence(checked_seed("seed", seed)).spawn(len(Streams._fields))
    return Streams(*(np.random.default_rng(child) for child in children))


Words = NDArray[np.uint64]
# The streams that a run draws from after its start.
DRAWN = ("cycle", "noise")
# Of one generator: state and increment, 128 bits each, higher half first; whether half a word is left, and it.
WORDS = 6
_LOW = (1 << 64) - 1


class TissueCheckpoint(NamedTuple):
    """All that the steps of a run depend on, besides parameters, time, cells and layers; and what it has counted.

    How basal points move, and the key of the noise in substeps, are made anew in each dt before they are used.
    """

    seed: int
    next_id: int  # of the next daughter
    emt: Emt  # its arrays are copies
    counts: Integers  # one for each of ``tissue.state.running.COUNTERS``, since t = 0
    generators: Words  # (2, WORDS): where the streams DRAWN stand
    parameters: str  # the text of the parameter file

    @property
    def tables(self) -> dict[str, Any]:
        """The parameters as tables; read as data, so that no module of the file is imported."""
        return tomllib.loads(self.parameters)

    @property
    def types(self) -> tuple[str, ...]:
        """The names of the named types, by their numbers."""
        return tuple(self.tables.get("types", {}))


def generator_states(random: Streams) -> Words:
    """Return where the streams DRAWN stand, (2, WORDS)."""
    return np.array([_words(getattr(random, name)) for name in DRAWN], np.uint64)


def resumed_streams(seed: int, states: Words) -> Streams:
    """Return the streams of a seed, of which those DRAWN go on from these states."""
    return streams(seed)._replace(**{name: _generator(words) for name, words in zip(DRAWN, states, strict=True)})


def _words(generator: Generator) -> tuple[int, ...]:
    held: Any = generator.bit_generator.state
    state, increment = held["state"]["state"], held["state"]["inc"]
    return state >> 64, state & _LOW, increment >> 64, increment & _LOW, held["has_uint32"], held["uinteger"]


def _generator(words: Words) -> Generator:
    bits, (high, low, step_high, step_low, has_half, half) = PCG64(0), (int(word) for word in words)
    bits.state = {
        "bit_generator": "PCG64",
        "state": {"state": high << 64 | low, "inc": step_high << 64 | step_low},
        "has_uint32": has_half,
        "uinteger": half,
    }
    return Generator(bits)
