"""The tutorial about sets that depend on time: its notebook runs, and what its text says is so."""

import numpy as np
import pytest

from tests.pages import ROOT, play

pytestmark = pytest.mark.slow


def test_the_page_runs_and_its_orders_are_those_of_the_methods(tmp_path):
    found = play(ROOT / "docs" / "howto" / "moving_sets.md", tmp_path)
    path, exact = found["path"], found["exact"]
    assert np.abs(path.x - exact(path.t)).max() <= path.error.max() <= 1e-9
    assert len(path.events) == 4
    slopes = found["orders"].fits.set_index(["method", "error"])["slope"]
    assert slopes[("PBD", "final")] == pytest.approx(1.0, abs=0.1)
    assert slopes[("midpoint catch-up", "final")] == pytest.approx(2.0, abs=0.3)
