"""Random scenes, what is counted of ``Auto`` on them, and scenes with exact solutions that are hard for it."""

import numpy as np
import pandas as pd
import pytest

import dincl
from dincl.study import read_sealed
from verification.beyond.decisions import profile, promise, study
from verification.beyond.decisions.scenes import DRIFTS, LAYOUTS, SETS, scene
from verification.page.kept import STUDIES

PBD, EVENTS = "PBD", "event-driven"


def test_scenes_come_again_and_are_of_all_kinds() -> None:
    """Each start is feasible, or ``Problem`` would refuse it."""
    made = [scene(seed) for seed in study.FULL.seeds[:70]]
    np.testing.assert_array_equal(made[3].problem.x0, scene(study.FULL.seeds[3]).problem.x0)
    assert {one.drift for one in made} == set(DRIFTS)
    assert {one.layout for one in made} == set(LAYOUTS)
    assert {name for one in made for name in one.sets.split(", ")} == set(SETS)
    assert max(len(one.problem.x0) for one in made) > 200
    assert {one.problem.x0.shape[1] for one in made} == {1, 2, 3}
    assert all((np.diff(one.t) > 0).all() for one in made)


def row(seed: int, method: str, error: float, seconds: float, **others: object) -> dict[str, object]:
    """Return a run on a scene that asks for an error of 1e-3."""
    about = {"seed": seed, "particles": 3, "asked": 1e-3, "reference": 1e-6, "setting": 0.1, "status": "SUCCESS"}
    about |= {"took": "AdaptiveCatchUp", "stated": np.nan, "drift_evaluations": 7.0}
    return about | {"method": method, "error": error, "seconds": seconds} | others


def test_the_promise_of_auto_is_judged_against_what_is_true() -> None:
    """A right run, one whose stated error is too small, one that is wrong, and one that fails."""
    rows = [row(seed, study.MIDPOINT, 1e-4, 2.0) for seed in range(4)]
    rows += [row(seed, study.ADAPTIVE, 1e-4, 4.0) for seed in range(4)]
    rows += [row(seed, PBD, 1e-2, 0.1) for seed in range(4)]
    rows.append(row(0, study.AUTO, 5e-4, 6.0, stated=4.995e-4))  # within the error of the reference
    rows.append(row(1, study.AUTO, 5e-4, 8.0, stated=4.9e-4))
    rows.append(row(2, study.AUTO, 5e-3, 12.0, stated=5e-4))
    rows.append(row(3, study.AUTO, np.inf, 1.0, status="NOT_CONVERGED"))
    rows.append(row(4, study.NO_REFERENCE, np.nan, np.nan, status=""))
    judged = promise.judged(pd.DataFrame(rows))
    assert judged["seed"].tolist() == [0, 1, 2, 3]
    assert judged["error"].tolist() == [0.5, 0.5, 5.0, np.inf]
    assert judged["stated"].tolist() == [True, False, False, False]
    kept = promise.kept(judged)
    assert kept[["count", "of"]].to_numpy().tolist() == [[2, 4], [2, 3], [1, 3], [1, 3]]
    assert (kept["low"] < kept["share"]).all()
    assert (kept["share"] < kept["high"]).all()
    costs = promise.costs(judged)
    assert costs["scenes"].tolist() == [3, 3, 3]
    assert costs["median"].tolist() == [4.0, 4.0, 2.0]
    assert costs["most"].tolist() == pytest.approx([5.6, 5.6, 2.8])


def test_a_profile_counts_who_is_the_cheapest_who_ties_and_who_fails() -> None:
    """Three scenes: PBD alone the cheapest, a tie, and one that only the event-driven scheme solves."""
    rows = []
    for seed, seconds in enumerate([(1.0, 2.0, np.inf), (1.0, 1.2, 3.0), (np.inf, np.inf, 1.0)]):
        for name, cost in zip((PBD, study.MIDPOINT, EVENTS), seconds, strict=True):
            rows.append(row(seed, name, 1e-4 if np.isfinite(cost) else 1.0, min(cost, 9.0)))
    rows.append(row(3, study.NO_REFERENCE, np.nan, np.nan, status=""))
    found = profile.shares(pd.DataFrame(rows)).set_index(["cost", "error", "method"]).sort_index()
    mine = found.loc["CPU time", "10⁻⁴ to 10⁻³"]
    assert (mine["scenes"] == 3).all()
    assert mine.loc[PBD, ["alone", "1.25", "reached"]].tolist() == pytest.approx([1 / 3, 2 / 3, 2 / 3])
    assert mine.loc[study.MIDPOINT, ["alone", "1.25", "2"]].tolist() == pytest.approx([0, 1 / 3, 2 / 3])
    assert mine.loc[EVENTS, ["alone", "1.25", "10"]].tolist() == pytest.approx([1 / 3, 1 / 3, 2 / 3])
    assert mine.loc[study.ADAPTIVE, "reached"] == 0
    counted = found.loc["evaluations of the drift", "10⁻⁴ to 10⁻³"]
    assert (counted["1.25"] == counted["reached"]).all()
    assert found.loc["CPU time", "10⁻⁵ to 10⁻⁴"]["scenes"].tolist() == [0, 0, 0, 0, 0]


