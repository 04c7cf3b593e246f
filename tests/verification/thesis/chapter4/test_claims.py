"""Chapter 4: other tables than the kept ones, and the verdicts by reading."""

from __future__ import annotations

from functools import cache

import pandas as pd
import pytest

from tests.verification.thesis.claims import CLAIMS as ALL
from tests.verification.thesis.claims import Otherwise
from tests.verification.thesis.emt_tables import (
    KEPT,
    by_position_or_time,
    deciding_as,
    exchanged,
    printed_as_published,
    renamed,
    reversed_rows,
    with_counts,
    without_early_extrusion,
)
from verification.claims import Evidence, Verdict
from verification.thesis.chapter4 import frequencies
from verification.thesis.chapter4.ensembles import PRESETS
from verification.thesis.chapter4.groups import EDGES

CLAIMS = {name: claim for name, claim in ALL.items() if name.startswith("c4.")}


AS_PRINTED = deciding_as(KEPT, "thesis")
RATIOS, GROUPS = frequencies.RATIOS, frequencies.GROUPS
HOLDS = Verdict.HOLDS
CHANGES = {
    "c4.isolated": Otherwise(printed_as_published(), HOLDS),
    "c4.protrusions": Otherwise(renamed("scenario", **{"[A]": "[BP]", "[BP]": "[A]"})),
    "c4.remain": Otherwise(AS_PRINTED, Verdict.OPEN),
    "c4.mostly-basally": Otherwise(exchanged("what", "apical", "basal"), HOLDS),
    "c4.apical": Otherwise(with_counts(RATIOS, 0.5)),
    "c4.timing-isolated": Otherwise(with_counts(RATIOS, 0.5), HOLDS),
    "c4.without-inm": Otherwise(exchanged("what", "basal", "apical")),
    "c4.inm-swaps": Otherwise(AS_PRINTED, Verdict.OPEN),
    "c4.drift": Otherwise(with_counts(RATIOS, 0.5), Verdict.OPEN),
    "c4.straightness": Otherwise(AS_PRINTED),
    "c4.straightness-rule": Otherwise(with_counts(RATIOS, 0.1), HOLDS),
    "c4.dominates": Otherwise(with_counts(RATIOS, 0.5), Verdict.OPEN),
    "c4.homogeneous-drop": Otherwise(AS_PRINTED),
    "c4.mixed-with-inm": Otherwise(AS_PRINTED),
    "c4.mixed-without-inm": Otherwise(AS_PRINTED),
    "c4.almost-double": Otherwise(AS_PRINTED, HOLDS),
    "c4.competition": Otherwise(reversed_rows("events")),
    "c4.timing": Otherwise(by_position_or_time()),
    "c4.onset-over-timing": Otherwise(exchanged("given", "onset_ab", "t_a_h")),
    "c4.predictor": Otherwise(exchanged("factor", "onset", "B")),
    "c4.most-basal": Otherwise(with_counts(GROUPS, 0.75, EDGES), HOLDS),
    "c4.lower-half": Otherwise(by_position_or_time()),
    "c4.only-protrusions": Otherwise(with_counts(RATIOS, 0.95)),
    "c4.fewer-apical": Otherwise(with_counts(RATIOS, 0.0), Verdict.OPEN),
    "c4.q2-inm": Otherwise(exchanged("kind", "[A]", "[B]")),
    "c4.q1": Otherwise(with_counts(GROUPS, 0.99, ["events"])),
    "c4.q2": Otherwise(with_counts(GROUPS, 0.5, ["events"]), Verdict.OPEN),
    "c4.q3": Otherwise(without_early_extrusion()),
    "c4.q4": Otherwise(exchanged("given", "[AB]", "[BA]")),
    "c4.q5": Otherwise(with_counts(RATIOS, 0.5), Verdict.OPEN),
    "c4.q6": Otherwise(exchanged("scenario", "[Bx]", "[Bx] no INM")),
    "c4.q7": Otherwise(by_position_or_time()),
    "c4.q8": Otherwise(exchanged("study", "table5_7_published", "table5_63_published")),
}


def ratios(basal: int) -> dict[str, pd.DataFrame]:
    """400 isolated cells a scenario; ``basal`` of those with protrusions leave basally."""
    counts = {"[A]": (60, 100), "[B]": (0, 40), "[S]": (0, 170), "[BP]": (basal, 30)}
    rows = [
        {"study": study, "scenario": scenario, "what": what, "count": count, "of": 400, "effective": 400.0}
        for study in (f"figure10{ending}" for ending in PRESETS.values())
        for scenario, both in counts.items()
        for what, count in zip(("basal", "apical"), both, strict=True)
    ]
    return {RATIOS: pd.DataFrame(rows)}


@cache
def by_kept(name: str) -> Evidence:
    """Decide a claim by the kept tables, once for the tests of this file."""
    return CLAIMS[name].decide(KEPT)


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
