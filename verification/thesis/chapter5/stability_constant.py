"""The constant of the stability estimate (5.60), measured over many pairs of starts, beside the bound of its proof.

D(t) = |y1 - y2| + |v1 - v2| + W1(mu1, mu2). With an optimal coupling of the two starts that is carried along, D is at
most D* = |y1 - y2| + |v1 - v2| + int |X1 - X2|, equal to D at t = 0, and D*' <= L D* with

    L = max(M_v Lip_x(Phi) + Lip_x(a),  M_v Lip_y(Phi) + Lip_y(a),  1 + sup |Phi| + Lip_v(a)),
    Lip(a) <= Lip(F) + sup |F| Lip(m)      for a = F_eff/m_eff with m_eff >= 1 (Lemma 5.7),

all on the region that the motions visit, of their levels c = g(X, y), y and v: the proof of Theorem 5.16 with C = 1.
The region of (X, y) is convex for StraightFibre (a wedge) and LinearFibre, so that derivatives bound differences; for
WavyFibre its edges are curved, and L is that of nearby points.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dincl.study import Key, Row, Study
from meanfield import Model, Motion, State, StraightFibre, solve_ode, w1
from meanfield.solvers.index_one import consistent_values
from verification.lines import slope
from verification.thesis.chapter5 import cases

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
# Points per axis of the region on which constants are taken, and half the distance of their differences.
FINE, STEP = 41, 1e-5


@dataclass(frozen=True)
class PairsForm:
    """How many pairs of each kind, of which models."""

    pairs: int
    models: tuple[str, ...] = MODELS


FULL = PairsForm(100)


def study(form: PairsForm) -> Study:
    """A row for each pair and time."""
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
    """The region that two motions visit."""
    found: dict[str, float] = {}
    for axis in ("level", "y", "v", "X"):
        values = np.concatenate([getattr(motion, axis).ravel() for motion in (one, two)])
        found |= {f"least_{axis}": float(values.min()), f"largest_{axis}": float(values.max())}
    return found


def summary(table: pd.DataFrame) -> pd.DataFrame:
    """For each model: the largest ratio D(t)/D(0) of all pairs, where; its growth; and L with its bound e^{Lt}.

    ``rate`` is the slope of the logarithm of the largest ratio against t over the whole time, with 95 % interval, and
    ``needed`` the least L for which e^{Lt} is above all ratios.
    """
    rows = []
    for name, mine in table.groupby("model", sort=False):
        envelope = mine.groupby("t")["ratio"].max()
        t, ratio = envelope.index.to_numpy()[1:], envelope.to_numpy()[1:]
        where = mine.loc[mine["ratio"].idxmax()]
        rate, low, high = slope(t, np.log(ratio))
        constant = lipschitz(cases.model(name), mine)
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
    """The largest ratio of all pairs, for each model, kind and time."""
    return table.groupby(["model", "kind", "t"], sort=False)["ratio"].max().reset_index()


def lipschitz(model: Model, reached: pd.DataFrame) -> float:
    """L on the levels, y and v that all motions visit, by differences at the points of a grid of them; nx = ny = 1."""
    level, y, v = (_axis(reached, axis) for axis in ("level", "y", "v"))
    guess = np.full((FINE, 1), (reached["least_X"].min() + reached["largest_X"].max()) / 2)
    fastest, rows = float(np.abs(v).max()), []
    for at in y:
        X, _ = consistent_values(model, guess, np.array([at]), np.zeros(1), level[:, None])
        phi, _, force = _shares(model, X, at, v)
        by_x = _differences(_shares(model, X - STEP, at, v), _shares(model, X + STEP, at, v))
        by_y = _differences(_shares(model, X, at - STEP, v), _shares(model, X, at + STEP, v))
        bend = 2 * model.m * fastest * np.abs(phi * model.omega(X, [at], [1.0])[:, 0]).max()
        sizes = (np.abs(part).max() for part in (phi, force, *by_x, *by_y))
        rows.append([*sizes, bend])
    phi_, force_, phi_x, mass_x, force_x, phi_y, mass_y, force_y, force_v = np.max(rows, axis=0)
    along_x, along_y = force_x + force_ * mass_x, force_y + force_ * mass_y
    return float(max(fastest * phi_x + along_x, fastest * phi_y + along_y, 1 + phi_ + force_v))


def _differences(before: tuple[Floats, ...], after: tuple[Floats, ...]) -> list[Floats]:
    return [(high - low) / (2 * STEP) for low, high in zip(before, after, strict=True)]


def _axis(reached: pd.DataFrame, name: str) -> Floats:
    return np.linspace(reached[f"least_{name}"].min(), reached[f"largest_{name}"].max(), FINE)


def _shares(model: Model, X: Floats, y: float, v: Floats) -> tuple[Floats, Floats, Floats]:
    """Phi (Q,), effective mass (Q,) and force (Q, V) of one particle at X (Q, 1), for velocities (V,)."""
    phi, omega = model.phi(X, [y])[:, 0, 0], model.omega(X, [y], [1.0])[:, 0]
    force = model.F0([y])[0] + phi * model.F1(X)[:, 0]
    return phi, 1 + model.m * phi**2, force[:, None] - model.m * (phi * omega)[:, None] * v**2


def counterexample() -> pd.DataFrame:
    """(5.65) as printed: two laws with one flow, X1^t = X2^t, so that W1(mu1^t, mu2^t) <= W1(mu1^0, mu2^0).

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
