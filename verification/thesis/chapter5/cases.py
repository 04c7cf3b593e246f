"""The models, densities and starts that the studies of the mean-field chapter share, and motions in closed form."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meanfield import Density, LinearFibre, Model, State, StraightFibre, TissueElement, WavyFibre
from meanfield.model.symbolic import library

Floats = NDArray[np.float64]
FIBRE = {"m": 1.0, "k0": 1.0, "y_rest": 1.5, "k1": 0.5}
# Number of each stream of random numbers.
STREAMS = {"start": 1, "pairs": 3}


@dataclass(frozen=True)
class MotionCase:
    """A model, the density its particles start with, y(0) and y'(0)."""

    title: str
    made: Callable[[], Model]
    law: Callable[[], Density]
    y0: tuple[float, ...] = (1.0,)
    v0: tuple[float, ...] = (0.5,)


def _line() -> Density:
    return Density.bump(1.0, 0.6)


def _cube() -> Model:
    """Return g = diag(y)^{-1} X in space: a block stretched along its axes."""
    return Model(
        g=lambda X, y: X / y,
        W0=lambda y: ((y - 1.2) ** 2)[0] / 2 + ((y - 1.0) ** 2)[1] / 2 + ((y - 0.9) ** 2)[2] / 2,
        W1=lambda X: FIBRE["k1"] / 2 * library().sumsqr(X),
        nx=3,
        ny=3,
    )


CASES = {
    "straight": MotionCase("StraightFibre", lambda: StraightFibre(**FIBRE), _line),
    "linear": MotionCase("LinearFibre", lambda: LinearFibre(**FIBRE), _line),
    "wavy": MotionCase("WavyFibre", lambda: WavyFibre(**FIBRE), _line),
    "element": MotionCase(
        "TissueElement",
        lambda: TissueElement(m=1.0, k0=1.0, y_rest=(1.2, 1.0, 0.1), k1=0.5),
        lambda: Density.bump([0.6, 0.4], 0.4),
        (1.0, 1.1, 0.1),
        (0.3, -0.2, 0.1),
    ),
    "uniform": MotionCase("uniform StraightFibre", lambda: StraightFibre(**FIBRE), lambda: Density.uniform(0.4, 1.6)),
    "cube": MotionCase(
        "Block with g = diag(y)⁻¹X",
        _cube,
        lambda: Density.bump([0.6, 0.5, 0.4], 0.4),
        (1.0, 1.0, 1.0),
        (0.3, -0.2, 0.1),
    ),
}
TITLES = {name: case.title for name, case in CASES.items()}


@cache
def model(name: str) -> Model:
    """Return the model of a case; each process makes it once."""
    return CASES[name].made()


@cache
def law(name: str) -> Density:
    """Return the density of the particles at the start; each process makes it once."""
    return CASES[name].law()


def state(name: str, X: Floats) -> State:
    """Return the start of a case with particles X (N, nx)."""
    return State(X=X, y=CASES[name].y0, v=CASES[name].v0)


def stream(name: str, *numbers: int) -> np.random.Generator:
    """Return a generator of random numbers for a name and a tuple of numbers, different for each."""
    return np.random.default_rng(np.random.SeedSequence([STREAMS[name], *numbers]))


class ExactMotion(NamedTuple):
    """y, v (K, ny), X and multipliers (K, N, nx) at K times."""

    y: Floats
    v: Floats
    X: Floats
    multipliers: Floats


def harmonic(name: str, X: Floats, t: Floats, v0: float | None = None) -> ExactMotion:
    """Return the motion of particles X (N, 1) with StraightFibre ("straight") or LinearFibre ("linear")::

    straight: (1 + m s) y'' = -k0 (y - y_rest) - k1 s y,  s = <X^2>/y^2;  lambda = -y (k1 X + m X y''/y)
    linear:   (1 + m) y'' = -k0 (y - y_rest) - k1 <X>,  X - y constant;   lambda = -(k1 X + m y'')

    from y(0) and y'(0) of the case, unless ``v0`` is another y'(0).
    """
    m, k0, rest, k1 = (FIBRE[key] for key in ("m", "k0", "y_rest", "k1"))
    (y0,) = CASES[name].y0
    v0 = CASES[name].v0[0] if v0 is None else v0
    share, offset = (float((X**2).mean()) / y0**2, 0.0) if name == "straight" else (1.0, float(X.mean()) - y0)
    stiffness = k0 + k1 * share
    middle, rate = (k0 * rest - k1 * offset) / stiffness, np.sqrt(stiffness / (1 + m * share))
    cos, sin = np.cos(rate * t)[:, None], np.sin(rate * t)[:, None]
    y = middle + (y0 - middle) * cos + v0 / rate * sin
    v = -(y0 - middle) * rate * sin + v0 * cos
    a = -(rate**2) * (y - middle)
    if name == "straight":
        moved, pushed = X * y[:, None] / y0, X * a[:, None] / y0
        return ExactMotion(y, v, moved, -y[:, None] * (k1 * moved + m * pushed))
    moved = X + y[:, None] - y0
    return ExactMotion(y, v, moved, -(k1 * moved + m * a[:, None]))
