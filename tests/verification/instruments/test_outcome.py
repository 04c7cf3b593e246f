"""The outcomes of runs, and the rule that assigns them."""

import numpy as np
import pytest

import dincl
from verification.instruments.outcome import FAR, Outcome, judge

ERROR, OVERLAP = 0.02, 0.1
OK = dincl.Status.SUCCESS


@pytest.mark.parametrize(
    ("status", "error", "overlap", "growth", "expected"),
    [
        (OK, 0.0, 0.0, 1.0, Outcome.CONVERGED),
        (OK, ERROR, OVERLAP, FAR, Outcome.CONVERGED),
        (OK, 1.01 * ERROR, 0.0, 1.0, Outcome.INACCURATE),
        (OK, np.nan, 0.0, 1.0, Outcome.INACCURATE),
        (OK, None, 0.0, 1.0, Outcome.BOUNDED),
        (OK, None, 1.01 * OVERLAP, 1.0, Outcome.INFEASIBLE),
        (OK, 0.0, 1.01 * OVERLAP, 1.0, Outcome.INFEASIBLE),
        (OK, 0.0, 1.01 * OVERLAP, 1.01 * FAR, Outcome.UNSTABLE),
        (dincl.Status.NON_FINITE, np.nan, np.nan, 1.0, Outcome.UNSTABLE),
        (dincl.Status.NOT_CONVERGED, np.nan, 0.0, 1.0, Outcome.NOT_TERMINATED),
        (dincl.Status.NOT_CONVERGED, np.nan, 0.0, 1e9, Outcome.UNSTABLE),
        (dincl.Status.INFEASIBLE, np.nan, 0.0, 1.0, Outcome.REFUSED),
        (dincl.Status.COINCIDENT_CENTRES, np.nan, 0.0, 1.0, Outcome.REFUSED),
        (dincl.Status.CROWDED, np.nan, 0.0, 1.0, Outcome.REFUSED),
    ],
)
def test_rule(status, error, overlap, growth, expected):
    assert judge(status, error, overlap, growth, ERROR, OVERLAP) is expected
