"""Introduction and chapter 1: wrong ingredients of checks."""

import pandas as pd
import pytest

from tests.verification.thesis.claim_changes import CLAIMS, Wrong, replaced, times
from verification.claims import Verdict
from verification.thesis.chapter1.cells import HARD
from verification.thesis.chapter1.claims import (
    s4_6_1_tools,
)
from verification.thesis.chapter4.studies import PRESETS


def opposite(ends: tuple[float, float]) -> tuple[float, float]:
    """The ends of the interval -F(x)."""
    return -ends[1], -ends[0]


def ratios(basal: int) -> dict[str, pd.DataFrame]:
    """400 isolated cells a scenario; ``basal`` of those with protrusions leave basally."""
    counts = {"[A]": (60, 100), "[B]": (0, 40), "[S]": (0, 170), "[BP]": (basal, 30)}
    rows = [
        {"study": study, "scenario": scenario, "what": what, "count": count, "of": 400, "effective": 400.0}
        for study in (f"figure10{ending}" for ending in PRESETS.values())
        for scenario, both in counts.items()
        for what, count in zip(("basal", "apical"), both, strict=True)
    ]
    return {"emt_complete_ratios": pd.DataFrame(rows)}


TRUE = Verdict.HOLDS
CHANGES: dict[str, Wrong] = {
    "c1.density": Wrong("chapter1.s1_1_newton", "LITRE", replaced(1e-6), TRUE),
    "c1.almost-everywhere": Wrong("chapter1.s2_solutions", "cantor", replaced(lambda x: x), TRUE),
    "c1.generalise": Wrong("chapter1.s2_1_inclusions", "step_values", replaced(lambda x: (0.0, 0.0)), TRUE),
    "c1.prox-constant": Wrong("chapter1.s4_1_prox", "printed_constant", replaced(lambda n, d: 0.01 / n), TRUE),
    "c1.existence": Wrong("chapter1.s4_5_existence", "slide", times(1.01)),
    "c1.start": Wrong("chapter1.s4_5_existence", "apart", replaced(lambda y: y), TRUE),
    "c1.time-independent": Wrong("chapter1.cells", "GROWN", replaced(HARD), TRUE),
    "c1.isometry": Wrong("chapter1.s4_6_1_tools", "sup_norm", replaced(s4_6_1_tools.mean_norm), TRUE),
    "c1.gronwall-discrete": Wrong("chapter1.s4_6_1_tools", "sequences", times(1.2)),
    "c1.dense": Wrong("chapter1.s4_6_2_steps", "settled", times(0.9)),
    "c1.applications": Wrong("chapter1.cells", ("GROWN", "OFFSET"), replaced(HARD), TRUE),
}


@pytest.mark.parametrize(("basal", "verdict"), [(350, Verdict.HOLDS), (260, Verdict.OPEN), (10, Verdict.REFUTED)])
def test_protrusions_are_judged_by_the_interval(basal: int, verdict: Verdict) -> None:
    evidence = CLAIMS["c4.protrusions"].decide(ratios(basal))
    assert evidence.verdict is verdict, evidence.measured
    assert evidence.runs_needed
