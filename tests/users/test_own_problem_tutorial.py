"""The tutorial about a problem of one's own: its notebook runs, and what its text says is so."""

import numpy as np
import pytest

from tests.pages import ROOT, play

pytestmark = pytest.mark.slow

PAGE = ROOT / "docs" / "tutorials" / "own_problem.md"


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """What the page leaves, and the folder that it writes into."""
    folder = tmp_path_factory.mktemp("tutorial")
    return play(PAGE, folder) | {"folder": folder}


def test_the_moving_wall_arrives_and_the_reference_knows_where(found):
    known = found["known"]
    assert known.error.max() <= 1e-11
    assert known.x[-1] == pytest.approx(np.array([[0.55, 0.3], [1.15, 0.3], [0.55, 0.9]]), abs=1e-9)


def test_the_orders_are_those_of_the_methods(found):
    fits = found["orders"].fits.set_index(["method", "error"])
    assert fits.loc[("PBD", "final"), "slope"] == pytest.approx(1.0, abs=0.15)
    assert (fits["failed"] == 0).all()


def test_a_foreign_program_stands_on_the_chart(found):
    table = found["chart"].table
    springs = table[table["method"] == "LSODA on springs"].sort_values("setting")
    assert (springs["status"] == "SUCCESS").all()
    assert springs["largest"].iloc[0] < 1e-3 < springs["largest"].iloc[-1]
    assert (springs["drift_evaluations"] > 300).all()


def test_the_map_shows_the_limit_of_the_springs(found):
    outcomes = found["penalties"].table.set_index(["dt", "pull"])["outcome"]
    assert outcomes[0.005, 0.5] == "bounded"
    assert set(outcomes[0.04]) == {"unstable"}
    # Near the limit springs ring: which places end infeasible depends on the last bits, that some do does not.
    assert set(outcomes[0.005]) == {"bounded"}
    assert "infeasible" in {*outcomes[0.01], *outcomes[0.02]}


def test_the_results_are_saved_with_a_page(found):
    folder = found["folder"] / "results" / "crowd"
    names = {f"{name}.{suffix}" for name in ("orders", "work_precision", "stability") for suffix in ("csv", "png")}
    assert {path.name for path in folder.iterdir()} >= names | {"index.html"}
