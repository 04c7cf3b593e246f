"""Chapter 4: the verdicts by reading, and by the interval."""

from __future__ import annotations

from functools import cache

import pandas as pd
import pytest

from tests.verification.thesis.tables import CLAIMS as ALL
from tests.verification.thesis.tables import shipped_tables
from verification.claims import Evidence, Verdict
from verification.thesis.chapter4 import frequencies
from verification.thesis.chapter4.ensembles import PRESETS

CLAIMS = {name: claim for name, claim in ALL.items() if name.startswith("c4.")}


def ratios(basal: int) -> dict[str, pd.DataFrame]:
    """400 isolated cells a scenario; ``basal`` of those with protrusions leave basally."""
    counts = {"[A]": (60, 100), "[B]": (0, 40), "[S]": (0, 170), "[BP]": (basal, 30)}
    rows = [
        {"study": study, "scenario": scenario, "what": what, "count": count, "of": 400, "effective": 400.0}
        for study in (f"figure10{ending}" for ending in PRESETS.values())
        for scenario, both in counts.items()
        for what, count in zip(("basal", "apical"), both, strict=True)
    ]
    return {frequencies.RATIOS: pd.DataFrame(rows)}


@cache
def by_kept(name: str) -> Evidence:
    """Decide a claim by the kept tables, once for the tests of this file."""
    return CLAIMS[name].decide(shipped_tables())


# By reading, where those differ: with the printed energies, by the published program, with the corrected energies.
READINGS = {
    "c4.remain": "OPEN HOLDS HOLDS",
    "c4.timing-isolated": "OPEN CORRECTED CORRECTED",
    "c4.inm-swaps": "OPEN HOLDS HOLDS",
    "c4.straightness": "REFUTED HOLDS REFUTED",
    "c4.straightness-rule": "CORRECTED HOLDS CORRECTED",
    "c4.homogeneous-drop": "REFUTED CORRECTED OPEN",
    "c4.mixed-with-inm": "REFUTED HOLDS HOLDS",
    "c4.mixed-without-inm": "REFUTED HOLDS REFUTED",
    "c4.q5-mixed": "OPEN CORRECTED CORRECTED",
    "c4.almost-double": "HOLDS CORRECTED CORRECTED",
    "c4.timing": "HOLDS HOLDS OPEN",
    "c4.most-basal": "REFUTED OPEN HOLDS",
    "c4.q1": "REFUTED HOLDS HOLDS",
    "c4.q4": "OPEN HOLDS HOLDS",
    "c4.q5": "REFUTED HOLDS OPEN",
    "c4.q6": "OPEN HOLDS HOLDS",
}


@pytest.mark.slow
def test_the_readings_differ_where_it_is_said() -> None:
    found = {}
    for name, claim in CLAIMS.items():
        readings = [claim.verdict(each).name for each in by_kept(name).readings.values()]
        if len(set(readings)) > 1:
            found[name] = " ".join(readings)
    assert found == READINGS


# These describe the model, and are not about the outcomes of simulations.
OF_THE_MODEL = {"c4.straightness-rule"}


@pytest.mark.slow_with("c4.pulled-back")
@pytest.mark.parametrize("name", CLAIMS)
def test_the_published_program_decides_on_outcomes_and_the_printed_energies_on_the_model(name: str) -> None:
    found = by_kept(name)
    if found.readings:
        decides = frequencies.READINGS["thesis" if name in OF_THE_MODEL else "published"]
        assert list(found.readings) == list(frequencies.READINGS.values())
        assert found.readings[decides].printed == found.printed
        assert found.readings[decides].verdict is found.verdict


@pytest.mark.parametrize(("basal", "verdict"), [(350, Verdict.HOLDS), (260, Verdict.OPEN), (10, Verdict.REFUTED)])
def test_protrusions_are_judged_by_the_interval(basal: int, verdict: Verdict) -> None:
    evidence = CLAIMS["c4.protrusions"].decide(ratios(basal))
    assert evidence.verdict is verdict, evidence.measured
    assert evidence.runs_needed
