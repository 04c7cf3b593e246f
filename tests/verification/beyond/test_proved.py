"""The kept tables of proofs hold what proofs give, and no stated error is below the proved one."""

import numpy as np
import pytest

from verification.beyond.proved import proofs as proved
from verification.beyond.proved import random_scenes

pytestmark = pytest.mark.slow


def test_kept_bounds_are_those_of_proofs_made_again():
    kept = proved.table().set_index(["scene", "asked"])
    for case in proved.CASES:
        if case.title in ("Two discs", "A stack on a line"):
            again = proved.measure(case, 1e-12)
            row = kept.loc[(case.title, 1e-12)]
            assert again["bound"] == pytest.approx(row["bound"], rel=0.5)
            assert again["exponent"] == pytest.approx(row["exponent"], rel=0.05)


def test_all_bounds_are_reached_and_the_eigenvalue_is_sharper_than_sums():
    kept = proved.table()
    reached = kept[kept["why"] == ""]
    assert (reached["bound"] <= reached["asked"]).all()
    crowded = reached[reached["contacts"] > 10]
    assert (crowded["exponent"] < crowded["pointwise"]).all()
    assert (crowded["exponent"] < crowded["sum"]).all()
    # The least takes lambda = m; its midpoint rule is within a few per cent.
    assert (reached["exponent"] >= reached["least"] - 0.05 * np.abs(reached["least"]) - 1e-9).all()


def test_every_stated_error_is_above_the_proved_one():
    kept = random_scenes.table()
    known = kept[kept["why"] == ""]
    assert kept["seed"].nunique() == random_scenes.SCENES
    assert known["seed"].nunique() >= 0.97 * random_scenes.SCENES
    assert (known["ratio"] <= 1).all()
    assert set(known["discs"]) == {2, 3, 4, 5, 6}


@pytest.mark.parametrize("seed", [0, 7])
def test_a_random_scene_made_again_gives_the_kept_rows(seed):
    kept = random_scenes.table()
    mine = kept[kept["seed"] == seed].reset_index(drop=True)
    for row, again in zip(mine.itertuples(), random_scenes.measure(seed), strict=True):
        assert row.events == again["events"]
        assert again["stated"] == pytest.approx(row.stated, rel=1e-3)
        assert again["proved"] == pytest.approx(row.proved, rel=0.5, abs=1e-14)
