"""Chapter 4: wrong values in what checks read, and the verdicts by reading."""

from __future__ import annotations

from functools import cache
from typing import Any

import pandas as pd
import pytest

from tests.verification.thesis.claim_changes import CLAIMS as ALL
from tests.verification.thesis.claim_changes import Wrong, replaced
from tests.verification.thesis.emt_tables import (
    KEPT,
    Frames,
    deciding_as,
    exchanged,
    one_value,
    renamed,
    reversed_rows,
    with_counts,
    without_early_extrusion,
)
from tissue.files.timing import timing
from verification.claims import Evidence, Verdict
from verification.thesis.chapter4 import frequencies
from verification.thesis.chapter4.claims import (
    s4_1_isolated,
    s4_3_tables,
)

CLAIMS = {name: claim for name, claim in ALL.items() if name.startswith("c4.")}


def same(value: Any) -> Any:
    return value


def by_tables(tables: Frames, verdict: Verdict = Verdict.REFUTED) -> Wrong:
    return Wrong("chapter4.frequencies", (), same, verdict, tables)


def mirrored_gain(gain: Any) -> Any:
    """Homogeneous minus mixed groups."""
    return lambda *given, sign=1, **named: gain(*given[:5], -(given[5] if len(given) > 5 else sign), **named)


def without_b(positions: Any) -> Any:
    """Runs in which [B] never frees the basal point."""
    return lambda preset, seeds, b: positions(preset, seeds, "never")


AS_PRINTED = deciding_as(KEPT, "thesis")
RATIOS, CATEGORIES, CONDITIONAL = frequencies.RATIOS, frequencies.CATEGORIES, frequencies.CONDITIONAL
HOLDS, FAILS = Verdict.HOLDS, Verdict.REFUTED
CHANGES = {
    "c4.pulled-back": Wrong("chapter4.s4_3_tables", "positions", without_b),
    "c4.orders": Wrong("chapter4.s3_1_counts", "_orders", replaced(lambda: ["A", "B"])),
    "c4.isolated": by_tables(one_value(s4_1_isolated.PRINTED, "agrees", True), HOLDS),
    "c4.protrusions": by_tables(renamed("scenario", **{"[A]": "[BP]", "[BP]": "[A]"})),
    "c4.remain": by_tables(AS_PRINTED, Verdict.OPEN),
    "c4.mostly-basally": by_tables(exchanged("what", "apical", "basal"), HOLDS),
    "c4.apical": by_tables(with_counts(RATIOS, 0.5)),
    "c4.timing-isolated": by_tables(with_counts(RATIOS, 0.5), HOLDS),
    "c4.without-inm": by_tables(exchanged("what", "basal", "apical")),
    "c4.inm-swaps": by_tables(AS_PRINTED, Verdict.OPEN),
    "c4.drift": by_tables(with_counts(RATIOS, 0.5), Verdict.OPEN),
    "c4.straightness": by_tables(AS_PRINTED),
    "c4.straightness-rule": by_tables(with_counts(RATIOS, 0.1), HOLDS),
    "c4.table-4": Wrong("chapter4.s4_3_tables", "NINTH", replaced(s4_3_tables.TABLE_4[9])),
    "c4.seven-per-cent": Wrong("chapter4.s4_3_tables", "timing", replaced(lambda _: timing("6 h"))),
    "c4.data-points": Wrong("chapter4.s4_3_tables", "STATED_RUNS", replaced(500_000), HOLDS),
    "c4.figure-20": Wrong("chapter4.s4_3_tables", "TABLE_5", replaced((dict.fromkeys("ABSP", "6 h"),)), HOLDS),
    "c4.dominates": by_tables(with_counts(RATIOS, 0.5), Verdict.OPEN),
    "c4.homogeneous-drop": by_tables(AS_PRINTED),
    "c4.q5-mixed": Wrong("chapter4.s4_5_mixed", "gain", mirrored_gain, FAILS, KEPT),
    "c4.mixed-with-inm": by_tables(AS_PRINTED),
    "c4.mixed-without-inm": by_tables(AS_PRINTED),
    "c4.almost-double": by_tables(AS_PRINTED, HOLDS),
    "c4.competition": by_tables(reversed_rows(CATEGORIES, "category")),
    "c4.timing": by_tables(reversed_rows(CONDITIONAL, "study", "given", "inm")),
    "c4.onset-over-timing": by_tables(exchanged("given", "onset_ab", "t_a_h")),
    "c4.predictor": by_tables(exchanged("factor", "onset", "B")),
    "c4.most-basal": by_tables(with_counts(CONDITIONAL, 0.75), HOLDS),
    "c4.lower-half": by_tables(reversed_rows(CONDITIONAL, "study", "given", "inm")),
    "c4.only-protrusions": by_tables(with_counts(RATIOS, 0.95)),
    "c4.fewer-apical": by_tables(with_counts(RATIOS, 0.0), Verdict.OPEN),
    "c4.q2-inm": by_tables(exchanged("category", "[A]", "[B]")),
    "c4.q1": by_tables(with_counts(CATEGORIES, 0.99)),
    "c4.q2": by_tables(with_counts(CATEGORIES, 0.5), Verdict.OPEN),
    "c4.q3": by_tables(without_early_extrusion()),
    "c4.q4": by_tables(exchanged("order", "[AB]", "[BA]")),
    "c4.q5": by_tables(with_counts(RATIOS, 0.5), Verdict.OPEN),
    "c4.q6": by_tables(exchanged("scenario", "[Bx]", "[Bx] no INM")),
    "c4.q7": by_tables(reversed_rows(CONDITIONAL, "study", "given", "inm")),
    "c4.q8": by_tables(exchanged("study", "table5_7_published", "table5_63_published")),
}


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


@pytest.mark.parametrize(
    ("thesis", "published", "verdict"),
    [(2, 2, Verdict.HOLDS), (1, 2, Verdict.CORRECTED), (1, 1, Verdict.REFUTED), (1, 0, Verdict.REFUTED)],
)
def test_printed_ratios_may_be_those_of_the_published_runs(thesis: int, published: int, verdict: Verdict) -> None:
    rows = [
        {"preset": preset, "time_h": 48.0, "agrees": k < agreeing}
        for preset, agreeing in (("thesis", thesis), ("published", published))
        for k in range(2)
    ]
    assert CLAIMS["c4.isolated"].decide({s4_1_isolated.PRINTED: pd.DataFrame(rows)}).verdict is verdict
