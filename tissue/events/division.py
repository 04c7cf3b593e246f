"""The built-in rule of what becomes of a cell at the end of its cycle (section 2.2.5 of chapter 3)."""

from __future__ import annotations

from tissue.kernels.curve import evaluate
from tissue.plugins import DivisionRule, registered
from tissue.state.numbers import Numbers
from tissue.state.running import TissueState


def splits(state: TissueState, i: int, number: float, numbers: Numbers) -> bool:
    """Return whether a cell splits, with the probability p^div."""
    return number < numbers.two_daughters


def place(state: TissueState, i: int, numbers: Numbers) -> None:
    """Move all three points of both daughters apart by the offset, along the tissue  (3.7)."""
    cells, curve, along_x, along_y = state.cells, state.curve, 1.0, 0.0
    if curve.bent:
        _, _, along_x, along_y = evaluate(curve, cells.along[i])
    for k in range(2):
        step = numbers.offset if k == 1 else -numbers.offset
        for x, y in ((cells.x, cells.y), (cells.ax, cells.ay), (cells.bx, cells.by)):
            x[i + k] += step * along_x
            if curve.bent:
                y[i + k] += step * along_y
        if curve.bent and state.motion.held[i + k] > 0.0:  # a point that the layer holds
            cells.along[i + k] += step
            cells.bx[i + k], cells.by[i + k], _, _ = evaluate(curve, cells.along[i + k])


BESIDE = DivisionRule(
    name="beside",
    meaning="by chance; the daughters lie beside each other",
    source="section 2.2.5 of chapter 3",
    splits=splits,
    place=place,
)


def division_rules() -> dict[str, DivisionRule]:
    """Return all rules by name."""
    return {rule.name: rule for rule in (BESIDE, *registered(DivisionRule))}
