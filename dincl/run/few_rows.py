"""The rows of a few particles as kernels without a solver take them: pairs kept apart, and a table of all others."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.csr import uniform
from dincl.kernels.pair_list import PairList
from dincl.kernels.sweep_steps import AFFINE, DISTANCES, PAIRS, WALL, Families
from dincl.rows import pairs as lists
from dincl.rows.affine import AffineRows
from dincl.rows.distance import DistanceRows
from dincl.rows.near import Selection

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.rows.base import RowsOfOneKind
    from dincl.rows.sweeper import SweptRows

FORMULAS = {"pairs": PAIRS, "distances": DISTANCES, "wall": WALL, "affine": AFFINE}


class FewRows(NamedTuple):
    """All rows of a problem, block by block: pairs kept apart, and those of the table, which ``selection`` has."""

    blocks: tuple[RowsOfOneKind, ...]
    formula: NDArray[np.int64]
    pairs: PairList
    selection: Selection

    def families(self, place: int) -> Families:
        """What kernels take; the table is that of the system at ``place``."""
        table, d = self.selection.blocks, self.selection.shape[1]
        moving = [one.displacement(0.0, d) is not None for one in self.selection.constraints]
        return Families(
            formula=self.formula,
            first=_starts(table),
            moving=np.array(moving, dtype=np.int64),
            blamed=np.zeros(2, dtype=np.int64),
            pairs=self.pairs,
            place=place,
        )


def few_rows(problem: Problem, swept: Sequence[SweptRows | None]) -> FewRows | None:
    """The rows of each constraint of a problem; None if compiled code does not know one of them."""
    count, d = problem.x0.shape
    known = [one for one in swept if one is not None and (one.formula == "pairs" or one.rows.tabulated(d) is not None)]
    if len(known) < len(problem.constraints):
        return None
    blocks = tuple(one.rows for one in known)
    nothing = AffineRows(uniform(np.zeros((0, 1), dtype=np.int64), np.zeros((0, 1)), count * d), np.zeros(0))
    table = tuple(nothing if one.formula == "pairs" else one.rows for one in known)
    pairs = [one.rows if one.formula == "pairs" else nothing for one in known]
    formula = np.array([FORMULAS[one.formula] for one in known], dtype=np.int64)
    selection = Selection(problem.constraints, table, problem.x0.shape)
    return FewRows(blocks, formula, _pair_list(pairs, count * d, d), selection)


def _starts(blocks: Sequence[RowsOfOneKind]) -> NDArray[np.int64]:
    return np.cumsum([0, *(len(block) for block in blocks)], dtype=np.int64)


def _pair_list(blocks: Sequence[RowsOfOneKind], n: int, d: int) -> PairList:
    """Room for the near ones among all pairs; none is listed yet."""
    rows = [block for block in blocks if isinstance(block, DistanceRows)]
    one = d * np.concatenate([np.zeros(0, dtype=np.int64), *(block.i for block in rows)])
    other = d * np.concatenate([np.zeros(0, dtype=np.int64), *(block.j for block in rows if block.j is not None)])
    length = np.concatenate([np.zeros(0), *(block.length for block in rows)])
    smallest = float(length.min()) / 2 if length.size else 0.0
    return PairList(
        first=_starts(blocks),
        one=one,
        other=other,
        length=length,
        disc=np.flatnonzero(np.bincount(np.concatenate((one, other)))),
        near_first=np.zeros(len(blocks) + 1, dtype=np.int64),
        near_one=np.zeros_like(one),
        near_other=np.zeros_like(one),
        near_length=np.zeros_like(length),
        reference=np.zeros(n),
        backup=np.zeros(n),
        skin=smallest * np.array([lists.FIRST_SKIN, lists.WIDEST_SKIN]),
        lasts=np.array([lists.FEWEST, lists.MOST]),
        number=np.zeros(4, dtype=np.int64),
    )
