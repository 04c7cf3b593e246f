"""Steps that compiled code makes, many in one call, and the sets in the arrays that sweeps read."""

from __future__ import annotations

import time
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.compiled.arrays import axes_of
from dincl.compiled.calls import SETS
from dincl.compiled.structs import StructPointer
from dincl.constraints.selection import Selection
from dincl.errors import InvalidProblem, StepFailure
from dincl.neighbours import ALL_PAIRS, FIRST_SKIN, WIDEST_SKIN
from dincl.neighbours.lists import BUILDS, CANDIDATES, CORRECTIONS, COUNT, NO_ROOM, NUMBERS, OUTDATED, PairList
from dincl.neighbours.search import neighbour_pairs
from dincl.rows.base import DiscPairs
from dincl.rows.kinds import HeightRows
from dincl.status import Status
from dincl.steps import loop
from dincl.steps.grid import Output, Reached, Stepper, StepState, TimeGrid
from dincl.steps.loop import DISCS, NO_FAMILIES, ROWS, WALL, Families, OutputArrays, Settings, Stepping
from dincl.steps.sweeping import MOST_ITERATIONS, correct_rows, project_rows
from dincl.system import arrays as codes
from dincl.system.arrays import NEED_ROOM, OK
from dincl.system.callbacks import PythonFunction, numbers_at
from dincl.system.compiled_problem import CompiledProblem
from dincl.system.time_scales import smooth_pieces

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from dincl.constraints.base import Constraint
    from dincl.problem import Problem
    from dincl.projection.certificate import Projection
    from dincl.work import Work

# In the first call, particles times steps; each call makes twice as many steps as the last one while it takes less than
# this [s], so that an interrupt, or a budget, does not wait.
FIRST, SHORT = 6400, 0.02
NO_OUTPUT = StructPointer(loop.NO_OUTPUT)
# Pairs of a disc for which a list has room at first, and how much more room than needed a longer list has.
PAIRS, MORE = 4, 1.25


