"""The studies of this room, by the names of their tables."""

from __future__ import annotations

from collections.abc import Callable

from dincl.study import Study
from verification.thesis.chapter3 import accuracy, daha, growth, stability, substeps
from verification.thesis.chapter4 import differences, groups, in_time, programs
from verification.thesis.chapter5 import page as meanfield

# Name -> the function ``study(smallest=False)``; the smallest form has some of the runs of the complete one.
STUDIES: dict[str, Callable[..., Study]] = {
    "tissue_substeps": substeps.study,
    "tissue_motion": accuracy.motion,
    "tissue_judged": accuracy.steps,
    "tissue_growth": growth.study,
    stability.NAME: stability.study,
    "tissue_daha": daha.study,
    "emt_in_time": in_time.study,
    "emt_ratios": programs.study,
    "emt_groups": groups.study,
    "emt_ranking": groups.ranking,
    "emt_effects": differences.effects,
    **meanfield.STUDIES,
}
