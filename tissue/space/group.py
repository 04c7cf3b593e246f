"""A tissue in space that is stepped: what its kernels take, and room for its daughters."""

from __future__ import annotations

import math

import numpy as np

from dincl.compiled import StructPointer
from tissue.space.step.advance import DESK, SpaceDesk, step_address
from tissue.space.step.board import SpaceBoards, SpaceNumbers
from tissue.space.step.substeps import space_substeps_address
from tissue.step.group import Group

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