class SweptSets:
    """Sets in the order of the constraints, as discs, walls or rows.

    Attributes
    ----------
    selection
        The rows in the table of the system: none of discs and walls.
    arrays
        The arrays for kernels.
    searches
        The searches for near pairs, one for each large family of discs.
    updates
        Functions of time that write the radii of growing discs.
    plain
        Whether no discs have scaled coordinates or a periodic box.
    """

    plain = True

    def __init__(self, problem: Problem, *, multipliers: bool) -> None:
        """Bind; with ``multipliers``, pairs and walls have one each."""
        (count, d), families = problem.x0.shape, len(problem.constraints)
        sets = problem.constraints
        swept: list[Any] = [one.at(0.0).sweep_rows(problem.x0) for one in sets]
        general = [one.timed and one.displacement(0.0, d) is None for one in sets]
        forms = np.array([_form(*one) for one in zip(swept, general, strict=True)], dtype=np.int64)
        nothing = HeightRows(np.zeros(d), np.zeros(0, dtype=np.int64), np.zeros(0), count)
        blocks = tuple(one if form == ROWS else nothing for form, one in zip(forms, swept, strict=True))
        self.selection = Selection(problem.constraints, blocks, problem.x0.shape)
        self.searches: list[PythonFunction] = []
        self._multipliers = multipliers
        self._needed: dict[int, int] = {}
        self._lists = lists = {f: self._pair_list(f, one, d) for f, one in enumerate(swept) if forms[f] == DISCS}
        # Of growing discs: how many lists were made, and the radii for which the last one was.
        self._listed = {f: (0, swept[f].radius) for f in lists if general[f]}
        self.updates = [partial(self._grow, f, sets[f], swept[f]) for f in self._listed]
        self._counted = np.zeros(NUMBERS, dtype=np.int64)
        walls = {f: one for f, one in enumerate(swept) if forms[f] == WALL}
        heights = {f: count * k for k, f in enumerate(walls)}
        starts = np.cumsum([0, *map(len, blocks)])
        self.arrays = Families(
            form=forms,
            first=np.array([heights.get(f, starts[f]) for f in range(families)], dtype=np.int64),
            last=starts[1:],
            pairs=np.array([lists[f].address if f in lists else 0 for f in range(families)], dtype=np.int64),
            normal=np.array([walls[f].normal if f in walls else np.zeros(d) for f in range(families)]).reshape(-1, d),
            bound=np.concatenate([np.zeros(0), *(wall.bound for wall in walls.values())]),
            multiplier=np.zeros(max(count * len(walls), 1) if multipliers else 0),
            corrections=np.zeros(1, dtype=np.int64),
            offending=np.zeros(3, dtype=np.int64),
            visit_rows=(correct_rows if multipliers else project_rows).address if (forms == ROWS).any() else 0,
        )

    def _grow(self, f: int, discs: Constraint, rows: DiscPairs, t: float) -> None:
        """Write the radii of growing discs at time t, and by how much they have grown since their pairs were listed."""
        pairs: PairList = self._lists[f].value
        if pairs.number[BUILDS] != self._listed[f][0]:
            self._listed[f] = int(pairs.number[BUILDS]), pairs.radius.copy()
        pairs.radius[:] = discs.rows_at(t, rows, self.selection.shape).radius
        pairs.grown[0] = max(float((pairs.radius - self._listed[f][1]).max(initial=0.0)), 0.0)

    def make_room(self) -> None:
        """Make longer lists for families whose pairs had no room."""
        for f, pairs in self._needed.items():
            most = int(MORE * pairs)
            first, second = np.zeros(most, dtype=np.uint32), np.zeros(most, dtype=np.uint32)
            multiplier = np.zeros(most if self._multipliers else 0)
            self._lists[f].replace({"first": first, "second": second, "multiplier": multiplier})
            self._lists[f].value.number[OUTDATED] = 1
        self._needed.clear()

    def count(self, work: Work) -> None:
        """Add the work since the last call."""
        total = sum((one.value.number for one in self._lists.values()), np.zeros(NUMBERS, dtype=np.int64))
        done, self._counted = total - self._counted, total
        work.neighbour_builds += int(done[BUILDS])
        work.candidate_pairs += int(done[CANDIDATES])
        work.constraint_projections += int(done[CORRECTIONS]) + int(self.arrays.corrections[0])
        self.arrays.corrections[0] = 0

    def failure(self, code: int) -> None:
        """Raise StepFailure for the codes that stand for a row; return for all others."""
        family, i, j = (int(place) for place in self.arrays.offending)
        if code == codes.COINCIDENT and self.arrays.form[family] == DISCS:
            raise StepFailure(Status.COINCIDENT_CENTRES, f"Particles {i} and {j} lie on one point.")
        if code not in (codes.COINCIDENT, codes.FLAT, codes.UNSETTLED):
            return
        rows: Any = self.selection.blocks[family]
        if code == codes.COINCIDENT:
            raise rows.coincidence(i)
        name = rows.label(i, self.selection.shape[1])
        if code == codes.FLAT:
            raise StepFailure(Status.CONSTRAINT_FAILED, f"A violated constraint has gradient zero: {name}.")
        detail = f"The projection onto {name} took more than {MOST_ITERATIONS} steps."
        raise StepFailure(Status.NOT_CONVERGED, detail)

    def _pair_list(self, f: int, discs: DiscPairs, d: int) -> StructPointer:
        """Make arrays for the near pairs of a family; none is listed yet."""
        m, smallest, some = len(discs.radius), float(discs.radius.min(initial=np.inf)), discs.among is not None
        few, scale, origin, box = m <= ALL_PAIRS, np.zeros(0), np.zeros(0), discs.box
        if discs.scaling is not None or box is not None:
            self.plain, scale, origin = False, np.ones(m), np.zeros((m, d))
        if discs.scaling is not None:
            named = np.arange(m) if discs.among is None else discs.among
            scale, origin = discs.scaling.root[named], discs.scaling.origin[named]

        def list_pairs(t: float, x: int, *_: int) -> int:
            places = numbers_at(x, (m, d))
            places = places if not scale.size else origin + scale[:, None] * places
            pairs: PairList = pointer.value
            i, j = neighbour_pairs(places, pairs.radius + pairs.skin[0], box)
            if len(i) > len(pairs.first):
                self._needed[f] = len(i)
                return NO_ROOM
            pairs.first[: len(i)], pairs.second[: len(i)], pairs.number[COUNT] = i, j, len(i)
            return 0

        search, most = None if few else PythonFunction(list_pairs, SETS), m * (m - 1) // 2 + 1 if few else PAIRS * m
        pointer = StructPointer(
            PairList(
                disc=np.array(discs.among) if some else np.zeros(0, dtype=np.int64),
                radius=np.array(discs.radius),
                first=np.zeros(most, dtype=np.uint32),
                second=np.zeros(most, dtype=np.uint32),
                multiplier=np.zeros(max(most, 1) if self._multipliers else 0),
                point=np.zeros(m * d if some else 0),
                reference=np.zeros(m * d),
                backup=np.zeros(m * d),
                scale=scale,
                origin=origin.ravel(),
                box=np.zeros(d) if box is None else box.copy(),
                skin=smallest * np.array([FIRST_SKIN, WIDEST_SKIN]) if m else np.zeros(2),
                grown=np.zeros(1),
                number=np.zeros(NUMBERS, dtype=np.int64),
                search=search.address if search else 0,
            )
        )
        if search:
            self.searches.append(search)
        return pointer


