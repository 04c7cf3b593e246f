"""Problems of extreme scales: a run ends with a Status after counted work, however many periods it was to last."""

import numpy as np
import pytest

import meanfield
from dincl.errors import StepFailure
from meanfield import Density, Moments, State, Status
from meanfield.solvers import integrate
from meanfield.solvers.grid import run as grid_run
from meanfield.solvers.pace import UNJUDGED, check_pace
from tests.borders.harness import holds_nan, limited

SEED = 20260119
SOLVERS = ("ode", "reduced", "moments", "characteristics", "pde", "rattle", "dae")
MODELS = {
    "straight": meanfield.StraightFibre,
    "linear": meanfield.LinearFibre,
    "wavy": meanfield.WavyFibre,
}


def solved(solver, model, size, speed, t, tol):
    """A run of three particles, or of their hull, from 1.2 ``size``."""
    y, v, X = [1.2 * size], [speed], size * np.array([[0.5], [1.0], [1.3]])
    start, density = State(X, y, v), lambda: Density.uniform(0.5 * size, 1.3 * size)
    runs = {
        "ode": lambda: meanfield.solve_ode(model, start, t, tol, throw=False),
        "reduced": lambda: meanfield.solve_ode(meanfield.reduce(model), start, t, tol, throw=False),
        "moments": lambda: meanfield.solve_moments(
            model, Moments([size], [[1.3 * size**2]]), y, v, t, tol, throw=False
        ),
        "characteristics": lambda: meanfield.solve_characteristics(model, density(), y, v, t, tol, throw=False),
        "pde": lambda: meanfield.solve_pde(model, density(), y, v, t, cells=20, throw=False),
        "rattle": lambda: meanfield.solve_rattle(model, start, t, t[-1] / 100, throw=False),
        "dae": lambda: meanfield.solve_dae(model, start, t, tol, throw=False),
    }
    return runs[solver]()


def fibre(name, **changes):
    return MODELS[name](**{"m": 0.5, "k0": 1.0, "k1": 0.5, "y_rest": 1.0, **changes})


@pytest.mark.parametrize("solver", ["ode", "reduced", "moments", "characteristics"])
@pytest.mark.parametrize(("stiffness", "end"), [(1.0, 1e10), (1e20, 1.0), (1e-60, 1e40)])
def test_hopeless_runs_end_after_hundreds_of_steps(solver, stiffness, end):
    model = fibre("linear", k0=stiffness, k1=stiffness / 2)
    result = solved(solver, model, 1.0, 0.0, [end / 1e20, end], 1e-6)
    assert result.status is Status.TOO_MANY_STEPS
    assert result.work.steps == UNJUDGED
    assert "at this pace" in result.detail
    assert not holds_nan(result)


@pytest.mark.parametrize(
    ("end", "status"), [(1e6, Status.TOO_MANY_STEPS), (1e10, Status.STEP_TOO_SMALL), (1e30, Status.STEP_TOO_SMALL)]
)
def test_hopeless_runs_on_a_grid_end_after_hundreds_of_steps(end, status):
    result = solved("pde", fibre("linear"), 1.0, 0.0, [end], 1e-6)
    assert result.status is status
    assert result.work.steps <= UNJUDGED
    assert len(result.t) == 0


@pytest.mark.parametrize(
    ("steps", "reached", "ends"),
    [
        (UNJUDGED - 1, 0.0, False),
        (UNJUDGED, 0.0, True),
        (1_000, 0.99e-4, True),
        (1_000, 1.01e-4, False),
        (50_000, 0.24, True),
        (50_000, 0.26, False),
        (99_999, 0.99999, False),
        (100_000, 0.99999, True),
    ],
)
def test_a_run_may_still_become_faster(steps, reached, ends):
    """After one in a hundred of the steps hundred times as fast as before, after all of them no faster."""
    if not ends:
        check_pace(steps, 100_000, 3.0 * reached, 3.0)
        return
    whole = f"{steps / reached:.1e}".replace("+", r"\+") if reached else "infinitely many"
    with pytest.raises(
        StepFailure, match=rf"{steps} steps until t = .*; at this pace {whole}, and 100000 are"
    ) as caught:
        check_pace(steps, 100_000, 3.0 * reached, 3.0)
    assert caught.value.status is Status.TOO_MANY_STEPS


