"""Tissues that are stepped together: one alone, or up to eight side by side, with the same bits; one in space.

Each of them may have numbers of its own.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from dincl.compiled import StructPointer
from dincl.errors import InvalidProblem
from tissue.events.division import BESIDE
from tissue.kernels.generators import GENERATOR, generator_words
from tissue.kernels.lanes import WIDTH
from tissue.kernels.rules import address_of
from tissue.kernels.surface_workspace import SurfaceWorkspaces
from tissue.kernels.workspace import EMPTY, RUNNING, Workspaces, is_mixed
from tissue.network.neighbours import RENEWED, renew
from tissue.plugins import DivisionRule, Force
from tissue.runs.compiled_rules import answered, forces_pointer, rules_pointer, users_of
from tissue.state.cells import Integers
from tissue.state.checkpoint import Streams
from tissue.state.numbers import Numbers, numbers_pointer
from tissue.state.running import TissueState, grown, kind_of
from tissue.state.space import FLAT
from tissue.step.advance import (
    FULL,
    LEFT,
    MOVE,
    STEP,
    StepInput,
    advance,
    find_lost,
    move_all,
    move_slices,
    move_surface,
)
from tissue.step.substeps import SLICE, SLICES, SURFACE, substeps_address


class OwnNumbers(NamedTuple):
    """Numbers of one tissue of a group: of its cells, of each named type of them, and the strengths of the forces."""

    numbers: Numbers
    named: tuple[Numbers, ...] = ()
    strengths: tuple[float, ...] = ()

    @property
    def kinds(self) -> tuple[Numbers, ...]:
        """The numbers of all cells."""
        return (self.numbers, *self.named)

    @property
    def shared(self) -> tuple[Any, ...]:
        """What must be the same for all tissues of a group, as kernels decide it for all at once."""
        one = self.numbers
        noise = one.substep_variance > 0
        return one.dt, one.substeps, one.repulsion > 0, noise, is_mixed(self.kinds), len(self.strengths)


class Group:
    """Running tissues of the same numbers, or of numbers that differ; ``named``: those of the named types of cells.

    Attributes
    ----------
    states
        The tissues, up to WIDTH.
    forces
        Those of users that act, with their strengths, in the order of their names.
    own
        The numbers of each tissue, equal in ``OwnNumbers.shared``; in place of ``numbers``, ``named`` and strengths.
    ended
        Of each RUNNING, or the number of the step that failed; (1,) for a tissue alone, (WIDTH,) for several: EMPTY
        where there is none.
    users
        The functions of users that these tissues call.
    """

    def __init__(
        self,
        states: Sequence[TissueState],
        numbers: Numbers,
        random: Sequence[Streams] = (),
        division: DivisionRule = BESIDE,
        forces: Sequence[tuple[Force, float]] = (),
        named: Sequence[Numbers] = (),
        own: Sequence[OwnNumbers] = (),
    ) -> None:
        self.states, self.forces = list(states), forces
        width = 1 if len(self.states) == 1 else WIDTH
        self.ended: Integers = np.where(np.arange(width) < len(self.states), RUNNING, EMPTY)
        same = OwnNumbers(numbers, tuple(named), tuple(strength for _, strength in forces))
        self.own, self._keep = list(own) or [same] * len(self.states), random
        places = [*range(len(self.states)), *[len(self.states) - 1] * (width - len(self.states))]  # the last one fills
        self._lanes = [self.own[k] for k in places]
        self._blame = np.zeros((2, width), np.int64)
        self._pointers = [numbers_pointer(one.numbers, one.named) for one in self._lanes]
        self._rules = rules_pointer(self.states, division)
        words = [[generator_words(one.cycle), generator_words(one.noise)] for one in random]
        self._random = np.ascontiguousarray(np.array(words, np.int64).reshape(-1, 2, GENERATOR).transpose(1, 0, 2))
        self._place()

    def advance(self, made: int, steps: int) -> None:
        """Make the steps ``made`` to ``steps`` of the tissues that run, in larger states where it takes more room.

        In space neighbours are renewed after each step whose number is a multiple of RENEWED, and where many cells
        leave a layer at once; a tissue whose points have no triangulation has failed.
        """
        in_space, ruled = self.states[0].space.dimension != FLAT, False
        while made < steps:
            made, end = self.call(made, min(steps, made - made % RENEWED + RENEWED) if in_space else steps, ruled)
            ruled = end == LEFT
            if end == FULL:
                self.states = [grown(state) for state in self.states]
                self._place()
            elif in_space and (ruled or made % RENEWED == 0) and self.ended[0] == RUNNING:
                try:
                    renew(self.states[0])
                except InvalidProblem:
                    self.ended[0] = made + ruled

    def call(self, made: int, steps: int, ruled: bool = False) -> tuple[int, int]:
        """Make steps until all are made or a state must change: how many are made, and how it ended, see ``advance``.

        Raises FunctionFailed if a function of a user raised.
        """
        with answered(self.users):
            made, end = advance(self._step, made, steps, ruled, kind_of(*self.states))
        return made, end

    def make_substeps(self) -> bool:
        """Make all substeps of one dt without rules; return whether no cell of the first tissue is lost."""
        with answered(self.users):
            move_all(self._step)
        return bool(find_lost(self.states[0]) < 0)

    def with_single_substeps(self, states: Sequence[TissueState]) -> Group:
        """Make the same group of other states, whose dt is one substep of this one, without noise."""
        once = [
            one.numbers._replace(dt=one.numbers.dt / one.numbers.substeps, substeps=1, noise_in_substeps=False)
            for one in self.own
        ]
        own = [one._replace(numbers=numbers) for one, numbers in zip(self.own, once, strict=True)]
        group = Group(states, once[0], forces=self.forces, own=own)
        group.ended[:] = self.ended
        return group

    def blamed(self, lane: int) -> str:
        """Name the force of a user that was the first not to be finite in a tissue, and the cell; "" for none."""
        number, cell = self._blame[:, lane]
        return f"Force {self.forces[number - 1][0].name}: push is not finite on cell {cell}" if number else ""

    @property
    def pairs(self) -> int:
        """Count the pairs of cells looked at for the repulsion; of tissues side by side those of all at once."""
        return int(self._workspaces.pairs[0])

    def _place(self) -> None:
        """Make room for the substeps, and collect for the kernel where everything is."""
        width, numbers = len(self.ended), self.own[0].numbers
        of_numbers = np.array([pointer.address for pointer in self._pointers])
        scales = np.array([one.numbers.scale for one in self._lanes])
        addresses = [state.address for state in self.states]
        states = np.array(addresses + addresses[-1:] * (width - len(addresses)))
        first, capacity = self.states[0], max(len(state.cells.x) for state in self.states)
        in_plane, forces = first.space.dimension == FLAT, 0
        push: Integers = np.zeros(0, np.int64)
        if self.forces:
            strengths = np.array([one.strengths for one in self._lanes]).T.copy()
            of_tissues = strengths, states, of_numbers, scales, self._blame
            self._own = forces_pointer([force for force, _ in self.forces], *of_tissues, in_space=not in_plane)
            forces, push = self._own.address, self._own.value.push
        if in_plane:
            kinds = [one.kinds for one in self._lanes]
            self._workspaces: Any = Workspaces(capacity, width, kinds, scales, first.curve, forces)
        else:
            self._workspaces = SurfaceWorkspaces(
                capacity,
                len(first.space.apical.edges),
                first.space.surface,
                substeps=numbers.substeps,
                repulsion=numbers.scale * numbers.repulsion,
                max_basal_distance=numbers.max_basal_distance,
                deviation=math.sqrt(numbers.substep_variance),
                forces=forces,
            )
        self.users = users_of(self._rules, push)
        step = StepInput(
            states,
            self.ended,
            self._random,
            numbers=of_numbers,
            rules=self._rules.address,
            flat=self._workspaces.flat.address,
            wide=self._workspaces.wide.address,
            substeps=substeps_address(SURFACE if not in_plane else SLICE if width == 1 else SLICES),
            move=address_of(MOVE, move_slices if in_plane else move_surface),
            scale=scales,
        )
        self._step: Any = StructPointer(step, STEP)
