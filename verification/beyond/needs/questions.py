"""What the simplest model is sought for: five questions on cells and tissues, and the eight questions of chapter 4.

Each of the eight is asked by a difference of basal extrusion at the end of the runs that answers it: of two scenarios,
or of two kinds of cells of one scenario. The model is the one printed in the thesis.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from tissue.statistics.categories import outcome

# Programs at random times that no study of the program has.
PROGRAMS = str(Path(__file__).parent / "programs.toml")
ANY_TIME, GROUP = "[A] and [B] at any time", "[A] and [B] at any time, 10 cells"
# Q7: the most basal part of the apical-basal scale, and the share of cells of GROUP that begin EMT there in the full
# model: 0.07 of 640 cells of 64 runs.
BASAL_PART, THERE = 0.2, 0.07


def placed(cells: pd.DataFrame, end: float) -> pd.Series:
    """Weigh basal extrusion by the place at the onset: 1/p below BASAL_PART, -1/(1 - p) elsewhere, p = THERE.

    The mean is basal extrusion of cells that begin EMT in the most basal fifth minus that of the others, as long as
    their share is p; a model that puts another share there is biased by this, too.
    """
    low = cells["onset_ab"] < BASAL_PART
    return outcome(cells, "basal", end) * (low / THERE - (~low) / (1 - THERE))


def without_protrusions(cells: pd.DataFrame, end: float) -> pd.Series:
    """Weigh basal extrusion so that the mean over a run is that of its cells without [P]; 0 if it has none."""
    chosen = (cells["t_p_h"] >= end).astype(float)
    share = chosen.groupby(cells["replicate"]).transform("mean")
    return outcome(cells, "basal", end) * (chosen / share).where(share > 0, 0.0)


class Asked(NamedTuple):
    """A question: a study, by name or path, and what ``tissue.simplify`` is asked; shares are parts, heights um."""

    study: str
    what: dict[str, Any]


def _basal(study: str, tolerance: float, *scenarios: str, runs: int = 512) -> Asked:
    return Asked(study, {"outcome": "basal", "scenarios": list(scenarios), "tolerance": tolerance, "runs": runs})


FIVE = {
    "basal extrusion after [A]": _basal("figure10", 0.03, "[A]", runs=1024),
    "apical extrusion after [A]": Asked(
        "figure10", {"outcome": "apical", "scenarios": ["[A]"], "tolerance": 0.05, "runs": 2048}
    ),
    "basal extrusion of a group": _basal("questions", 0.05, GROUP, runs=1024),
    "effect of INM on a group": _basal("questions", 0.05, f"{ANY_TIME} no INM, 10 cells", GROUP, runs=1024),
    "height at 48 h": Asked(
        "figure10", {"outcome": "height_um", "scenarios": ["[B]"], "tolerance": 2.0, "at": "48 h", "runs": 1024}
    ),
}
# By the names of ``verification.thesis.chapter4.questions``.
EIGHT = {
    "Q1": _basal(PROGRAMS, 0.07, "35 % [P], alone", "35 % [P]", runs=256),
    "Q2": _basal("figure10", 0.1, "[BP]", "[B]"),
    "Q3": _basal(PROGRAMS, 0.05, "early [A]", "late [A]"),
    "Q4": _basal("figure14", 0.1, "[AxB]", "[BxA]", runs=256),
    "Q5": _basal("questions", 0.1, ANY_TIME, GROUP, runs=64),
    "Q6": _basal("questions", 0.07, "[B] at any time no INM", "[B] at any time", runs=256),
    "Q7": Asked("questions", {"outcome": placed, "scenarios": [GROUP], "tolerance": 0.25, "runs": 64}),
    "Q8": Asked(
        PROGRAMS,
        {"outcome": without_protrusions, "scenarios": ["7 % [P]", "63 % [P]"], "tolerance": 0.05, "runs": 128},
    ),
}
QUESTIONS = FIVE | EIGHT
