"""What checks measure stays as it was when the verdicts were recorded; ``--force-regen`` writes the files anew."""

from typing import Any

import pandas as pd
import pytest

from verification.claims import Claim, Comparison
from verification.thesis.register import chapter_of, register

pytest.importorskip("pytest_regressions")
ALONE = [claim for claim in register() if not claim.needs]


def measured(claim: Claim) -> list[dict[str, Any]]:
    """The numbers of a claim; those of samples have an interval, and are another matter on another processor."""
    found = claim.decide({})
    return [
        {"claim": claim.id, "as": side, "number": number, "value": one.value}
        for side, compared in (("printed", found.printed), ("corrected", found.corrected))
        for number, one in enumerate(compared)
        if isinstance(one, Comparison) and one.interval is None
    ]


@pytest.mark.slow
@pytest.mark.parametrize("chapter", sorted({chapter_of(claim) for claim in ALONE}))
def test_measured_numbers_are_the_kept_ones(chapter: int, dataframe_regression: Any) -> None:
    rows = [row for claim in ALONE if chapter_of(claim) == chapter for row in measured(claim)]
    tolerance = {"rtol": 1e-3, "atol": 1e-9}
    dataframe_regression.check(pd.DataFrame(rows), basename=f"chapter{chapter}", default_tolerance=tolerance)
