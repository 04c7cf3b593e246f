"""The simplest description of particles: decided rightly where the bias is known, with and without draws."""

import math
import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import binom

import meanfield
from meanfield.solvers.motion import SolverWork

MODEL = meanfield.LinearFibre(m=0.5, k0=1.0, y_rest=1.0, k1=0.5)
DENSITY = meanfield.Density.bump(centre=1.0, radius=0.8)
SHIFT, END = 0.05, 2.0
# X_i = X_i(0) + y - y(0), so (1 + m) y'' = -k0 (y - 1) - k1 mean(X). Particles that start farther by SHIFT change y by
# u with (1 + m) u'' = -(k0 + k1) u - k1 SHIFT, u(0) = u'(0) = 0.
CHANGE = -0.5 * SHIFT / 1.5 * (1 - math.cos(math.sqrt(1.5 / 1.5) * END))


def shifted() -> meanfield.State:
    """Return quantiles of the density, moved until their mean is that of the density plus SHIFT."""
    X = DENSITY.quantiles(20)
    mean, _ = DENSITY.moments()
    return meanfield.State(X=X - X.mean() + mean + SHIFT, y=[1.2], v=[0.3])


@pytest.mark.slow
@pytest.mark.parametrize(("factor", "verdict"), [(1.001, "enough"), (0.999, "not enough")])
def test_a_known_bias_is_decided_rightly_on_both_sides_of_the_tolerance(factor: float, verdict: str) -> None:
    found = meanfield.simplify(MODEL, "y", factor * abs(CHANGE), shifted(), [END], 1e-9, density=DENSITY)
    rows = found.table[found.table["step"] == "alone"].set_index("model")
    # The bias is simpler minus full: the density has no shift.
    assert rows.loc["characteristics", "bias"] == pytest.approx(-CHANGE, rel=1e-6)
    assert rows.loc["characteristics", "verdict"] == verdict
    exact = ["ODE", "ODE, particles in closed form", "moments"]
    assert rows.loc[exact, "verdict"].tolist() == ["enough"] * len(exact)
    assert len(found.answer) == 1


@pytest.mark.slow
def test_the_distribution_has_no_moments_and_is_exact_for_characteristics() -> None:
    start = meanfield.State(X=DENSITY.quantiles(50), y=[1.2], v=[0.3])
    found = meanfield.simplify(MODEL, "density", 0.01, start, [0.5, END], 1e-8, density=DENSITY)
    rows = found.table[found.table["step"] == "alone"].set_index("model")
    assert rows.loc["moments", "verdict"] == "left out"
    # 50 quantiles of a density are apart from it by W1 = 0.0063; a linear fibre shifts both alike.
    away = meanfield.w1(DENSITY.quantiles(50), DENSITY)
    assert rows.loc["characteristics", "bias"] == pytest.approx(away, rel=1e-3)


def test_what_a_model_does_not_have_is_left_out_with_the_reason() -> None:
    wavy = meanfield.WavyFibre(m=0.5, k0=1.0, y_rest=1.0, k1=0.5)
    found = meanfield.simplify(wavy, "mean", 0.01, shifted(), [END], 1e-8)
    reasons = found.table[found.table["verdict"] == "left out"].set_index("model")["reason"]
    assert "closed form" in reasons["ODE, particles in closed form"]
    assert reasons["moments"] == "the moment equations do not close: Phi is not affine in X"
    assert reasons["PDE, 50 cells"] == "there is no density of the particles"
    assert found.answer == ("ODE",)


@pytest.mark.slow
def test_draws_decide_about_the_limit_of_many_particles() -> None:
    start = meanfield.State(X=DENSITY.quantiles(20), y=[1.2], v=[0.3])
    found = meanfield.simplify(MODEL, "y", 0.03, start, [END], 1e-8, density=DENSITY, runs=64, seed=4)
    rows = found.table[found.table["step"] == "alone"].set_index("model")
    flow, ode = rows.loc["characteristics"], rows.loc["ODE"]
    assert flow["verdict"] == ode["verdict"] == "enough"
    # The mean of 20 particles varies; the ODE has the same particles in each run.
    assert flow["high"] - flow["low"] > 1e-3 > 1e-6 > ode["high"] - ode["low"]
    again = meanfield.simplify(MODEL, "y", 0.03, start, [END], 1e-8, density=DENSITY, runs=64, seed=4)
    assert again.table["bias"].tolist()[:3] == found.table["bias"].tolist()[:3]


REPETITIONS, TOLERANCE = 200, 0.3
# With a probability of 5 % so many or fewer of the repetitions say "enough" in 999 of 1000 cases.
MOST = int(binom.ppf(0.999, REPETITIONS, 0.05))


@pytest.mark.slow
def test_a_bias_of_the_tolerance_is_seldom_called_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    module: Any = sys.modules["meanfield.simplify"]

    def full(task: Any, start: meanfield.State, tol: float, finer: int) -> SimpleNamespace:
        return SimpleNamespace(y=np.array([[np.asarray(start.X)[0, 0]]]), work=SolverWork(1, 1, 1))

    def biased(task: Any, start: meanfield.State, tol: float, finer: int) -> SimpleNamespace:
        x = float(np.asarray(start.X)[0, 0])
        # Another digit of the same draw: uniform noise of deviation 0.29, independent of x for all that matters.
        noise = 1e6 * abs(x) % 1.0 - 0.5
        return SimpleNamespace(y=np.array([[x + TOLERANCE + noise]]), work=SolverWork(1, 1, 1))

    monkeypatch.setattr(module, "_dae", full)
    monkeypatch.setattr(module, "DESCRIPTIONS", {"biased": module._Description(lambda _: "", biased)})
    start = meanfield.State(X=[[0.0]], y=[0.0], v=[0.0])
    normal = meanfield.Density.normal(0.0, 1.0)
    verdicts = [
        meanfield.simplify(MODEL, "y", TOLERANCE, start, [1.0], 1e-6, density=normal, runs=128, seed=seed).table[
            "verdict"
        ][0]
        for seed in range(REPETITIONS)
    ]
    assert verdicts.count("enough") <= MOST


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"quantity": "height"}, "quantity = 'height': must be one of y, v, mean, density"),
        ({"tolerance": -1.0}, r"tolerance = -1.0: must be a number above 0"),
        ({"runs": 100, "density": DENSITY}, "runs = 100: must be one of 64, 128"),
        ({"runs": 64}, "with a density to draw from"),
        ({"tol": 1.0}, "tol = 1: must be from"),
        ({"density": 3}, "density = 3: must be a meanfield.Density"),
    ],
)
def test_bad_input_gets_one_message(change: dict[str, Any], message: str) -> None:
    given = {"model": MODEL, "quantity": "y", "tolerance": 0.1, "start": shifted(), "t": [1.0], "tol": 1e-6} | change
    with pytest.raises(meanfield.InvalidModel, match=message):
        meanfield.simplify(**given)
