"""The studies of the tissue, in the plane and in space, give what ships."""

import pytest

from verification.site.agreement import compare_studies
from verification.site.store import shipped
from verification.thesis.shipped_studies import STUDIES

NAMES = [name for name in STUDIES if name.startswith(("tissue_", "space_")) and STUDIES[name](smallest=True).runs]


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_the_smallest_form_gives_the_rows_that_ship(name):
    study, complete = STUDIES[name](smallest=True), shipped(name)
    rows = study.rows()
    assert set(rows) == set(complete)
    found = compare_studies(rows, complete, STUDIES[name](), study.by)
    assert found.rows == len(rows)
    assert found.apart == 0
