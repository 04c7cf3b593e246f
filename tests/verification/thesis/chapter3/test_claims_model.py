"""Chapter 3, sections 1 to 2.2, 3 and 4: the verdicts, and that a wrong ingredient changes each of them."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import pytest

from tests.verification.thesis.claim_changes import Wrong, decided, measured, replaced, times
from tests.verification.thesis.evidence import differences
from verification.claims import Verdict, stated_in
from verification.thesis.chapter3.claims import (
    s1_3_model,
    s2_2_1_cycle,
    s2_2_6_energies,
    s2_2_7_feasible,
    s2_2_8_quasi_steady,
    s2_2_9_parameters,
    s2_2_9_tables,
    s3_tissue,
    s5_directions,
)

PARTS = (
    s1_3_model,
    s2_2_1_cycle,
    s2_2_6_energies,
    s2_2_7_feasible,
    s2_2_8_quasi_steady,
    s2_2_9_parameters,
    s2_2_9_tables,
    s3_tissue,
    s5_directions,
)
CLAIMS = {claim.id: claim for part in PARTS for claim in stated_in(part)}
MODEL, CYCLE, ENERGIES, FEASIBLE, QSS, PARAMETERS, TABLES, TISSUE, DIRECTIONS = (
    "chapter3." + part.__name__.rpartition(".")[2] for part in PARTS
)
HOLDS = Verdict.HOLDS
DISTANCES = ("1/3 R_soft", "1/2 R_soft", "2/3 R_soft", "1 R_soft")
REVERSED = dict(zip(DISTANCES, reversed(DISTANCES), strict=True))


def called_with(**named: Any) -> Callable[..., Any]:
    """The function with other values for some of its parameters."""
    return lambda f: lambda *given, **others: f(*given, **{**others, **named})


def ratios(*values: float) -> pd.DataFrame:
    """A table of growth for three dampings, with narrow intervals."""
    return pd.DataFrame(
        {
            "preset": "thesis",
            "substeps": 20,
            "mu": (0.05, 0.1, 0.2),
            "ratio": values,
            "low": np.subtract(values, 0.01),
            "high": np.add(values, 0.01),
            "runs": 5,
            "lost": 0,
        }
    )


def early(age: Any, cycle: float) -> Any:
    """Cells that enlarge an hour before division."""
    return age >= cycle - 1.0


SHEETS = pd.DataFrame(
    {"layer": "free sheet", "cells": 196, "t": 48.0, "height": 1.7, "height_low": 1.6, "height_high": 1.8, "runs": 3},
    index=[0],
)
GROWTH = {"tissue_ratios": ratios(1.5, 1.2, 1.1)}
CHANGES = {
    "c3.inm": Wrong(MODEL, "speed", times(-1.0)),
    "c3.apical-mitosis": Wrong(MODEL, "nuclei", called_with(g2="0 h", mitosis="0 h")),
    "c3.last-hour": Wrong(MODEL, "nuclei", called_with(g2="150 min")),
    "c3.pushing": Wrong(MODEL, "NO_PUSHING", replaced(())),
    "c3.phases": Wrong(CYCLE, "grown", called_with(mitosis="60 min")),
    "c3.slice": Wrong(CYCLE, "cells_after", lambda f: lambda _, seed: f(0.2, seed)),
    "c3.daughters": Wrong(
        CYCLE, "printed_edges", replaced(lambda edges, mother, new: edges | {(new, mother)} if mother else edges)
    ),
    "c3.dimensions": Wrong(ENERGIES, "R_SOFT_UM", replaced(1.0), HOLDS),
    "c3.forces": Wrong(ENERGIES, "repulsion", times(-1.0)),
    "c3.at-all-times": Wrong(FEASIBLE, ("HARD", "ENLARGED"), replaced(0.0), HOLDS),
    "c3.equal-radii": Wrong(FEASIBLE, "ENLARGED", replaced(1.66 / 5.0), HOLDS),
    "c3.state": Wrong(QSS, "OFF", replaced(0.0), HOLDS),
    "c3.not-unique": Wrong(QSS, "moving", replaced(lambda: ("x",))),
    "c3.regularised": Wrong(QSS, ("regularised", "minima"), lambda f: lambda *given: f(*given[:-1], 2), HOLDS),
    "c3.layers": Wrong(PARAMETERS, "layers", lambda f: lambda distance: f(REVERSED[distance])),
    "c3.box": Wrong(TABLES, "FIRST_HEIGHT", replaced(10.0), HOLDS),
    "c3.row": Wrong(TABLES, "CELLS", replaced(24), HOLDS),
    "c3.basal": Wrong(TABLES, "basal_width", replaced(lambda _: 18.0), HOLDS),
    "c3.offspring": Wrong(TABLES, "singles", lambda f: lambda _: f(0.8), HOLDS),
    "c3.enlarged": Wrong(TABLES, "text_rule", lambda _: early, HOLDS),
    "c3.noise": Wrong(TISSUE, "MU", replaced(1.0), HOLDS),
    "c3.mu-unit": Wrong(TISSUE, "decayed", lambda f: lambda dt, mu: f(dt, 1 / mu), HOLDS),
    "c3.larger-damping": Wrong(
        TISSUE, "growth_steps", lambda f: lambda table: f(table.assign(mu=-table["mu"])), HOLDS, GROWTH
    ),
    "c3.independent-rules": Wrong(DIRECTIONS, "overtaken", replaced(lambda *_: 0), HOLDS),
    "c3.height-in-space": Wrong(
        DIRECTIONS,
        "least_grown",
        lambda f: lambda table: f(table.assign(height=0.5, height_low=0.4, height_high=0.6)),
        tables={"space_heights": SHEETS},
    ),
}


def test_every_claim_of_these_files_is_tried() -> None:
    assert CHANGES.keys() == measured(CLAIMS)


@pytest.mark.parametrize("name", [name for name, claim in CLAIMS.items() if not claim.needs])
def test_verdict(name: str) -> None:
    found = CLAIMS[name].decide({})
    assert CLAIMS[name].verdict(found) is CLAIMS[name].recorded, found.measured
    assert differences(name, found) == []


@pytest.mark.parametrize("name", CHANGES)
def test_a_wrong_ingredient_changes_the_verdict(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = CHANGES[name]
    found = decided(CLAIMS[name], wrong, monkeypatch)
    assert found.verdict is wrong.verdict is not CLAIMS[name].recorded, found.measured


@pytest.mark.parametrize(
    ("values", "verdict"),
    [
        ((1.5, 1.2, 1.1), Verdict.CORRECTED),
        ((1.1, 1.2, 1.5), Verdict.HOLDS),
        ((1.1, 1.5, 1.2), Verdict.REFUTED),
        ((1.5, 1.2, 1.195), Verdict.OPEN),
    ],
)
def test_damping_that_grows_tissue_fastest(values: tuple[float, ...], verdict: Verdict) -> None:
    assert CLAIMS["c3.larger-damping"].decide({"tissue_ratios": ratios(*values)}).verdict is verdict


def test_growth_without_two_dampings_is_open() -> None:
    table = ratios(1.5, 1.2, 1.1).assign(lost=(1, 1, 0))
    assert CLAIMS["c3.larger-damping"].decide({"tissue_ratios": table}).verdict is Verdict.OPEN
