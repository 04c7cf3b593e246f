"""The tables of proofs that ship: bounds are reached, and no stated error is below the proved one."""

from verification.methods import proved
from verification.site.store import shipped


def test_all_bounds_are_reached() -> None:
    rows = shipped("proved_scenes")
    assert (rows["why"] == "").all()
    assert (rows["bound"] <= rows["asked"]).all()


def test_every_stated_error_is_above_the_proved_one() -> None:
    rows = shipped("proved_random")
    known = rows[rows["why"] == ""]
    assert rows["seed"].nunique() == proved.RANDOM
    assert known["seed"].nunique() >= 0.97 * proved.RANDOM
    assert (known["ratio"] <= 1).all()
    assert set(known["discs"]) == {2, 3, 4, 5, 6}
