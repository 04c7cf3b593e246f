"""RATTLE and its compositions: orders, constraints to rounding, reversibility, energy, and failures."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from meanfield import (
    InvalidModel,
    Model,
    SolveFailed,
    State,
    Status,
    StraightFibre,
    TissueElement,
    WavyFibre,
    solve_dae,
    solve_rattle,
)
from meanfield.solvers.rattle import SUBSTEPS
from tests.meanfield.exact import CLOSED, FIBRE, PLAIN, element_start, fibre_start, start_of, worst

if TYPE_CHECKING:
    from meanfield import Motion

WAVY = WavyFibre(**FIBRE)
TIMES = np.array([0.0, 1.0, 2.0])
MODELS = {"wavy": WAVY, "askew": PLAIN["askew"][0]()}
# Steps for which the error is far above rounding.
STEPS = {2: 0.1, 4: 0.2, 6: 0.25, 8: 0.5}


@cache
def reference(name: str) -> Motion:
    return solve_dae(MODELS[name], start_of(name, 5), TIMES, 1e-12)


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("order", SUBSTEPS)
def test_order_of_positions_velocities_and_multipliers(order: int, name: str) -> None:
    dt = STEPS[order]
    errors = [
        worst(solve_rattle(MODELS[name], start_of(name, 5), TIMES, step, order), reference(name))
        for step in (dt, dt / 2)
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.2)


@pytest.mark.parametrize("name", CLOSED)
def test_agrees_with_the_closed_form(name: str) -> None:
    make, closed = CLOSED[name]
    motion = solve_rattle(make(**FIBRE), fibre_start(20), TIMES, 0.1, 8)
    assert worst(motion, closed(fibre_start(20), TIMES)) < 1e-12


def test_agrees_with_idas_in_the_plane() -> None:
    model = TissueElement(m=0.7, k0=1.2, y_rest=[1.0, 1.1, 0.1], k1=0.4)
    motion, reference = (
        solve_rattle(model, element_start(4), TIMES, 0.1, 6),
        solve_dae(model, element_start(4), TIMES, 1e-11),
    )
    assert worst(motion, reference) < 1e-8


@pytest.mark.parametrize("order", SUBSTEPS)
def test_substeps_are_a_symmetric_division_of_the_step(order: int) -> None:
    lengths = SUBSTEPS[order]
    assert sum(lengths) == pytest.approx(1, abs=1e-15)
    assert lengths == lengths[::-1]
    assert len(lengths) == {2: 1, 4: 5, 6: 9, 8: 17}[order]


@pytest.mark.parametrize("order", [2, 6])
def test_is_time_reversible(order: int) -> None:
    there = solve_rattle(WAVY, fibre_start(5), [2.0], 0.1, order).state(0)
    turned = State(X=there.X, y=there.y, v=-np.asarray(there.v), U=-np.asarray(there.U), level=there.level)
    back = solve_rattle(WAVY, turned, [2.0], 0.1, order)
    assert back.X[0] == pytest.approx(fibre_start(5).X, abs=1e-13)
    assert back.v[0] == pytest.approx(-np.asarray(fibre_start(5).v), abs=1e-13)


def test_long_run_keeps_the_constraint_and_the_mean_energy() -> None:
    t = np.arange(1.0, 81.0)
    motion = solve_rattle(WAVY, fibre_start(3), t, 0.25)
    assert motion.constraint_drift().max() < 2e-15
    assert motion.velocity_drift().max() < 2e-15
    error = motion.energy() - motion.energy()[0]
    assert 1e-5 < np.ptp(error) < 1e-2
    assert abs(error[:40].mean() - error[40:].mean()) < 0.05 * np.ptp(error)


def test_steps_are_equal_and_at_most_dt() -> None:
    motion = solve_rattle(WAVY, fibre_start(2), [0.0, 0.3, 0.6, 1.0], 0.1)
    assert motion.work.steps == 10
    assert solve_rattle(WAVY, fibre_start(2), [0.1 + 0.2], 0.1).work.steps == 3  # though 0.1 + 0.2 > 3 * 0.1
    assert motion.t.tolist() == [0.0, 0.3, 0.6, 1.0]
    assert solve_rattle(WAVY, fibre_start(2), [0.35], 0.1).work.steps == 4


def test_newton_starts_from_the_last_multipliers() -> None:
    work = solve_rattle(WAVY, fibre_start(5), [10.0], 0.05).work
    assert work.newton <= 2.1 * work.steps


FOLD = Model(g=lambda X, y: X + X**3 / 3 - X**5 / 5 - y, W0=lambda y: -2 * y, W1=lambda X: 0 * X)
BLOW_UP = Model(g=lambda X, y: X - y, W0=lambda y: -(y**4), W1=lambda X: 0 * X)


@pytest.mark.parametrize(
    ("model", "start", "status"),
    [
        (StraightFibre(m=1.0, k0=1.0, y_rest=-1.0, k1=0.5), fibre_start(3), Status.SINGULAR),
        (FOLD, State(X=[[0.1], [0.3]], y=[0.2], v=[0.5]), Status.SINGULAR),
        (BLOW_UP, State(X=[[0.5]], y=[1.0], v=[0.0]), Status.NON_FINITE),
    ],
)
def test_a_failed_run_returns_the_output_times_reached(model: Model, start: State, status: Status) -> None:
    t = [0.1, 0.2, 30.0]
    motion = solve_rattle(model, start, t, 0.05, throw=False)
    assert motion.status is status
    assert "after t = " in motion.detail
    assert motion.t.tolist() == [0.1, 0.2]
    assert np.isfinite(motion.multipliers).all()
    with pytest.raises(SolveFailed) as caught:
        solve_rattle(model, start, t, 0.05)
    assert (caught.value.result.X == motion.X).all()


def test_a_step_too_long_for_the_constraint_and_the_remedy() -> None:
    rough = WavyFibre(**FIBRE, amplitude=0.99)
    bumpy = Model(g=lambda X, y: rough.g(20 * X, 20 * y), W0=lambda y: 0 * y, W1=lambda X: 0 * X)
    start = State(X=[[0.1], [0.2], [0.3]], y=[0.5], v=[1.0])
    motion = solve_rattle(bumpy, start, [0.0, 1.0], 1.0, throw=False)
    assert (motion.status, len(motion.t)) == (Status.NOT_CONVERGED, 1)
    assert solve_rattle(bumpy, start, [0.0, 1.0], 0.01).status


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"dt": 0.0}, "dt = 0.0: must be"),
        ({"dt": 1e-9}, "dt = 1e-09: must be at least"),
        ({"order": 3}, "order = 3: must be one of 2, 4, 6, 8"),
        ({"order": [2]}, "order = .*: must be an integer"),
        ({"t": [0.0]}, "t = .*last one > 0"),
        ({"start": element_start(2)}, "X of shape"),
        ({"start": State(X=[[1.0]], y=[1.0], v=[0.5], U=[[0.1]])}, "must satisfy the constraint"),
    ],
)
def test_refuses_invalid_input(change: dict[str, Any], message: str) -> None:
    given: dict[str, Any] = {"start": fibre_start(2), "t": [1.0], "dt": 0.1} | change
    with pytest.raises(InvalidModel, match=message):
        solve_rattle(WAVY, **given)
