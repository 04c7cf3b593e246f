"""The tutorial about types of cells: its notebook runs, and what its text says is so."""

from contextlib import chdir

import pytest

from tests.pages import ROOT, play

PAGE = ROOT / "docs" / "howto" / "cell_types.md"


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cell_types")
    with chdir(folder):
        yield play(PAGE, folder)


@pytest.mark.slow
def test_the_run_has_three_types(found):
    counts = found["counts"]
    assert counts.iloc[0].to_dict() == {"control": 30, "stiff": 6, "quick": 6, "leaving": 3}
    assert counts["quick"].iloc[-1] > 18
    assert (counts["leaving"] == 3).all()
    assert found["parameters"].type_names == ("control", "emt", "stiff", "quick", "leaving")


@pytest.mark.slow
def test_a_type_with_events_is_emt_cells(found):
    leaving = found["leaving"]
    assert leaving["emt"].tolist() == [0, 1, 2]
    assert leaving["events"].tolist() == ["AB"] * 3


@pytest.mark.slow
def test_the_study_knows_them(found):
    cells = found["results"].cells("slow")
    assert len(cells) == 3 * 16
    assert cells["t_b_h"].eq(6.0).all()
    assert cells["t_a_h"].between(2.0, 6.0).all()
