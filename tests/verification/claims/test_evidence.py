"""Comparisons know true, false and open; the verdict follows from them and from nothing else."""

import math

import pytest

from verification.claims import Comparison, Evidence, Verdict, at_least, at_most, equal

TRUE, FALSE, UNKNOWN = equal("x", 1.0, 1.0), equal("x", 2.0, 1.0), equal("x", math.nan, 1.0)


@pytest.mark.parametrize(
    ("comparison", "truth"),
    [
        (equal("x", 1.05, 1.0, 0.1), True),
        (equal("x", 1.15, 1.0, 0.1), False),
        (equal("x", 1.05, 1.0, 0.1, (0.95, 1.08)), True),
        (equal("x", 1.05, 1.0, 0.1, (0.95, 1.12)), None),
        (equal("x", 1.2, 1.0, 0.1, (1.15, 1.3)), False),
        (equal("x", 1.0, 1.0, 0.1, (math.nan, 1.0)), None),
        (UNKNOWN, None),
        (at_most("x", 3, 3), True),
        (at_most("x", 3.1, 3), False),
        (at_most("x", 3.1, 3, 0.2), True),
        (at_least("x", 3, 3), True),
        (at_least("x", 2.9, 3), False),
        (at_least("x", 2.9, 3, 0.2), True),
        (at_least("x", math.inf, 3), True),
    ],
)
def test_a_number_is_in_its_range_or_not_or_nobody_knows(comparison: Comparison, truth: bool | None) -> None:
    assert comparison.true is truth


@pytest.mark.parametrize(
    ("printed", "corrected", "verdict"),
    [
        ((TRUE,), (), Verdict.HOLDS),
        ((TRUE,), (FALSE,), Verdict.HOLDS),
        ((TRUE, FALSE), (), Verdict.REFUTED),
        ((FALSE,), (TRUE, TRUE), Verdict.CORRECTED),
        ((FALSE,), (TRUE, FALSE), Verdict.REFUTED),
        ((FALSE,), (TRUE, UNKNOWN), Verdict.OPEN),
        ((TRUE, UNKNOWN), (), Verdict.OPEN),
        ((FALSE, UNKNOWN), (TRUE,), Verdict.CORRECTED),
        ((), (), Verdict.OPEN),
    ],
)
def test_verdict(printed: tuple[Comparison, ...], corrected: tuple[Comparison, ...], verdict: Verdict) -> None:
    assert Evidence("measured", printed, corrected).verdict is verdict


@pytest.mark.parametrize(
    ("comparison", "text"),
    [
        (equal("count", 12, 29), "count 12 (required 29)"),
        (equal("ratio", 0.98, 1.0, 0.1, (0.96, 1.01)), "ratio 0.98 [0.96, 1.01] (required 1 ± 0.1)"),
        (at_most("error [m]", 2e-9, 1e-8), "error [m] 2e-09 (required ≤ 1e-08)"),
        (at_least("slack", -1, 0), "slack -1 (required ≥ 0)"),
    ],
)
def test_a_comparison_reads_as_a_sentence(comparison: Comparison, text: str) -> None:
    assert str(comparison) == text