def test_a_slow_beginning_is_no_reason_to_end():
    """A particle is repelled by a stiff wall, which takes 100 of its 125 steps and one in 10^9 of its time."""
    model = meanfield.Model(g=lambda X, y: X - y, W0=lambda y: 1e10 * y**-10, W1=lambda X: 0 * X, m=1.0)
    run = meanfield.solve_ode(model, State([[0.0]], [1.0], [0.0]), [1e15], 1e-13)
    assert run.status is Status.SUCCESS
    assert 100 < run.work.steps < UNJUDGED
    assert run.v[-1, 0] == pytest.approx(1e5, rel=1e-9)


def heavy(m):
    """A model whose particles weigh m on y along (1, 1) and nothing along (1, -1)."""
    energies = (lambda y: y[0] ** 2 + 2 * y[1] ** 2, lambda X: X**2)
    return meanfield.Model(lambda X, y: X - y[0] - y[1], *energies, m=m, ny=2)


LIGHT_START = State([[0.5]], [0.2, 0.3], [1.0, 0.0])


@pytest.mark.parametrize("m", [2.0**60, 1e30, 2.0**100])
def test_a_mass_that_hides_that_of_y_is_no_answer(m):
    """All entries of the effective mass are m: its inverse has the rounding of 1e-16 in place of 1 along (1, -1)."""
    for solve in (meanfield.solve_dae, meanfield.solve_rattle):
        result = solve(heavy(m), LIGHT_START, [1.0], 1e-3, throw=False)
        assert result.status is Status.NON_FINITE
        assert not holds_nan(result)
    with pytest.raises(meanfield.InvalidModel, match="the start: must be where all forces of the model are finite"):
        meanfield.solve_ode(heavy(m), LIGHT_START, [1.0], 1e-3)
    with pytest.raises(meanfield.InvalidModel, match="y0 = "):
        meanfield.solve_moments(heavy(m), Moments([0.5], [[1.0]]), [0.2, 0.3], [1.0, 0.0], [1.0], 1e-3)


def test_the_heaviest_mass_that_is_served_is_right():
    """y1 + y2 drifts, and y moves along (1, -1) as beside a mass of 1e9."""
    exact = meanfield.solve_ode(heavy(1e9), LIGHT_START, [1.0], 1e-12)
    found = meanfield.solve_ode(heavy(1e13), LIGHT_START, [1.0], 1e-10)
    assert found.y[-1] == pytest.approx(exact.y[-1], abs=1e-3)


def drawn(number):
    """A solver and the arguments of a run: each scale is 1 or within ``decades`` of it."""
    rng = np.random.default_rng((SEED, number))
    solver, decades = SOLVERS[number % len(SOLVERS)], rng.choice([3, 12, 60, 150, 300])
    names = sorted(MODELS) if solver not in ("reduced", "moments") else ["linear", "straight"]
    scales = 10.0 ** np.where(rng.random(7) < 0.5, 0.0, rng.uniform(-decades, decades, 7))
    values = dict(zip(("m", "k0", "k1", "y_rest"), scales, strict=False))
    return solver, names[rng.integers(len(names))], values, scales[4], rng.integers(2) * scales[5], scales[6]


def complaint(number):
    """What is wrong with how a run ended; nothing if it ended with a Status or was refused."""
    solver, name, values, size, speed, end = drawn(number)
    try:
        with limited():
            result = solved(solver, MODELS[name](**values), size, speed, [end], 1e-6)
    except meanfield.InvalidModel as error:
        return "" if str(error) else "refused without a message"
    return f"NaN of {drawn(number)}" if holds_nan(result) else ""


@pytest.mark.slow
def test_every_scale_ends(monkeypatch):
    for module in (integrate, grid_run):
        monkeypatch.setattr(module, "MOST_STEPS", 500)
    assert [found for found in map(complaint, range(70)) if found] == []


@pytest.mark.xslow
def test_every_scale_ends_often():
    assert [found for found in map(complaint, range(70, 2000)) if found] == []
