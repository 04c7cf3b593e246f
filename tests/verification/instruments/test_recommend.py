"""Recommendations: forecasts for methods of the package and of the user, with the reason why one is out."""

import numpy as np
import pytest

import dincl
import verification as v

T = [1.0, 2.0]
BUILT_IN = {"midpoint catch-up", "adaptive catch-up", "linearised catch-up", "PBD", "event-driven"}


@pytest.mark.parametrize(
    ("scene", "error"), [(dincl.scenes.four_disks(), 1e-4), (dincl.scenes.pile(12), 1e-3)], ids=["few", "pile"]
)
def test_settings_of_the_built_in_methods_have_the_error(scene, error):
    found = v.recommend(scene, error, T)
    rows = found.table.set_index("method")
    assert set(rows.index) == BUILT_IN
    assert (rows["why"] == "").all()
    assert (rows["cpu_seconds"] > 0).all()
    assert rows["cpu_seconds"].is_monotonic_increasing
    assert (rows["low"] <= rows["error"]).all()
    assert (rows["error"] <= rows["high"]).all()
    exact = dincl.solve(scene, dincl.EventDriven(1e-11), t=T).x
    projection = dincl.ActiveSet(1e-3 * error)
    schemes = {
        "PBD": dincl.PBD,
        "linearised catch-up": lambda dt: dincl.LinearisedCatchUp(dt, projection),
        "midpoint catch-up": lambda dt: dincl.MidpointCatchUp(dt, projection),
        "adaptive catch-up": dincl.AdaptiveCatchUp,
        "event-driven": dincl.EventDriven,
    }
    for label, row in rows.iterrows():
        states = dincl.solve(scene, schemes[label](row["setting"]), t=T).x
        off = np.linalg.norm(states - exact, axis=-1).max()
        assert off <= error
        assert row["low"] <= off <= row["high"]
    assert found.best == rows.index[0]
    assert found.best in repr(found)
    assert len(found.plot().patches) == len(rows)


def test_methods_of_the_user_and_why_one_is_out():
    scene = dincl.scenes.ten_disks_corner()
    exact = dincl.solve(scene, dincl.EventDriven(1e-11), t=T)
    methods = [
        v.Method("PBD", scheme=dincl.PBD),
        v.Method("too strong", scheme=lambda dt: dincl.Penalty(dt, strength=1e9)),
        v.Method("slow", scheme=lambda dt: dincl.PBD(dt / 1e6)),
        v.Method("refused", scheme=lambda dt: dincl.PBD(-dt)),
        v.Method("program", run=lambda problem, dt, t: exact.x + 0.1 * dt),
    ]
    table = v.recommend(scene, 1e-2, T, methods).table.set_index("method")
    assert set(table.index) == {method.label for method in methods}
    assert table.loc[["PBD", "program"], "why"].tolist() == ["", ""]
    assert not np.isfinite(table.loc[["too strong", "slow", "refused"], "cpu_seconds"]).any()
    assert "takes more than" in table.loc["slow", "why"]
    assert "dt = -" in table.loc["refused", "why"]
    assert table.loc["program", "setting"] <= 0.1
    assert v.recommend(scene, 1e-2, T, methods[2:4]).best == ""


@pytest.mark.slow
def test_an_error_that_no_short_run_has_is_extrapolated():
    scene, error = dincl.scenes.four_disks(), 1e-6
    methods = {"linearised": lambda dt: dincl.LinearisedCatchUp(dt, dincl.ActiveSet(1e-10))}
    row = v.recommend(scene, error, T, methods).table.iloc[0]
    path = dincl.solve(scene, methods["linearised"](row["setting"]), t=T)
    assert path.stats.drift_evaluations > row["drift_evaluations"]
    off = np.linalg.norm(path.x - dincl.solve(scene, dincl.EventDriven(1e-11), t=T).x, axis=-1).max()
    assert row["low"] <= off <= row["high"]
    assert off <= error


def test_without_a_reference_all_methods_are_out():
    late = dincl.Problem([[0.0, 0.0]], lambda t, x: -x if t < 0.5 else np.full_like(x, np.nan), [])
    found = v.recommend(late, 1e-3, [1.0])
    assert found.best == ""
    assert set(found.table["method"]) == BUILT_IN
    assert found.table["why"].str.startswith("there is no reference: Auto ended ").all()
    assert "none" in repr(found)


def test_bad_input_is_named():
    scene = dincl.scenes.sliding_disc()
    with pytest.raises(dincl.InvalidProblem, match=r"must be a dincl\.Problem"):
        v.recommend(3, 1e-3, [1.0])
    with pytest.raises(dincl.InvalidProblem, match="t = "):
        v.recommend(scene, 1e-3, [1.0, 0.5])
    with pytest.raises(dincl.InvalidProblem, match="error = -1"):
        v.recommend(scene, -1, [1.0])
