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
from tissue.kernels.surface_workspace import SurfaceNumbers, SurfaceWorkspaces
from tissue.kernels.workspace import EMPTY, RUNNING, Workspaces
from tissue.plugins import DivisionRule, Force
from tissue.runs.compiled_rules import answered, forces_pointer, rules_pointer
from tissue.state.cells import Integers
from tissue.state.checkpoint import Streams
from tissue.state.numbers import Numbers, numbers_pointer
from tissue.state.running import TissueState, grown
from tissue.state.space import FLAT
from tissue.step.advance import (
    FULL,
    STEP,
    StepInput,
    advance,
    find_lost,
    move_address,
    move_all,
    move_slices,
    move_surface,
)
from tissue.step.substeps import SLICE, SLICES, SURFACE, substeps_address

# A network of n vertices has 3 n edges at most.
EDGES = 3


class Group:
    """Running tissues of the same numbers; ``named``: those of the named types of cells.

    Attributes
    ----------
    states
        The tissues, up to WIDTH.
    forces
        Those of users that act, with their strengths, in the order of their names.
    ended
        Of each RUNNING, or the number of the step that failed; (1,) for a tissue alone, (WIDTH,) for several: EMPTY
        where there is none.
    """

    def __init__(
        self,
        states: Sequence[TissueState],
        numbers: Numbers,
        random: Sequence[Streams] = (),
        division: DivisionRule = BESIDE,
        forces: Sequence[tuple[Force, float]] = (),
        named: Sequence[Numbers] = (),
    ) -> None:
        self.states, self.forces = list(states), forces
        self._own: Any = None  # the forces, for compiled code
        width = 1 if len(self.states) == 1 else WIDTH
        self.ended: Integers = np.where(np.arange(width) < len(self.states), RUNNING, EMPTY)
        self._numbers, self._named, self._keep = numbers, named, random
        self._numbers_pointer = numbers_pointer(numbers, named)
        self._rules = rules_pointer(self.states, division)
        words = [[generator_words(one.cycle), generator_words(one.noise)] for one in random]
        self._random = np.ascontiguousarray(np.array(words, np.int64).reshape(-1, 2, GENERATOR).transpose(1, 0, 2))
        self._place()

    def advance(self, made: int, steps: int) -> None:
        """Make the steps ``made`` to ``steps`` of the tissues that run, in larger states where it takes more room."""
        end = FULL
        while end == FULL:
            made, end = self.call(made, steps)
            if end == FULL:
                self.states = [grown(state) for state in self.states]
                self._place()

    def call(self, made: int, steps: int) -> tuple[int, int]:
        """Make steps until all are made or a state is full: how many are made, and how it ended, see ``advance``.

        Raises FunctionFailed if a function of a user raised, or left a bad value.
        """
        with answered(self._rules, self._own):
            made, end = advance(self._step, made, steps)
        return made, end

    def make_substeps(self) -> bool:
        """Make all substeps of one dt without rules; return whether no cell of the first tissue is lost."""
        with answered(forces=self._own):
            move_all(self._step)
        return bool(find_lost(self.states[0]) < 0)

    def with_single_substeps(self, states: Sequence[TissueState]) -> Group:
        """Make the same group of other states, whose dt is one substep of this one, without noise."""
        numbers = self._numbers._replace(
            dt=self._numbers.dt / self._numbers.substeps, substeps=1, noise_in_substeps=False
        )
        group = Group(states, numbers, forces=self.forces, named=self._named)
        group.ended[:] = self.ended
        return group

    @property
    def pairs(self) -> int:
        """Count the pairs of cells looked at for the repulsion; of tissues side by side those of all at once."""
        return int(self._workspaces.pairs[0])

    def _place(self) -> None:
        """Make room for the substeps, and collect for the kernel where everything is."""
        width = len(self.ended)
        addresses = [state.address for state in self.states]
        states = np.array(addresses + addresses[-1:] * (width - len(addresses)))
        in_plane = self.states[0].space.dimension == FLAT
        self._workspaces = self._of_slices(states, width) if in_plane else self._of_surface()
        kind = SURFACE if not in_plane else SLICE if width == 1 else SLICES
        step = StepInput(
            states,
            self.ended,
            self._random,
            numbers=self._numbers_pointer.address,
            rules=self._rules.address,
            flat=self._workspaces.flat.address,
            wide=self._workspaces.wide.address,
            substeps=substeps_address(kind),
            move=move_address(move_slices if in_plane else move_surface),
            scale=self._numbers.scale,
        )
        self._step: Any = StructPointer(step, STEP)

    def _of_slices(self, states: Integers, width: int) -> Any:
        """Return the workspace of slices side by side."""
        numbers, forces, capacity = self._numbers, 0, max(len(state.cells.x) for state in self.states)
        if self.forces:
            self._own = forces_pointer(self.forces, states, self._numbers_pointer.address, numbers.scale)
            forces = self._own.address
        return Workspaces(capacity, width, numbers, numbers.scale, self.states[0].curve, forces, self._named)

    def _of_surface(self) -> Any:
        """Return the workspace of a sheet or a closed surface."""
        (state,), numbers = self.states, self._numbers
        strength, deviation = numbers.scale * numbers.repulsion, math.sqrt(numbers.substep_variance)
        mine = SurfaceNumbers(numbers.substeps, strength, numbers.max_basal, deviation)
        return SurfaceWorkspaces(len(state.cells.x), EDGES * len(state.cells.x), mine, state.space.surface)
