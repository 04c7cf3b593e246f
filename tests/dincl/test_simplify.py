"""The simplest method for a scene: decided rightly where the bias is known, and parts that a scene does not need."""

import math

import numpy as np
import pandas as pd
import pytest

import dincl

# Euler's method for x' = -x with ten steps to t = 1; with twenty the bias is about half of it.
EULER = 0.9**10 - math.exp(-1)


def decay() -> dincl.Problem:
    """Return x' = -x without constraints, x(0) = 1."""
    return dincl.Problem([[1.0]], lambda t, x: -x)


def alone(table: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of single parts, by name."""
    return table[table["step"] == "alone"].set_index("model")


def last(path: dincl.Trajectory) -> float:
    return float(path.final[0, 0])


@pytest.mark.parametrize(("factor", "verdict"), [(1.0001, "enough"), (0.9999, "not enough"), (1.0, "open")])
def test_a_known_bias_is_decided_rightly_on_both_sides_of_the_tolerance(factor: float, verdict: str) -> None:
    full, simpler = dincl.EventDriven(1e-7), {"Euler": dincl.PBD(0.1)}
    found = dincl.simplify(decay(), full, last, factor * abs(EULER), 1.0, simpler=simpler)
    row = found.table.iloc[0]
    assert row["verdict"] == verdict
    assert row["low"] <= EULER <= row["high"]
    assert row["high"] - row["low"] < 1e-6
    assert found.answer == (("Euler",) if verdict == "enough" else ())


def test_the_error_of_the_reference_covers_its_own_step() -> None:
    """The full method has a step of its own: the interval covers the bias against the exact solution."""
    found = dincl.simplify(decay(), dincl.PBD(0.05), last, 0.1, 1.0)
    rows = alone(found.table)
    for model, dt in (("dt twice as long", 0.1), ("dt four times as long", 0.2)):
        bias = (1 - dt) ** round(1 / dt) - math.exp(-1)
        assert rows.loc[model, "low"] <= bias <= rows.loc[model, "high"]
    assert rows.loc["dt twice as long", "work"] == pytest.approx(0.5)
    assert rows.loc["one sweep", "verdict"] == "left out"


def test_a_method_that_agrees_at_one_step_by_chance_is_not_enough() -> None:
    def quantity(path: dincl.Trajectory) -> float:
        return 0.0 if getattr(path.scheme, "dt", 0.0) in (0.0, 0.1) else 1.0

    found = dincl.simplify(decay(), dincl.EventDriven(1e-6), quantity, 0.5, 1.0, simpler={"Euler": dincl.PBD(0.1)})
    assert found.table.iloc[0][["bias", "verdict"]].tolist() == [1.0, "not enough"]


def test_inertia_matters_on_the_way_and_not_at_rest() -> None:
    """A disc of radius 0.5 falls by 0.5 onto the floor: t^2/2 with inertia and t without, and rests at height 0.5."""
    scene = dincl.Problem([[0.0, 1.0]], lambda t, x: np.array([[0.0, -1.0]]), [dincl.HalfSpace((0, 1), radius=0.5)])
    full = dincl.SecondOrderPBD(0.01)

    def height(path: dincl.Trajectory) -> float:
        return float(path.final[0, 1])

    on_the_way = alone(dincl.simplify(scene, full, height, 0.1, 0.4).table)
    assert on_the_way.loc["first order", "bias"] == pytest.approx(0.4**2 / 2 - 0.4, abs=2e-3)
    assert on_the_way.loc["first order", "verdict"] == "not enough"
    at_rest = dincl.simplify(scene, full, height, 1e-6, 3.0)
    assert "first order" in at_rest.answer
    assert "dt eight times as long" in at_rest.answer


@pytest.mark.slow
def test_four_discs_need_no_exact_projection() -> None:
    full = dincl.CatchUp(0.02, dincl.Ipopt(1e-10))
    found = dincl.simplify(dincl.scenes.four_disks(), full, None, 0.05, [1.0, 2.0])
    rows = alone(found.table)
    assert rows.loc[["linearised projection", "one sweep"], "verdict"].tolist() == ["enough", "enough"]
    assert "one sweep" in found.answer
    assert rows.loc["dt eight times as long", "bias"] > rows.loc["dt twice as long", "bias"] > 0


def test_a_method_that_fails_is_not_enough_and_says_why() -> None:
    scene, simpler = dincl.scenes.four_disks(), {"explosive": dincl.Penalty(0.1, 1e12)}
    found = dincl.simplify(scene, dincl.EventDriven(1e-6), None, 0.1, 1.0, simpler=simpler)
    assert found.table.iloc[0]["verdict"] == "not enough"
    assert np.isfinite(found.table["bias"].dropna()).all()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"tolerance": 0}, r"tolerance = 0: must be a number above 0"),
        ({"quantity": "height"}, r"quantity = 'height': must be a function of a Trajectory"),
        ({"quantity": lambda path: math.nan}, r"quantity = .*: must be finite"),
        ({"simpler": {}}, r"simpler = \{\}: must have one scheme or more"),
        ({"simpler": {"a": 3}}, r"simpler\['a'\] = 3: must be a scheme"),
        ({"scheme": dincl.EventDriven(1e-6)}, r"has no part to leave out: pass simpler"),
        ({"scheme": "PBD"}, r"scheme = 'PBD': must be a scheme with a step, or EventDriven\(tol\)"),
        ({"t": [2.0, 1.0]}, r"t = .*: must be one or more increasing times"),
    ],
)
def test_bad_input_gets_one_message(change: dict[str, object], message: str) -> None:
    given = {"problem": decay(), "scheme": dincl.PBD(0.1), "quantity": last, "tolerance": 0.1, "t": 1.0} | change
    with pytest.raises(dincl.InvalidProblem, match=message):
        dincl.simplify(**given)  # type: ignore[arg-type]
