"""Derivatives of a model: against finite differences, CasADi's evaluation and each other."""

import casadi as ca
import numpy as np
import pytest

import meanfield
from meanfield.forces import acceleration, forces, pair_energy
from meanfield.kernels.field import MIN_INTERPOLATED
from meanfield.kernels.program import BLOCK, OPERATIONS, evaluated
from meanfield.model.symbolic import program
from tests.meanfield.models import EVERY, MODELS, start

STEP = 1e-5
FREE = {"W0": ca.sumsqr, "W1": ca.sumsqr}


def example(name):
    """Return a model, particles X, y, v and particle velocities."""
    model, state = MODELS[name], start(name, 6)
    return model, state.X, state.y, state.v, np.random.default_rng(3).normal(size=state.X.shape)


def slope(function, h=STEP):
    """Compute the derivative of a function of one number at 0, with an error of order h^4."""
    return (8 * (function(h) - function(-h)) - (function(2 * h) - function(-2 * h))) / (12 * h)


@pytest.mark.parametrize("name", EVERY)
def test_first_derivatives(name):
    model, X, y, v, U = example(name)
    gX, gy = model.jacobians(X, y)
    along = (gX @ U[..., None])[..., 0] + gy @ v
    np.testing.assert_allclose(along, slope(lambda h: model.level(X + h * U, y + h * v)), rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(
        -(U * model.F1(X)).sum(1), slope(lambda h: model.energy1(X + h * U)), rtol=1e-8, atol=1e-9
    )
    assert -v @ model.F0(y) == pytest.approx(slope(lambda h: model.energy0(y + h * v)), rel=1e-8)
    r = X - X[::-1] + 0.1
    np.testing.assert_allclose(
        (U * model.K(r)).sum(1), slope(lambda h: model.pair_energy(r + h * U)), rtol=1e-8, atol=1e-9
    )


@pytest.mark.parametrize("name", EVERY)
def test_second_derivatives(name):
    """Test that g is constant to third order along X + h Phi v + h^2/2 (Phi a + Omega), y + h v + h^2/2 a."""
    model, X, y, v, U = example(name)
    a = v[::-1] + 0.5
    first, second = model.phi(X, y) @ v, model.phi(X, y) @ a + model.omega(X, y, v)

    def residual(h):
        return np.abs(
            model.level(X + h * first + h**2 / 2 * second, y + h * v + h**2 / 2 * a) - model.level(X, y)
        ).max()

    assert residual(1e-3) < 1e-7
    det, rate = model.watched(X, y, U, v)[:2]
    np.testing.assert_allclose(det, np.linalg.det(model.jacobians(X, y)[0]), rtol=1e-13)
    along = slope(lambda h: np.linalg.det(model.jacobians(X + h * U, y + h * v)[0]))
    np.testing.assert_allclose(rate, along, rtol=1e-8, atol=1e-9)


@pytest.mark.parametrize(("name", "particles"), [*((name, 6) for name in MODELS), ("wavy", BLOCK + 5)])
def test_the_acceleration_is_that_of_the_sums(name, particles, rng):
    model, state = MODELS[name], start(name, particles)
    X, y, v = state.X, state.y, state.v
    weights = rng.dirichlet(np.ones(len(X)))
    phi = model.phi(X, y)
    pairs = np.array([weights @ model.K(X - x) for x in X])
    mass = np.eye(model.ny) + model.m * np.einsum("q,qab,qac->bc", weights, phi, phi)
    force = np.einsum("q,qab,qa->b", weights, phi, model.F1(X) + pairs - model.m * model.omega(X, y, v))
    found = acceleration(model, X, weights, y, v, 1.0)
    np.testing.assert_allclose(found, np.linalg.solve(mass, model.F0(y) + force), rtol=1e-11)


@pytest.mark.parametrize("particles", [40, MIN_INTERPOLATED + 60])
@pytest.mark.parametrize("name", ["attracting", "bending", "spatial", "kink"])
def test_sums_over_pairs_are_those_of_the_definition(name, particles, rng):
    """Test direct sums, interpolation (``attracting``), the mean (``spatial``), and a kernel without interpolation."""
    kink = meanfield.Model(g=lambda X, y: X - y, V=lambda r: ca.fabs(r) ** 3, **FREE)
    model, X = MODELS.get(name, kink), start("linear" if name == "kink" else name, particles).X
    w = rng.dirichlet(np.ones(particles))
    expected = np.array([w @ model.K(X - x) for x in X])
    energy = float(sum(s * (w @ model.pair_energy(X - x)) for s, x in zip(w, X, strict=True)))
    found = forces(model, X, w)
    np.testing.assert_allclose(found, expected, atol=1e-13)
    assert pair_energy(model, X, w) == pytest.approx(energy, abs=1e-13)
    np.testing.assert_allclose(w @ found, 0, atol=1e-13)  # action and reaction


def test_an_unbounded_kernel_is_refused():
    with pytest.raises(meanfield.InvalidModel, match=r"V = .*: must be finite, with V\(0\) = 0"):
        meanfield.Model(g=lambda X, y: X - y, V=lambda r: ca.log(r**2), **FREE)
    pointed = meanfield.Model(g=lambda X, y: X - y, V=lambda r: (r**2) ** 0.3, **FREE)  # has no force at 0
    with pytest.raises(RuntimeError, match="not finite"):
        forces(pointed, np.linspace(0, 1, 3)[:, None], np.full(3, 1 / 3))


def elementary(X):
    """List every operation that is translated, applied to numbers in its domain."""
    x, z = X[0], X[1]
    return [
        x + z, x - z, x * z, x / z, -x, x**2, 2 * x, 1 / x, ca.fabs(-x), x**z, x**1.7, ca.fmin(x, z), ca.fmax(x, z),
        ca.atan2(x, z), ca.exp(x), ca.log(x), ca.sin(x), ca.cos(x), ca.tan(x), ca.asin(x / 2),
        ca.acos(x / 2), ca.atan(x), ca.sinh(x), ca.cosh(x), ca.tanh(x),
        ca.sqrt(x), ca.sign(x - 1), ca.if_else(x < z, x, z),
        x <= z, x == z, x != z, ca.logic_and(x < 1, z < 1), ca.logic_or(x < 1, z < 1), ca.logic_not(x < 1),
    ]  # fmt: skip


def test_operations_against_casadi(rng):
    X = ca.SX.sym("X", 2)
    values = rng.uniform(0.2, 1.8, size=(BLOCK + 3, 2))
    outputs = ca.vertcat(*elementary(X))
    made = program(X, ca.SX(0, 1), ca.SX(0, 1), [outputs])
    found = evaluated(made, values, made.none, np.empty(0))
    np.testing.assert_allclose(found.T, ca.Function("f", [X], [outputs])(values.T).full(), rtol=1e-14)
    assert set(range(len(OPERATIONS))) - set(made.code[:, 0]) <= {0, 13, 14}  # assign, pow, constpow


def test_sines_of_all_sizes(rng):
    x = np.concatenate([rng.normal(size=(900, 1)) * 10.0 ** rng.uniform(-8, 9, (900, 1)), [[0.0], [-0.0], [np.inf]]])
    X = ca.SX.sym("X")
    found = evaluated(made := program(X, ca.SX(0, 1), ca.SX(0, 1), [ca.sin(X), ca.cos(X)]), x, made.none, np.empty(0))
    with np.errstate(invalid="ignore"):
        np.testing.assert_allclose(found, np.hstack([np.sin(x), np.cos(x)]), rtol=0, atol=3e-16)


def test_an_untranslatable_operation_is_refused():
    model = meanfield.Model(g=lambda X, y: X - y, W0=ca.erf, W1=lambda X: X**2)
    with pytest.raises(meanfield.InvalidModel, match="operation erf"):
        model.energy0([1.0])


def test_functions_are_callables_casadi_functions_or_expressions():
    X, y = ca.SX.sym("X"), ca.SX.sym("y")
    forms = [lambda X, y: X / y, ca.Function("g", [X, y], [X / y]), X / y, ca.SX.sym("X_0") / ca.SX.sym("y_0")]
    levels = [meanfield.Model(g=g, **FREE).level([[3.0]], [2.0]) for g in forms]
    assert levels == [[[1.5]]] * 4


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"m": 0.0}, "m = 0.0: must be a finite number > 0"),
        ({"m": np.nan}, "m = nan"),
        ({"nx": 4}, "nx = 4: must be an integer from 1 to 3"),
        ({"ny": True}, "ny = True"),
        ({"g": ca.vertcat}, "g has 2 components: must have 1"),
        ({"g": lambda X: X}, r"g\(X = .*, y = .*\) raised TypeError: .*must be built from CasADi operations"),
        ({"g": ca.SX.sym("z") - 1}, "g contains the symbol z: allowed are X, X_0, y, y_0"),
        ({"W1": str}, "W1"),
        ({"W0": lambda y: y.length}, "W0"),
        ({"V": lambda r: r**3}, r"V\(-r\) = V\(r\)"),
        ({"V": lambda r: r**2 + 1}, r"V\(0\) = 1"),
    ],
)
def test_bad_models(change, message):
    with pytest.raises(meanfield.InvalidModel, match=message):
        meanfield.Model(**{"g": lambda X, y: X - y, **FREE, **change})


def test_no_value_where_the_model_is_singular():
    for call in (MODELS["straight"].phi, MODELS["straight"].level):
        with pytest.raises(RuntimeError, match="full rank"):
            call([[1.0]], [0.0])
    with pytest.raises(meanfield.InvalidModel, match="between -1 and 1"):
        meanfield.WavyFibre(m=1.0, k0=1.0, y_rest=1.0, k1=1.0, amplitude=1.0)
