"""Claims about ratios: one is larger than another, alike, or as printed; and the runs that would decide it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from dincl.checks import describe
from dincl.errors import InvalidProblem
from tissue.statistics.comparisons import Difference, runs_needed
from tissue.statistics.proportions import sample_size
from tissue.statistics.ratios import Ratio

PRINTED_LEVEL = 0.99  # at which a measured ratio agrees with a printed one
CLAIM_LEVEL = 0.99  # at which a claim is judged: so narrow a chance of error is for several claims of a question
ALIKE = 0.1  # ratios that differ by less are alike: the thesis prints tenths and calls its results qualitative

RatioVerdict = Literal["holds", "does not hold", "not decided"]


def against_printed(measured: Ratio, printed: float, of: int) -> Difference:
    """Return a measured ratio minus a printed one of ``of`` independent cells, which has its own chance error.

    They agree if ``agrees`` says so. A printed ratio is taken as the nearest one that ``of`` cells can have.

    Parameters
    ----------
    measured
        From the runs.
    printed
        From 0 to 1.
    of
        Cells it was printed for: n_rep = 400 for Figures 10 to 14 of chapter 4, 100 for Figure 15 of chapter 4.

    Returns
    -------
    Difference
    """
    if not 0 <= printed <= 1:
        raise InvalidProblem(f"printed = {describe(printed)}: must be a ratio from 0 to 1")
    return Difference(measured, Ratio(round(printed * of), of))


def agrees(difference: Difference, level: float = PRINTED_LEVEL) -> bool:
    """Return whether the interval of the difference contains 0."""
    low, high = difference.interval(level)
    return low <= 0 <= high


@dataclass(frozen=True)
class RatioClaim:
    """A statement that one ratio is larger than another, or like it, and whether it holds.

    Attributes
    ----------
    text
        What was measured, with the 95 % interval.
    verdict
        By the interval at ``CLAIM_LEVEL``.
    needed
        Runs of each kind that would probably decide it if the measured ratios were the true ones; None if it is
        decided, or no number of runs can be told.
    """

    text: str
    verdict: RatioVerdict
    needed: int | None = None


def more(text: str, difference: Difference, runs: int) -> RatioClaim:
    """Return the claim that the first ratio is larger; ``runs`` is how many replicates there were of each kind."""
    low, high = difference.interval(CLAIM_LEVEL)
    verdict: RatioVerdict = "holds" if low > 0 else "does not hold" if high < 0 else "not decided"
    first, second = difference.first, difference.second
    each = min(first.size, second.size) / runs
    needed = runs_needed(first.value, second.value, level=CLAIM_LEVEL, cells_per_run=each)
    return RatioClaim(_sentence(text, difference), verdict, needed if verdict == "not decided" else None)


def alike(text: str, difference: Difference, runs: int) -> RatioClaim:
    """Return the claim that two ratios differ by less than ``ALIKE``."""
    low, high = difference.interval(CLAIM_LEVEL)
    if low > -ALIKE and high < ALIKE:
        return RatioClaim(_sentence(text, difference), "holds")
    if low > ALIKE or high < -ALIKE:
        return RatioClaim(_sentence(text, difference), "does not hold")
    return RatioClaim(_sentence(text, difference), "not decided", _runs_for_margin(difference, runs))


def _runs_for_margin(difference: Difference, runs: int) -> int | None:
    """Return runs with which an interval around the measured difference leaves the margin on one side."""
    distance = abs(ALIKE - abs(difference.value))
    ends = (difference.first, difference.second)
    variance = sum(found.value * (1 - found.value) / (found.size / runs) for found in ends)
    if distance == 0 or variance == 0:
        return None
    spread = math.sqrt(variance)
    return math.ceil(sample_size(distance, spread, spread, level=CLAIM_LEVEL))


def _sentence(text: str, difference: Difference) -> str:
    return f"{text}: {difference.first} against {difference.second}, a difference of {difference}"
