"""Sets of a problem in the arrays that sweeps read, see ``dincl.steps.sweeps``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.compiled.calls import SETS
from dincl.compiled.structs import StructPointer
from dincl.constraints.selection import Selection
from dincl.errors import StepFailure
from dincl.neighbours import ALL_PAIRS, FIRST_SKIN, WIDEST_SKIN
from dincl.neighbours.lists import BUILDS, CANDIDATES, CORRECTIONS, COUNT, NO_ROOM, NUMBERS, OUTDATED, PairList
from dincl.neighbours.search import neighbour_pairs
from dincl.rows.affine import HeightRows
from dincl.rows.base import DiscPairs
from dincl.status import Status
from dincl.steps.sweeps import DISCS, MOST_ITERATIONS, ROWS, WALL, Families, correct_rows, project_rows
from dincl.system import arrays as codes
from dincl.system.callbacks import PythonFunction, numbers_at

if TYPE_CHECKING:
    from dincl.constraints.base import Constraint
    from dincl.problem import Problem
    from dincl.work import Work

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
        self.updates = [
            _Growth(sets[f], swept[f], one, problem.x0.shape)
            for f, one in lists.items()
            if sets[f].timed and general[f]
        ]
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


class _Growth:
    """Writes the radii of growing discs into their list of pairs, and how much they have grown since it was made."""

    def __init__(
        self, constraint: Constraint, discs: DiscPairs, pointer: StructPointer, shape: tuple[int, ...]
    ) -> None:
        self._constraint, self._discs, self._pointer, self._shape = constraint, discs, pointer, shape
        self._builds, self._listed = 0, discs.radius

    def __call__(self, t: float) -> None:
        pairs: PairList = self._pointer.value
        if pairs.number[BUILDS] != self._builds:
            self._builds, self._listed = int(pairs.number[BUILDS]), pairs.radius.copy()
        pairs.radius[:] = self._constraint.rows_at(t, self._discs, self._shape).radius
        pairs.grown[0] = max(float((pairs.radius - self._listed).max(initial=0.0)), 0.0)


def _form(swept: Any, general: bool) -> int:
    if isinstance(swept, DiscPairs):
        return DISCS
    # All particles, as of a wall for which every one is near.
    wall = isinstance(swept, HeightRows) and len(swept) == swept.count and len(swept.normal) <= 3
    return WALL if wall and not general else ROWS
