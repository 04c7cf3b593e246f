"""The tutorial about a force of one's own: its notebook runs, and what its text says is so."""

import re

import pytest

import tissue
from dincl.errors import InvalidProblem
from tests.pages import ROOT, play
from tissue.plugins import registry
from verification.thesis.quasi_steady.run import simulate_quasi_steady

pytestmark = pytest.mark.slow

PAGE = ROOT / "docs" / "tutorials" / "own_force.md"
TEXT = PAGE.read_text("utf-8")


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """What the page leaves; at the end nothing is registered."""
    yield play(PAGE, tmp_path_factory.mktemp("own_force"))
    registry(tissue.Force).clear()


def test_the_force_is_right_and_a_wrong_sign_is_seen(found):
    assert found["error"] < 1e-6
    wrong = tissue.Force("shell", pull, "", "", found["SHELL"].energy)
    assert tissue.force_error(wrong, found["free"]) == pytest.approx(2.0, rel=1e-6)


def test_the_table_is_what_comes_out(found):
    rows = re.findall(r"^\| ([\d.]+) \| ([\d.]+) \| ([\d.]+) \|$", TEXT, flags=re.MULTILINE)
    table = {float(strength): float(height) for strength, height, _ in rows}
    assert table == pytest.approx(found["heights"], abs=0.3)
    areas = {float(strength): float(height) * float(width) for strength, height, width in rows}
    assert areas[1.0] / areas[0.0] == pytest.approx(0.88, abs=0.01)


def test_the_limit_of_the_strength(found):
    numbers = found["parameters"].numbers()
    assert numbers.dt / numbers.substeps / numbers.mu == pytest.approx(1 / 160)


def test_the_quasi_steady_model_refuses_it(found):
    with pytest.raises(InvalidProblem, match=r"forces.shell = 1: must be 0, the quasi-steady model does not know it"):
        simulate_quasi_steady(found["parameters"])


def pull(store, on, strength, numbers):
    for i in range(store.sizes[0]):
        on.y[i] += strength * max(0.0, store.cells.y[i] - 8.0)
        on.ay[i] += strength * max(0.0, store.cells.ay[i] - 8.0)
