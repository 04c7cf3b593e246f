"""Tissues that are stepped together: one alone, or up to eight side by side, with the same bits; one in space."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from dincl.compiled import StructPointer
from dincl.compiled.generators import GENERATOR, generator_words
from dincl.compiled.lanes import WIDTH
from tissue.events.division import BESIDE
from tissue.kernels.board import EMPTY, RUNNING, Boards
from tissue.kernels.numbers import handed_numbers
from tissue.plugins import DivisionRule, Force
from tissue.runs.compiled_rules import answered, handed_forces, handed_rules
from tissue.state.cells import Integers
from tissue.state.checkpoint import Streams
from tissue.state.numbers import Numbers
from tissue.state.store import Store, grown
from tissue.step.advance import FULL, advance, find_lost, make_substeps
from tissue.step.space_advance import DESK, SpaceDesk, step_address
from tissue.step.space_board import SpaceBoards, SpaceNumbers
from tissue.step.space_substeps import space_substeps_address
from tissue.step.substeps import substeps_address


class Group:
    """Running tissues of the same numbers; ``named``: those of the named types of cells.

    Attributes
    ----------
    stores
        The tissues, up to WIDTH.
    forces
        Those of users that act, with their strengths, in the order of their names.
    ended
        Of each RUNNING, or the number of the step that failed; (1,) for a tissue alone, (WIDTH,) for several: EMPTY
        where there is none.
    """

    def __init__(
        self,
        stores: Sequence[Store],
        numbers: Numbers,
        random: Sequence[Streams] = (),
        division: DivisionRule = BESIDE,
        forces: Sequence[tuple[Force, float]] = (),
        named: Sequence[Numbers] = (),
    ) -> None:
        self.stores, self.forces = list(stores), forces
        width = 1 if len(self.stores) == 1 else WIDTH
        self.ended: Integers = np.where(np.arange(width) < len(self.stores), RUNNING, EMPTY)
        self._numbers, self._named, self._keep = numbers, named, random
        self._handed = handed_numbers(numbers, named)
        self._rules = handed_rules(self.stores, division)
        words = [[generator_words(one.cycle), generator_words(one.noise)] for one in random]
        self._random = np.ascontiguousarray(np.array(words, np.int64).reshape(-1, 2, GENERATOR).transpose(1, 0, 2))
        self._place()

    def advance(self, made: int, steps: int) -> None:
        """Make the steps ``made`` to ``steps`` of the tissues that run, in larger stores where it takes more room."""
        end = FULL
        while end == FULL:
            made, end = self.call(made, steps)
            if end == FULL:
                self.stores = [grown(held) for held in self.stores]
                self._place()

    def call(self, made: int, steps: int) -> tuple[int, int]:
        """Make steps until all are made or a store is full: how many are made, and how it ended, see ``advance``.

        Raises FunctionFailed if a function of a user raised.
        """
        with answered():
            made, end = advance(self._addresses, self._random, self.ended, made, steps, self._how)
        return made, end

    def make_substeps(self) -> bool:
        """All substeps of one dt with rules that stand still; whether no cell of the first tissue is lost."""
        with answered():
            make_substeps(self._addresses, self.ended, self._how)
        return bool(find_lost(self.stores[0]) < 0)

    @property
    def pairs(self) -> int:
        """How many pairs of cells were looked at for the repulsion; in a company those of all tissues at once."""
        return int(self._board.pairs[0])

    def _place(self) -> None:
        """Tell the kernel where everything is."""
        width, numbers, named = len(self.ended), self._numbers, self._named
        scale = numbers.dt / numbers.substeps / numbers.mu
        addresses = [held.address for held in self.stores]
        self._addresses = np.array(addresses + addresses[-1:] * (width - len(addresses)))
        own, capacity = 0, max(len(held.cells.x) for held in self.stores)
        if self.forces:
            self._own = handed_forces(self.forces, self._addresses, self._handed.address, scale)
            own = self._own.address
        self._board: Any = Boards(capacity, width, numbers, scale, self.stores[0].curve, own, named)
        code, rules = substeps_address(width), self._rules.address
        how = self._handed.address, self._board.flat.address, self._board.wide.address, code, rules
        self._how = np.array(how, np.int64)


# A network of n vertices has 3 n edges at most.
EDGES = 3


class SpaceGroup(Group):
    """A group of one tissue in space."""

    def _place(self) -> None:
        """Tell the kernel where everything is."""
        (held,), numbers = self.stores, self._numbers
        scale, capacity = numbers.dt / numbers.substeps / numbers.mu, len(held.cells.x)
        variance = numbers.variance * numbers.dt / numbers.substeps if numbers.noise_in_substeps else 0.0
        of_board = SpaceNumbers(numbers.substeps, scale * numbers.repulsion, numbers.max_basal, math.sqrt(variance))
        self._board = SpaceBoards(capacity, EDGES * capacity, of_board, held.space.surface)
        self._desk = StructPointer(
            SpaceDesk(
                self._board.flat.address,
                self._board.wide.address,
                self._handed.address,
                space_substeps_address(),
                scale,
            ),
            DESK,
        )
        self._addresses = np.array([held.address])
        how = self._handed.address, self._desk.address, 0, step_address(), self._rules.address
        self._how = np.array(how, np.int64)
