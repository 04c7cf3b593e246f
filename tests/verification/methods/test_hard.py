"""Right, wrong or refused on the hard scenes; tests/dincl/test_events.py has the schemes that state an error."""

import numpy as np
import pandas as pd
import pytest

from verification.methods.hard import study
from verification.site.store import shipped


def test_schemes_that_state_an_error_are_right_or_refuse():
    found = study.verdicts(shipped("hard_scenes")).pivot(index="scene", columns="method", values="verdict")
    assert len(found) == len(study.study().runs)
    stated = found[[study.AUTO, study.EVENTS]]
    assert not (stated == study.WRONG).any(axis=None)
    assert list(stated.index[(stated == study.REFUSES).any(axis=1)]) == ["struck at rest"]
    counts = study.counted(study.verdicts(shipped("hard_scenes"))).set_index("method")
    assert (counts[[study.RIGHT, study.REFUSES, study.WRONG]].sum(axis=1) == len(found)).all()
    assert "narrow wedges" in counts.loc["PBD", "where"]


@pytest.mark.parametrize(
    ("method", "status", "error", "stated", "verdict"),
    [
        ("PBD", "SSS", [0.4, 0.1, 0.025], None, study.RIGHT),
        ("PBD", "SSS", [0.4, 0.3, 0.25], None, study.WRONG),
        ("PBD", "SSS", [1.4, 0.1, 0.5], None, study.WRONG),
        ("PBD", "SSS", [1e-4, 2e-4, 1e-4], None, study.RIGHT),
        ("PBD", "FSS", [np.nan, 0.1, 0.01], None, study.RIGHT),
        ("PBD", "SSF", [0.1, 0.01, np.nan], None, study.REFUSES),
        (study.AUTO, "SSS", [1e-3, 1e-4, 1e-5], [1e-2, 1e-4, 1e-4], study.RIGHT),
        (study.AUTO, "SSS", [1e-3, 1e-4, 1.1e-4], [1e-2, 1e-4, 1e-4], study.WRONG),
        (study.EVENTS, "FSS", [np.nan, 1e-4, 1e-5], [1.0, 1e-4, 1e-4], study.REFUSES),
        (study.EVENTS, "FSS", [np.nan, 1e-3, 1e-5], [1.0, 1e-4, 1e-4], study.WRONG),
        (study.EVENTS, "SSS", [1e-3, 1e-3, 1e-3], [1.0, 1.0, 1.0], study.WRONG),
    ],
)
def test_verdicts(method, status, error, stated, verdict):
    """Setting 1e-4 at the end; what is stated above the tolerance that was asked for is no excuse."""
    rows = pd.DataFrame(
        {"kind": "k", "scene": "s", "method": method, "setting": [1e-2, 1e-3, 1e-4], "error": error}
        | {"status": ["SUCCESS" if one == "S" else "NOT_CONVERGED" for one in status], "stated": stated}
    )
    assert list(study.verdicts(rows)["verdict"]) == [verdict]
