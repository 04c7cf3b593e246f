"""The EMT studies with few runs that end early: the whole way to their chapter in seconds."""

from dataclasses import replace

import pytest

from tissue.study import plan
from verification.thesis.chapter4 import studies

# A lot of eight for each scenario, and of the groups as many as the ranking of factors needs at least.
FEW = dict.fromkeys(studies.SHORT, 8) | {"table5_35": 24, "table5_63": 16, "table5_7": 16}
# Of the figures and tables some.
FEWEST = {"figure10": 8, "figure12": 8, "table5_35": 24}
# Of the page.
SECTIONS = [
    "Isolated cells",
    "Groups of cells with the same events",
    "Heterogeneous groups",
    "Position at the onset, timing, and what matters most",
    "The eight questions",
    "Sensitivity to the mechanics",
    "Control cells",
    "The runs of this page beside the complete studies",
]
END = "25 h"  # after all events


def shorten_emt(patch: pytest.MonkeyPatch, replicates: dict[str, int]) -> None:
    """These studies alone, with so many replicates each."""
    whole = plan.load_study

    def brief(path):
        study = whole(path)
        keep = {} if "table5" in str(path) else {"numerics.keep": "5 h"}
        scenarios = {key: given.changed({"numerics.t_end": END} | keep) for key, given in study.scenarios.items()}
        return replace(study, scenarios=scenarios, replicates=8)

    patch.setattr(studies, "SHORT", replicates)
    patch.setattr(studies, "load_study", brief)
    patch.setattr(plan, "load_study", brief)
