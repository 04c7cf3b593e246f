"""The studies of this room, by the names of their tables."""

from __future__ import annotations

from collections.abc import Callable

from dincl.study import Study
from verification.methods import large_steps, orders, proved, references, strengths
from verification.methods.chart import programs, work_precision
from verification.methods.chart import references as charted
from verification.methods.decisions import study as decisions
from verification.methods.hard import study as hard
from verification.methods.stability import page as stability

# Name -> the function ``study(smallest=False)``; the smallest form has some of the runs of the complete one.
STUDIES: dict[str, Callable[..., Study]] = {
    "references": references.study,
    "orders": orders.study,
    "penalty_scan": strengths.scan,
    "large_steps": large_steps.study,
    "proved_scenes": proved.chosen,
    "proved_random": proved.random,
    **stability.STUDIES,
    "work_references": charted.study,
    "work_precision": work_precision.study,
    "programs": programs.study,
    "decisions": decisions.study,
    "hard_scenes": hard.study,
}
