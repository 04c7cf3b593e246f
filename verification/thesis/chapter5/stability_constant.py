"""The constant of the stability estimate (5.60), measured over many pairs of starts, beside the bound of its proof.

D(t) = |y1 - y2| + |v1 - v2| + W1(mu1, mu2). With an optimal coupling of the two starts that is carried along, D is at
most D* = |y1 - y2| + |v1 - v2| + int |X1 - X2|, equal to D at t = 0, and D*' <= L D* with

    L = max(M_v Lip_x(Phi) + Lip_x(a),  M_v Lip_y(Phi) + Lip_y(a),  1 + sup |Phi| + Lip_v(a)),
    Lip(a) <= Lip(F) + sup |F| Lip(m)      for a = F_eff/m_eff with m_eff >= 1 (Lemma 5.7),

all on the region that the motions visit, of their levels c = g(X, y), y and v: the proof of Theorem 5.16 with C = 1.
Each is bounded by interval arithmetic. The region of (X, y) is convex for StraightFibre (a wedge) and LinearFibre, so
that derivatives bound differences; for WavyFibre all y are taken with all X that belong to some level and y.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.optimize import brentq

from dincl.study import Key, Row, Study
from meanfield import Motion, State, StraightFibre, solve_ode, w1
from verification.formal.enclosures import least_upper_bound
from verification.instruments.lines import slope
from verification.thesis.chapter5 import cases
from verification.thesis.chapter5.cases import FIBRE

Floats = NDArray[np.float64]
T = np.linspace(0.0, 8.0, 17)
TOL = 1e-8
MODELS = ("straight", "linear", "wavy")
# What differs between the two starts of a pair.
KINDS = {
    "sample": "samples of one law",
    "law": "laws, shifted",
    "y0": "y(0)",
    "v0": "y'(0)",
    "all": "all of these",
}
PARTICLES = 20
# Largest size of a difference.
SHIFT = 0.1
# Far above the error of a position that a root finder gives.
ROUNDING = 1e-9


@dataclass(frozen=True)
class PairsForm:
    """How many pairs of each kind, of which models."""

    pairs: int
    models: tuple[str, ...] = MODELS


FULL = PairsForm(100)


def study(form: PairsForm) -> Study:
    """Make a row for each pair and time."""
    runs = tuple({"model": name, "kind": kind} for name in form.models for kind in KINDS)
    return Study(
        name="meanfield_stability",
        title="Mean field: constant of stability",
        key=("model", "kind"),
        runs=runs,
        run=partial(_rows, pairs=form.pairs),
    )


def _rows(key: Key, pairs: int) -> list[Row]:
    name, kind = key["model"], key["kind"]
    rows: list[Row] = []
    for pair in range(pairs):
        rng = cases.stream("pairs", MODELS.index(name), list(KINDS).index(kind), pair)
        one, two = (solve_ode(cases.model(name), start, T, TOL) for start in _pair(name, kind, rng))
        apart = _apart(one, two)
        reach = _reach(one, two)
        rows += [
            dict(key) | {"pair": pair, "t": t, "ratio": d / apart[0]} | reach for t, d in zip(T, apart, strict=True)
        ]
    return rows


def _pair(name: str, kind: str, rng: np.random.Generator) -> tuple[State, State]:
    case, law = cases.CASES[name], cases.law(name)
    X, y, v = law.sample(rng, PARTICLES), np.array(case.y0), np.array(case.v0)
    shift = rng.uniform(-SHIFT, SHIFT, 3)
    other = law.sample(rng, PARTICLES) if kind in ("sample", "all") else X
    by_law, by_y, by_v = (shift[k] * (kind in (name_, "all")) for k, name_ in enumerate(("law", "y0", "v0")))
    return State(X=X, y=y, v=v), State(X=other + by_law, y=y + by_y, v=v + by_v)


def _apart(one: Motion, two: Motion) -> Floats:
    gaps = [w1(a, b) for a, b in zip(one.X, two.X, strict=True)]
    return np.asarray(np.abs(one.y - two.y)[:, 0] + np.abs(one.v - two.v)[:, 0] + np.array(gaps))


def _reach(one: Motion, two: Motion) -> dict[str, float]:
    """Return the region that two motions visit."""
    found: dict[str, float] = {}
    for axis in ("level", "y", "v", "X"):
        values = np.concatenate([getattr(motion, axis).ravel() for motion in (one, two)])
        found |= {f"least_{axis}": float(values.min()), f"largest_{axis}": float(values.max())}
    return found


def summary(table: pd.DataFrame) -> pd.DataFrame:
    """Summarise each model: the largest D(t)/D(0) of all pairs, its time, its growth, and L with its bound e^{Lt}.

    ``rate`` is the slope of the logarithm of the largest ratio against t over the whole time, with 95 % interval, and
    ``needed`` the least L for which e^{Lt} is above all ratios.
    """
    rows = []
    for name, mine in table.groupby("model", sort=False):
        envelope = mine.groupby("t")["ratio"].max()
        t, ratio = envelope.index.to_numpy()[1:], envelope.to_numpy()[1:]
        where = mine.loc[mine["ratio"].idxmax()]
        rate, low, high = slope(t, np.log(ratio))
        constant = lipschitz(name, mine)
        rows.append(
            {"model": name, "pairs": len(mine) // mine["t"].nunique(), "largest": float(where["ratio"])}
            | {"at": float(where["t"]), "kind": where["kind"], "rate": rate, "low": low, "high": high}
            | {
                "needed": float((np.log(ratio) / t).max()),
                "bound": constant,
                "held": bool((np.log(ratio) <= constant * t).all()),
            }
        )
    return pd.DataFrame(rows)


def envelopes(table: pd.DataFrame) -> pd.DataFrame:
    """Return the largest ratio of all pairs, for each model, kind and time."""
    return table.groupby(["model", "kind", "t"], sort=False)["ratio"].max().reset_index()


class Shares(NamedTuple):
    """What one particle contributes, with its slopes in X and in y: Phi, Phi Omega and F0 + Phi F1, without V."""

    phi: Any
    phi_x: Any
    phi_y: Any
    bend: Any
    bend_x: Any
    force: Any
    force_x: Any
    force_y: Any


def straight(c: Any, y: Any) -> Shares:
    """Return the shares for g = X/y at X = c y."""
    k0, k1, rest = (FIBRE[name] for name in ("k0", "k1", "y_rest"))
    pull = -k0 * (y - rest) - k1 * c * c * y
    return Shares(c, 1 / y, -c / y, 0 * c, 0 * c, pull, -2 * k1 * c, -k0 + k1 * c * c)


def linear(c: Any, y: Any) -> Shares:
    """Return the shares for g = X - y at X = c + y."""
    k0, k1, rest = (FIBRE[name] for name in ("k0", "k1", "y_rest"))
    return Shares(0 * c + 1, 0 * c, 0 * c, 0 * c, 0 * c, -k0 * (y - rest) - k1 * (c + y), 0 * c - k1, 0 * c - k0)


def wavy(X: Any, y: Any) -> Shares:
    """Return the shares for g = X + sin(X)/2 - y at X; Phi and Omega do not depend on y."""
    k0, k1, rest = (FIBRE[name] for name in ("k0", "k1", "y_rest"))
    phi, sine = 2 / (2 + X.cos()), X.sin() / 2
    phi_x = sine * phi * phi
    bend = sine * phi**4
    bend_x = X.cos() / 2 * phi**4 + 4 * sine * sine * phi**5
    pull = -k0 * (y - rest) - k1 * X * phi
    return Shares(phi, phi_x, 0 * X, bend, bend_x, pull, -k1 * (phi + X * phi_x), 0 * X - k0)


SHARES = {"straight": straight, "linear": linear, "wavy": wavy}
# Of the bounds; those of WavyFibre are reached inside of the region, where it takes many boxes to be near them.
SLACK = {"straight": 1e-6, "linear": 1e-6, "wavy": 1e-4}


def lipschitz(name: str, reached: pd.DataFrame) -> float:
    """Return a bound of L on the levels, y and v that all motions of a model visit, nx = ny = 1."""
    first, y, v = (_axis(reached, axis) for axis in ("level", "y", "v"))
    if name == "wavy":
        first = _positions(first[0] + y[0], first[1] + y[1])
    m, fastest = FIBRE["m"], max(map(abs, v))

    def largest(part: Callable[[Shares], Any]) -> float:
        return least_upper_bound(lambda a, b: abs(part(SHARES[name](a, b))), [first, y], SLACK[name])

    def at_most(part: Callable[[Shares, float], Any]) -> float:
        return max(largest(lambda at: part(at, 0.0)), largest(lambda at: part(at, fastest**2)))

    force = at_most(lambda at, w: at.force - m * w * at.bend)
    force_x, force_y = at_most(lambda at, w: at.force_x - m * w * at.bend_x), largest(lambda at: at.force_y)
    phi, phi_x, phi_y = largest(lambda at: at.phi), largest(lambda at: at.phi_x), largest(lambda at: at.phi_y)
    mass_x, mass_y = largest(lambda at: 2 * m * at.phi * at.phi_x), largest(lambda at: 2 * m * at.phi * at.phi_y)
    along_x, along_y = force_x + force * mass_x, force_y + force * mass_y
    bend = 2 * m * fastest * largest(lambda at: at.bend)
    return float(max(fastest * phi_x + along_x, fastest * phi_y + along_y, 1 + phi + bend))


def _axis(reached: pd.DataFrame, name: str) -> tuple[float, float]:
    return float(reached[f"least_{name}"].min()), float(reached[f"largest_{name}"].max())


def _positions(low: float, high: float) -> tuple[float, float]:
    """Return an interval that holds all X with low <= X + sin(X)/2 <= high; its slope is at least 1/2."""
    least, most = (brentq(lambda x, at: x + np.sin(x) / 2 - at, at - 1, at + 1, (at,)) for at in (low, high))
    return least - ROUNDING, most + ROUNDING


def counterexample() -> pd.DataFrame:
    """Refute (5.65) as printed: two laws with one flow, X1^t = X2^t, for which W1 grows.

    With StraightFibre y depends on <X^2> only; particles at +-1/sqrt(3) have that of the uniform law on [-1, 1].
    """
    model = StraightFibre(m=1.0, k0=1.0, y_rest=3.0, k1=0.1)
    points = np.array([[-1.0], [1.0]]) / np.sqrt(3)
    even = np.linspace(-1, 1, 201)[:, None]
    even *= np.sqrt(1 / 3 / (even**2).mean())
    one, two = (solve_ode(model, State(X=X, y=[1.0], v=[0.0]), T, 1e-12) for X in (points, even))
    gaps = [w1(a, b) for a, b in zip(one.X, two.X, strict=True)]
    columns: dict[str, Any] = {"t": T, "y": one.y[:, 0], "flows_apart": np.abs(one.y - two.y)[:, 0]}
    return pd.DataFrame(columns | {"ratio": np.array(gaps) / gaps[0], "stretch": one.y[:, 0] / one.y[0, 0]})
