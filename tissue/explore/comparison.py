"""Two answers side by side: each number with its interval, the difference, and the runs that would decide it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from tissue.explore.answer import APICAL, BASAL, HEIGHT, POSITION
from tissue.explore.means import Mean, difference, runs_to_see
from tissue.study.comparisons import Difference, runs_needed
from tissue.study.figures.style import OUTCOMES

if TYPE_CHECKING:
    from tissue.explore.answer import Answer
    from tissue.study.categories import What

MAKES_NO_NUMBERS = True

DECIDED = "decided"
SHARES = (APICAL, BASAL)


class AnswerRow(NamedTuple):
    """A number of one answer, or of two: texts of the value with its interval, of the difference, of what is needed."""

    name: str
    value: str
    held: str = ""
    difference: str = ""
    needed: str = ""


def rows_of(now: Answer, held: Answer | None) -> list[AnswerRow]:
    """All numbers of an answer; with another one that is held, the difference, this one minus that."""
    ratios = [_of_ratios(OUTCOMES[what][2], what, now, held) for what in OUTCOMES if what in now.ratios]
    names = [name for name in (POSITION, HEIGHT, APICAL, BASAL) if name in now.means]
    return ratios + [_of_means(name, now.means[name], None if held is None else held.means.get(name)) for name in names]


def _of_ratios(name: str, what: What, here: Answer, there: Answer | None) -> AnswerRow:
    now = here.ratios[what]
    if there is None or what not in there.ratios:
        return AnswerRow(name, _percent(now.value, *now.interval()))
    held = there.ratios[what]
    gap = Difference(now, held)
    runs = min(here.runs, there.runs)
    needed = runs_needed(now.value, held.value, cells_per_run=min(now.size / here.runs, held.size / there.runs))
    texts = _percent(now.value, *now.interval()), _percent(held.value, *held.interval())
    return AnswerRow(name, *texts, _points(gap.value, *gap.interval()), _needed(gap.interval(), needed, runs))


def _of_means(name: str, now: Mean, held: Mean | None) -> AnswerRow:
    text = _percent if name in SHARES else _plain
    if held is None:
        return AnswerRow(name, text(now.value, *now.interval()))
    value, *ends = difference(now, held)
    needed = _needed((ends[0], ends[1]), runs_to_see(now, held), min(now.runs, held.runs))
    texts = text(now.value, *now.interval()), text(held.value, *held.interval())
    return AnswerRow(name, *texts, (_points if name in SHARES else _signed)(value, *ends), needed)


def _needed(interval: tuple[float, float], needed: int | None, runs: int) -> str:
    """What is missing to see a difference as large as this one with a probability of 80 %."""
    if interval[0] > 0 or interval[1] < 0:
        return DECIDED
    if needed is None:
        return "equal so far"
    return f"{max(needed - runs, 1):,} more runs".replace(",", " ")


def _percent(value: float, low: float, high: float) -> str:
    return f"{100 * value:.1f} % [{100 * max(low, 0):.1f}, {100 * min(high, 1):.1f}]"


def _points(value: float, low: float, high: float) -> str:
    return f"{100 * value:+.1f} [{100 * low:+.1f}, {100 * high:+.1f}] points"


def _plain(value: float, low: float, high: float) -> str:
    return f"{value:.3g} [{low:.3g}, {high:.3g}]"


def _signed(value: float, low: float, high: float) -> str:
    return f"{value:+.2g} [{low:+.2g}, {high:+.2g}]"
