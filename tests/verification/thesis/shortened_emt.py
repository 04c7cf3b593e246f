"""The EMT studies with few runs that end early: the whole way to their chapter in seconds."""

from dataclasses import replace

import pytest

from tissue.study import plan
from verification.thesis.chapter4 import studies

# A lot of eight for each scenario, and of the groups as many as the ranking of factors needs at least.
FEW = dict.fromkeys(studies.SHORT.replicates, 8) | {"table5_35": 24, "table5_63": 16, "table5_7": 16}
# Of the figures and tables some.
FEWEST = {"figure10": 8, "figure12": 8, "table5_35": 24}
END = "25 h"  # after all events


def emt_form(replicates: dict[str, int]) -> studies.EmtForm:
    """These studies alone, with so many replicates each."""
    return studies.EmtForm(replicates, {name: _brief("table5" in name) for name in replicates})


def _brief(table: bool) -> dict[str, str]:
    """Runs that end early; states are kept where figures are drawn of them."""
    return {"numerics.t_end": END} | ({} if table else {"numerics.keep": "5 h"})


def shorten_command(patch: pytest.MonkeyPatch) -> None:
    """Brief runs, eight of each scenario, by the command ``tissue study``, which knows no forms."""
    whole = plan.load_study

    def brief(path):
        study = whole(path)
        changes = _brief("table5" in str(path))
        scenarios = {key: given.changed(changes) for key, given in study.scenarios.items()}
        return replace(study, scenarios=scenarios, replicates=8)

    patch.setattr(plan, "load_study", brief)
