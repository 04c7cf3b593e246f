"""What becomes of a cell at the end of its cycle (section 2.2.5 of chapter 3)."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from types import FunctionType

from dincl.checks import instance, string
from tissue.kernels.curve import course
from tissue.kernels.store import Store
from tissue.registry import registered
from tissue.state.numbers import Numbers

_NAME = re.compile(r"[^\W\d]\w*")


@dataclass(frozen=True)
class DivisionRule:
    """Whether a cell splits when its cycle ends, and where its daughters are; ``rule`` in the section [division].

    Cells of [emt], and of types that do not divide, never split; all others are asked. ``numbers`` are those of the
    type of the cell. Functions are plain Python at top level of a file; numba compiles them, alone, when a run first
    needs them.

    Attributes
    ----------
    name
        That of the rule in parameter files.
    meaning, source
        One line each.
    splits
        ``splits(store, i, number, numbers)``: whether cell i gets a second daughter in the plane; ``number`` is random,
        uniform in [0, 1).
    place
        ``place(store, i, numbers)``: parts the daughters i and i + 1, which are copies of the mother in one place.

    Raises
    ------
    InvalidProblem
        If the name is none, or ``splits`` or ``place`` is no function.
    """

    name: str
    meaning: str
    source: str
    splits: Callable[..., bool]
    place: Callable[..., None]

    def __post_init__(self) -> None:
        string("name", self.name, _NAME, "letters, digits and _")
        string("meaning", self.meaning)
        string("source", self.source)
        for key, value in (("splits", self.splits), ("place", self.place)):
            instance(f"DivisionRule {self.name}: {key}", value, FunctionType, "a function")


def splits(store: Store, i: int, number: float, numbers: Numbers) -> bool:
    """With the probability p^div."""
    return number < numbers.two_daughters


def place(store: Store, i: int, numbers: Numbers) -> None:
    """All three points apart by the offset, along the tissue  (3.7)."""
    cells, curve, along_x, along_y = store.cells, store.curve, 1.0, 0.0
    if curve.bent:
        _, _, along_x, along_y = course(curve, cells.along[i])
    for k in range(2):
        step = numbers.division_offset if k == 1 else -numbers.division_offset
        for x, y in ((cells.x, cells.y), (cells.ax, cells.ay), (cells.bx, cells.by)):
            x[i + k] += step * along_x
            if curve.bent:
                y[i + k] += step * along_y
        if curve.bent and store.motion.by_moves[i + k] == 0.0:  # a point that the layer holds
            cells.along[i + k] += step
            cells.bx[i + k], cells.by[i + k], _, _ = course(curve, cells.along[i + k])


BESIDE = DivisionRule(
    name="beside",
    meaning="by chance; the daughters lie beside each other",
    source="section 2.2.5 of chapter 3",
    splits=splits,
    place=place,
)


def division_rules() -> dict[str, DivisionRule]:
    """All rules by name."""
    return {rule.name: rule for rule in (BESIDE, *registered(DivisionRule))}