@pytest.mark.slow
def test_a_scene_is_run_by_all_methods() -> None:
    rows = pd.DataFrame(study.run({"seed": 3}))
    assert set(rows["method"]) == {*profile.LOOKS, study.AUTO}
    auto = rows[rows["method"] == study.AUTO].iloc[0]
    assert auto["error"] <= auto["stated"] <= auto["asked"]
    for _, runs in rows[rows["method"] != study.AUTO].groupby("method"):
        assert runs["error"].iloc[-1] <= auto["asked"]
        assert runs["drift_evaluations"].notna().all()


@pytest.mark.slow
def test_auto_keeps_the_error_on_the_kept_scenes() -> None:
    judged = promise.judged(read_sealed(STUDIES / "decisions.parquet"))
    assert len(judged) >= 0.9 * len(study.FULL.seeds)
    right, _, stated, beyond = promise.kept(judged).itertuples()
    assert right.share >= promise.WANTED["right"]
    assert stated.share >= promise.WANTED["stated"]
    assert beyond.count == 0


def meeting(radius: float, d: int) -> tuple[dincl.Problem, list[float], np.ndarray]:
    """Return two discs that run into each other at speed 1, and where they stay."""
    along = np.eye(d)[0]
    drift = dincl.drifts.constant([along, -along])
    problem = dincl.Problem([-0.5 * along, 0.47 * along], drift, [dincl.NonOverlap(radius)])
    return problem, [1.0], np.array([[(-0.015 - radius) * along, (-0.015 + radius) * along]])


def wedge(angle: float) -> tuple[dincl.Problem, list[float], np.ndarray]:
    """Return a point that falls to the apex of a wedge with this half angle."""
    walls = [dincl.HalfSpace((side * np.cos(angle), np.sin(angle))) for side in (1, -1)]
    problem = dincl.Problem([[0.0, 1.0]], dincl.drifts.constant((0.0, -1.0)), walls)
    return problem, [0.3, 1.0, 3.0], np.array([[[0.0, 0.7]], [[0.0, 0.0]], [[0.0, 0.0]]])


def tiny(d: int) -> tuple[dincl.Problem, list[float], np.ndarray]:
    """Return seven discs of radii 3e-9 to 3e-3 that run into each other, and their event-driven solution."""
    rng, radii = np.random.default_rng(7), 3 * 10.0 ** np.arange(-9, -2)
    x0 = np.column_stack((np.linspace(-0.5, 0.5, 7), *(0.5 * radii * rng.uniform(-1, 1, (d - 1, 7)))))
    drift = dincl.drifts.constant(np.outer(-np.sign(x0[:, 0]) * rng.uniform(0.5, 1.0, 7), np.eye(d)[0]))
    problem, t = dincl.Problem(x0, drift, [dincl.NonOverlap(rng.permutation(radii))]), [0.5, 1.0]
    return problem, t, dincl.solve(problem, dincl.EventDriven(1e-7), t).x


@pytest.mark.slow
@pytest.mark.parametrize("error", [1e-2, 1e-3])
@pytest.mark.parametrize(
    ("make", "arguments"),
    [
        *((meeting, (radius, d)) for d in (1, 2) for radius in (1e-1, 1e-2, 1e-3, 1e-4)),
        *((wedge, (angle,)) for angle in (1e-1, 1e-2, 1e-3, 1e-4, 1e-6)),
        *((tiny, (d,)) for d in (1, 2)),
    ],
)
def test_auto_states_its_error_where_steps_could_jump_over_a_set(make, arguments, error) -> None:
    problem, t, exact = make(*arguments)
    path = dincl.solve(problem, dincl.Auto(error), t, throw=False)
    assert path.status, path.status
    assert path.error is not None
    off = np.linalg.norm(path.x - exact, axis=2).max(axis=1)
    assert (off <= path.error + 1e-7).all()
    assert off.max() <= error