def _form(swept: Any, general: bool) -> int:
    if isinstance(swept, DiscPairs):
        return DISCS
    # All particles, as of a wall for which every one is near.
    wall = isinstance(swept, HeightRows) and len(swept) == swept.count and len(swept.normal) <= 3
    return WALL if wall and not general else ROWS


class CompiledStepper(Stepper):
    """A scheme whose step is compiled, bound to a problem.

    Parameters
    ----------
    run
        The kernel of the scheme, which calls a loop made by ``dincl.steps.loop.loop_of``.
    settings
        The parameters of the scheme.
    system
        The drift, the sets and their rows.
    swept
        The sets of schemes that make sweeps.
    v0
        Velocity at the start, (N, d), of a second-order scheme.

    Attributes
    ----------
    system
        The problem as compiled code sees it.
    pointer
        The ``Stepping`` that kernels are given.
    """

    def __init__(
        self,
        problem: Problem,
        run: Any,
        settings: Settings,
        *,
        system: CompiledProblem,
        swept: SweptSets | None = None,
        v0: NDArray[np.float64] | None = None,
    ) -> None:
        super().__init__(problem)
        self._run, self._swept, self._v0, self.system = run, swept, v0, system
        self._prepared, self._axes = False, axes_of(problem.x0) if swept else ()
        n = problem.x0.size
        self.pointer = StructPointer(
            Stepping(
                system=system.place,
                families=NO_FAMILIES if swept is None else swept.arrays,
                x=np.zeros(n),
                v=np.zeros(0 if v0 is None else n),
                after=np.zeros(n),
                rate=np.zeros(n),
                repeats=np.zeros(1, dtype=np.int64),
                settings=settings,
            )
        )

    @classmethod
    def sweeping(
        cls,
        problem: Problem,
        run: Any,
        settings: Settings,
        *,
        of_any: Any = None,
        multipliers: bool = False,
        v0: NDArray[np.float64] | None = None,
    ) -> CompiledStepper:
        """Bind a scheme that takes one row after another; with ``multipliers`` each row has one.

        The kernel ``of_any`` serves discs with mobilities or in a periodic box, such as one made with
        ``project_any_often``; without it InvalidProblem is raised for them.
        """
        swept = SweptSets(problem, multipliers=multipliers)
        if not swept.plain:
            if of_any is None:
                raise InvalidProblem("scheme: its kernel serves discs without mobilities and without a box, see of_any")
            run = of_any
        system = CompiledProblem.for_sweeps(problem, swept.selection)
        system.functions += swept.searches
        system.sets.updates += swept.updates
        return cls(problem, run, settings, system=system, swept=swept, v0=v0)

    @classmethod
    def projecting(
        cls, problem: Problem, run: Any, projection: Projection, settings: Settings, *, exact: bool
    ) -> CompiledStepper:
        """Bind a scheme that projects onto S (``exact``), or onto its linearisation, in each step."""
        system = CompiledProblem.for_projections(problem, exact=exact)
        return cls(problem, run, settings._replace(tol=projection.tol), system=system)

    def start(self) -> StepState:
        return StepState(self.problem.x0, self._v0)

    def step(self, t: float, h: float, state: StepState) -> StepState:
        reached = self._steps(TimeGrid(h, 1, origin=t), 0, 1, state, None)
        if reached.failure:
            raise reached.failure
        return reached.state

    def advance(self, on: TimeGrid, k: int, end: int, state: StepState, output: Output | None = None) -> Reached:
        if not self._prepared:
            self.prepare((on,), np.zeros(0))
        reached = self._steps(on, k, end, state, output)
        self.work.steps += reached.k - k
        return reached

    def prepare(self, grids: Sequence[TimeGrid], times: NDArray[np.float64]) -> None:
        """Tabulate the sets that depend on time alone, so that compiled code evaluates them."""
        self.system.sets.tabulate(smooth_pieces(self.problem, grids, times), compares=self._swept is None)
        self._prepared = True

    def _steps(self, on: TimeGrid, k: int, end: int, state: StepState, output: Output | None) -> Reached:
        """Make the steps k ... end - 1 of a grid."""
        shape, run = self.problem.x0.shape, self.pointer.value
        run.x[:] = state.x.ravel()
        if run.v.size:
            v = self._v0 if state.v is None else state.v
            run.v[:] = np.asarray(v).ravel()
        table = NO_OUTPUT if output is None else StructPointer(_arrays(output, run.x.size))
        most, code = max(FIRST // len(self.problem.x0), 1), OK
        with self.system.callbacks():
            while k < end and code == OK:
                began = time.perf_counter()
                grid = on._replace(first=k, last=min(end, k + most))
                code, k = self._run(self.pointer.address, grid, table.address, self._axes)
                if self._swept:
                    self._swept.count(self.work)
                self.system.count(self.work)
                if code == NEED_ROOM:
                    self._make_room()
                    code = OK
                most = 2 * most if time.perf_counter() - began < SHORT else most
        reached = StepState(run.x.reshape(shape).copy(), run.v.reshape(shape).copy() if run.v.size else None)
        try:
            if code != OK:
                self.fail(code)
        except StepFailure as failure:
            return Reached(k, reached, failure)
        return Reached(k, reached)

    def _make_room(self) -> None:
        """Make arrays longer in which something had no room; the step is repeated."""
        if self._swept:
            self._swept.make_room()
            self.pointer.value.repeats[0] = 1

    def fail(self, code: int) -> None:
        """Raise StepFailure, or what a function of the user raised, for the code by which a step ended."""
        self.system.raise_errors()
        if self._swept:
            self._swept.failure(code)
        self.system.failure(code, self.pointer.value.settings.tol)


def _arrays(output: Output, n: int) -> OutputArrays:
    x, before, velocity = (part.reshape(-1, n) for part in (output.x, output.before, output.velocity))
    return OutputArrays(output.step, output.weight, x, before, velocity, output.filled)
