"""A budget ends a run in machine code as it ends any other, and counts the same work."""

import numba
import numpy as np
import pytest

import dincl
import verification as v
from verification.instruments.budget import OutOfBudgetError, counted
from verification.instruments.measure import measure

SCENE = dincl.scenes.ten_disks_corner()
T = np.array([1.0, 2.0])
SCHEMES = {
    "linearised": lambda: dincl.LinearisedCatchUp(1e-3, dincl.ActiveSet(1e-12)),
    "catch-up": lambda: dincl.CatchUp(1e-3, dincl.ActiveSet(1e-12)),
    "midpoint": lambda: dincl.MidpointCatchUp(1e-3, dincl.ActiveSet(1e-9)),
    "events": lambda: dincl.EventDriven(1e-12),
}


@numba.njit
def falling(t, x):
    out = np.zeros_like(x)
    out[:, 1] = -1.0
    return out


DRIFTS = {"ready-made": SCENE.drift, "numba": falling, "Python": lambda t, x: falling(t, np.array(x))}


@pytest.mark.parametrize("drift", DRIFTS)
@pytest.mark.parametrize("name", SCHEMES)
def test_a_run_is_stopped_by_its_count_of_evaluations(name, drift):
    problem = dincl.Problem(SCENE.x0, DRIFTS[drift], SCENE.constraints)
    watched, whole = counted(problem, None)
    path = dincl.solve(watched, SCHEMES[name](), t=T)
    assert whole.evaluations == path.stats.drift_evaluations
    watched, part = counted(problem, v.DriftEvaluations(whole.evaluations // 4))
    with pytest.raises(OutOfBudgetError):
        dincl.solve(watched, SCHEMES[name](), t=T, throw=False)
    assert whole.evaluations // 4 < part.evaluations < whole.evaluations


@pytest.mark.slow_with("events")
@pytest.mark.parametrize(
    ("scheme", "setting", "scene"),
    [
        (lambda dt: dincl.CatchUp(dt, dincl.ActiveSet(1e-12)), 1e-8, SCENE),
        (dincl.EventDriven, 1e-12, dincl.scenes.pile(200)),
    ],
    ids=["catch-up", "events"],
)
def test_a_compiled_run_is_stopped_by_cpu_time(scheme, setting, scene):
    """The first one would take many minutes, the other one ten seconds."""
    known = v.Known(T, np.zeros((2, *scene.x0.shape)), np.zeros(2))
    rows = measure(scene, v.Method("compiled", scheme=scheme), (setting,), known, ("final",), v.CpuSeconds(0.05))
    assert [row["status"] for row in rows] == ["OUT_OF_BUDGET"]
