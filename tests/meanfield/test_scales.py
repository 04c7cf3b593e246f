"""Problems of extreme scales: every run ends with a Status after a bounded number of steps."""

import numpy as np
import pytest

import meanfield
from meanfield import Density, Moments, State, Status
from meanfield.solvers import ode, pde
from meanfield.solvers.ode import WARM_UP_STEPS
from tests.borders.harness import holds_nan, limited

SEED = 20260119
SOLVERS = ("ode", "moments", "characteristics", "pde", "dae")
MODELS = {
    "straight": meanfield.StraightFibre,
    "linear": meanfield.LinearFibre,
    "wavy": meanfield.WavyFibre,
}


def solved(solver, model, size, speed, t, tol):
    """Run a solver from y = 1.2 ``size`` with three particles, or a uniform density on their interval."""
    y, v, X = [1.2 * size], [speed], size * np.array([[0.5], [1.0], [1.3]])
    start, density = State(X, y, v), lambda: Density.uniform(0.5 * size, 1.3 * size)
    runs = {
        "ode": lambda: meanfield.solve_ode(model, start, t, tol, throw=False),
        "moments": lambda: meanfield.solve_moments(
            model, Moments([size], [[1.3 * size**2]]), y, v, t, tol, throw=False
        ),
        "characteristics": lambda: meanfield.solve_characteristics(model, density(), y, v, t, tol, throw=False),
        "pde": lambda: meanfield.solve_pde(model, density(), y, v, t, cells=20, throw=False),
        "dae": lambda: meanfield.solve_dae(model, start, t, tol, throw=False),
    }
    return runs[solver]()


def fibre(name, **changes):
    return MODELS[name](**{"m": 0.5, "k0": 1.0, "k1": 0.5, "y_rest": 1.0, **changes})


@pytest.mark.slow_with("characteristics")
@pytest.mark.parametrize("solver", ["ode", "moments", "characteristics"])
@pytest.mark.parametrize(("stiffness", "end"), [(1.0, 1e10), (1e20, 1.0), (1e-60, 1e40)])
def test_hopeless_runs_end_after_hundreds_of_steps(solver, stiffness, end):
    model = fibre("linear", k0=stiffness, k1=stiffness / 2)
    result = solved(solver, model, 1.0, 0.0, [end / 1e20, end], 1e-6)
    assert result.status is Status.TOO_MANY_STEPS
    assert result.work.steps == WARM_UP_STEPS
    assert "at this rate" in result.detail
    assert not holds_nan(result)


@pytest.mark.parametrize(
    ("end", "status"), [(1e6, Status.TOO_MANY_STEPS), (1e10, Status.STEP_TOO_SMALL), (1e30, Status.STEP_TOO_SMALL)]
)
def test_hopeless_runs_on_a_grid_end_after_hundreds_of_steps(end, status):
    result = solved("pde", fibre("linear"), 1.0, 0.0, [end], 1e-6)
    assert result.status is status
    assert result.work.steps <= WARM_UP_STEPS
    assert len(result.t) == 0


def test_a_slow_beginning_does_not_end_the_run():
    """Test a particle repelled by a stiff wall: 100 of its 125 steps cover 1e-9 of the time."""
    model = meanfield.Model(g=lambda X, y: X - y, W0=lambda y: 1e10 * y**-10, W1=lambda X: 0 * X, m=1.0)
    run = meanfield.solve_ode(model, State([[0.0]], [1.0], [0.0]), [1e15], 1e-13)
    assert run.status is Status.SUCCESS
    assert 100 < run.work.steps < WARM_UP_STEPS
    assert run.v[-1, 0] == pytest.approx(1e5, rel=1e-9)


@pytest.mark.parametrize("solver", ["ode", "dae"])
def test_a_start_whose_rate_overflows_its_scale_ends(solver):
    model = fibre("straight", m=1.0, k0=3.5e75, k1=1.0, y_rest=2.5e-76)
    assert solved(solver, model, 8.7e97, 0.0, [1.6e-39], 1e-6).status is Status.STEP_TOO_SMALL


def heavy(m):
    """Build a model whose particles add the mass m to y along (1, 1) and nothing along (1, -1)."""
    energies = (lambda y: y[0] ** 2 + 2 * y[1] ** 2, lambda X: X**2)
    return meanfield.Model(lambda X, y: X - y[0] - y[1], *energies, m=m, ny=2)


LIGHT_START = State([[0.5]], [0.2, 0.3], [1.0, 0.0])


@pytest.mark.parametrize("m", [2.0**60, 1e30, 2.0**100])
def test_an_ill_conditioned_effective_mass_is_refused(m):
    """Test an effective mass whose entries all round to m: along (1, -1), the mass 1 of y is lost."""
    result = meanfield.solve_dae(heavy(m), LIGHT_START, [1.0], 1e-3, throw=False)
    assert result.status is Status.NON_FINITE
    assert not holds_nan(result)
    with pytest.raises(meanfield.InvalidModel, match="start: all forces of the model must be finite there"):
        meanfield.solve_ode(heavy(m), LIGHT_START, [1.0], 1e-3)
    with pytest.raises(meanfield.InvalidModel, match="start: all forces"):
        meanfield.solve_moments(heavy(m), Moments([0.5], [[1.0]]), [0.2, 0.3], [1.0, 0.0], [1.0], 1e-3)


def test_the_largest_accepted_mass_gives_an_accurate_motion():
    """Test that the motion along (1, -1) is the same for masses 1e9 and 1e13."""
    exact = meanfield.solve_ode(heavy(1e9), LIGHT_START, [1.0], 1e-12)
    found = meanfield.solve_ode(heavy(1e13), LIGHT_START, [1.0], 1e-10)
    assert found.y[-1] == pytest.approx(exact.y[-1], abs=1e-3)


def random_run(number):
    """Draw a solver and the arguments of a run: each scale is 1, or within ``decades`` of 1."""
    rng = np.random.default_rng((SEED, number))
    solver, decades = SOLVERS[number % len(SOLVERS)], rng.choice([3, 12, 60, 150, 300])
    names = sorted(MODELS) if solver != "moments" else ["linear", "straight"]
    scales = 10.0 ** np.where(rng.random(7) < 0.5, 0.0, rng.uniform(-decades, decades, 7))
    values = dict(zip(("m", "k0", "k1", "y_rest"), scales, strict=False))
    return solver, names[rng.integers(len(names))], values, scales[4], rng.integers(2) * scales[5], scales[6]


def complaint(number):
    """Return what is wrong with the end of a run; "" if it ended with a Status or was refused."""
    solver, name, values, size, speed, end = random_run(number)
    try:
        with limited():
            result = solved(solver, MODELS[name](**values), size, speed, [end], 1e-6)
    except meanfield.InvalidModel as error:
        return "" if str(error) else "refused without a message"
    return f"NaN of {random_run(number)}" if holds_nan(result) else ""


@pytest.mark.slow
def test_every_scale_ends(monkeypatch):
    monkeypatch.setattr(ode, "MAX_ODE_STEPS", 500)
    monkeypatch.setattr(pde, "MAX_GRID_STEPS", 500)
    assert [found for found in map(complaint, range(70)) if found] == []


@pytest.mark.xslow
def test_every_scale_of_many_ends():
    assert [found for found in map(complaint, range(70, 2000)) if found] == []
