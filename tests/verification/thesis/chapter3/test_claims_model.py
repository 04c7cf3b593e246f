"""Chapter 3, sections 1 to 2.2, 3 and 4: the verdicts, and that a wrong ingredient changes each of them."""

from collections.abc import Callable
from typing import Any

import pandas as pd
import pytest

from tests.verification.thesis.claim_changes import Wrong, decided, measured, replaced, times
from tests.verification.thesis.evidence import differences
from verification.claims import Verdict, stated_in
from verification.thesis.chapter3.claims import (
    s1_3_model,
    s2_2_1_cycle,
    s2_2_6_energies,
    s2_2_7_states,
    s2_2_9_parameters,
)

PARTS = (s1_3_model, s2_2_1_cycle, s2_2_6_energies, s2_2_7_states, s2_2_9_parameters)
CLAIMS = {claim.id: claim for part in PARTS for claim in stated_in(part)}
MODEL, CYCLE, ENERGIES, STATES, PARAMETERS = ("chapter3." + part.__name__.rpartition(".")[2] for part in PARTS)
HOLDS = Verdict.HOLDS
DISTANCES = ("1/3 R_soft", "1/2 R_soft", "2/3 R_soft", "1 R_soft")
REVERSED = dict(zip(DISTANCES, reversed(DISTANCES), strict=True))


def called_with(**named: Any) -> Callable[..., Any]:
    """The function with other values for some of its parameters."""
    return lambda f: lambda *given, **others: f(*given, **{**others, **named})


def early(age: Any, cycle: float) -> Any:
    """Cells that enlarge an hour before division."""
    return age >= cycle - 1.0


# No run of DAHA ends with the printed rest lengths; all end with those that are not negative.
FOUND = {
    "tissue_daha_shares": pd.DataFrame(
        {
            "reading": ("as printed", "desired rest lengths ≥ 0"),
            "runs": 73,
            "share": (1.0, 0.0),
            "low": (0.95, 0.0),
            "high": (1.0, 0.05),
        }
    )
}
CHANGES = {
    "c3.inm": Wrong(MODEL, "speed", times(-1.0)),
    "c3.apical-mitosis": Wrong(MODEL, "nuclei", called_with(g2="0 h", mitosis="0 h")),
    "c3.last-hour": Wrong(MODEL, "nuclei", called_with(g2="150 min")),
    "c3.pushing": Wrong(MODEL, "NO_PUSHING", replaced(())),
    "c3.phases": Wrong(CYCLE, "grown", called_with(mitosis="60 min")),
    "c3.passive-springs": Wrong(CYCLE, "off_length", replaced(lambda table: table["time_h"]), Verdict.REFUTED, FOUND),
    "c3.slice": Wrong(CYCLE, "cells_after", lambda f: lambda _, seed: f(0.2, seed)),
    "c3.daughters": Wrong(
        CYCLE, "printed_edges", replaced(lambda edges, mother, new: edges | {(new, mother)} if mother else edges)
    ),
    "c3.dimensions": Wrong(ENERGIES, "R_SOFT_UM", replaced(1.0), HOLDS),
    "c3.forces": Wrong(ENERGIES, "repulsion", times(-1.0)),
    "c3.at-all-times": Wrong(STATES, ("HARD", "ENLARGED"), replaced(0.0), HOLDS),
    "c3.equal-radii": Wrong(STATES, "ENLARGED", replaced(1.66 / 5.0), HOLDS),
    "c3.state": Wrong(STATES, "OFF", replaced(0.0), HOLDS),
    "c3.not-unique": Wrong(STATES, "moving", replaced(lambda: ("x",))),
    "c3.regularised": Wrong(STATES, ("regularised", "minima"), lambda f: lambda *given: f(*given[:-1], 2), HOLDS),
    "c3.layers": Wrong(PARAMETERS, "layers", lambda f: lambda distance: f(REVERSED[distance])),
    "c3.box": Wrong(PARAMETERS, "FIRST_HEIGHT", replaced(10.0), HOLDS),
    "c3.row": Wrong(PARAMETERS, "CELLS", replaced(24), HOLDS),
    "c3.basal": Wrong(PARAMETERS, "basal_width", replaced(lambda _: 18.0), HOLDS),
    "c3.offspring": Wrong(PARAMETERS, "singles", lambda f: lambda _: f(0.8), HOLDS),
    "c3.enlarged": Wrong(PARAMETERS, "text_rule", lambda _: early, HOLDS),
}


def test_every_claim_of_these_files_is_tried() -> None:
    assert CHANGES.keys() == measured(CLAIMS)


@pytest.mark.parametrize("name", CLAIMS)
def test_verdict(name: str) -> None:
    found = CLAIMS[name].decide(FOUND)
    assert CLAIMS[name].verdict(found) is CLAIMS[name].recorded, found.measured
    assert differences(name, found) == []


@pytest.mark.parametrize("name", CHANGES)
def test_a_wrong_ingredient_changes_the_verdict(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = CHANGES[name]
    found = decided(CLAIMS[name], wrong, monkeypatch)
    assert found.verdict is wrong.verdict is not CLAIMS[name].recorded, found.measured


def test_printed_rest_lengths_hold_if_runs_of_daha_end_with_them() -> None:
    ending = FOUND["tissue_daha_shares"].assign(share=0.0, low=0.0, high=0.05)
    assert CLAIMS["c3.passive-springs"].decide({"tissue_daha_shares": ending}).verdict is HOLDS
