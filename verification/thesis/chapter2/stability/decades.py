"""Six decades of dt: methods with projections stay bounded, penalty methods do not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

import dincl
from dincl.study import Key, Row, Study
from verification.thesis.chapter2.stability.case import Case, Found, happens
from verification.thesis.chapter2.stability.contestants import CONTESTANTS
from verification.thesis.chapter2.stability.outcome import FAR, measured

# A bounded drift: with F = -x explicit Euler itself is unstable beyond dt = 2 (see ``drift``).
DISCS = 6
# Runs last so long [time], and at least so many steps; the last ones are all looked at, as forces may repeat.
END, STEPS, LAST = 1.0, 100, 30
DECADES = tuple(float(dt) for dt in 10.0 ** np.arange(-4, 3))
METHODS = (
    "pbd",
    "pbd_16",
    "second_order",
    "catch_up_daqp",
    "linearised_daqp",
    "midpoint_daqp",
    "penalty_tied",
    "penalty_100",
    "penalty_printed",
)
CASE_METHODS = ("pbd", "pbd_16")


@dataclass(frozen=True)
class DecadesForm:
    """The steps [time]."""

    steps: tuple[float, ...]


FULL = DecadesForm(tuple(float(dt) for dt in np.geomspace(1e-4, 1e2, 25)))


def run(method: str, dt: float) -> dict[str, Any]:
    """Let six discs fall onto a floor between walls; return the growth of the largest coordinate, and the overlap."""
    problem = dincl.scenes.pile(DISCS)
    steps = max(STEPS, round(END / dt))
    # There is no exact state to compare with here: only whether the discs stay where they can be.
    times, reach = dt * np.arange(steps - LAST, steps + 1), float(np.abs(problem.x0).max())
    row = measured(problem, CONTESTANTS[method].scheme(dt), times, problem.x0 * np.nan, reach)
    return row | {"bounded": bool(row["growth"] <= FAR) and row["status"] == "SUCCESS"}


def one(key: Key) -> list[Row]:
    """Return one run as a row."""
    return [dict(key) | run(key["method"], key["dt"])]


def study(form: DecadesForm) -> Study:
    """Return all methods over all steps."""
    return Study(
        name="stability_decades",
        title="Six decades of dt",
        key=("method", "dt"),
        runs=tuple({"method": method, "dt": dt} for dt in form.steps for method in METHODS),
        run=one,
    )


def _bounded() -> Found:
    rows = {(method, dt): run(method, dt) for method in CASE_METHODS for dt in DECADES}
    growth = max(row["growth"] for row in rows.values())
    listed = "; ".join(
        f"{CONTESTANTS[method].label}: " + ", ".join(f"{rows[method, dt]['overlap']:.0e}" for dt in DECADES)
        for method in CASE_METHODS
    )
    words = f"largest coordinate over that of the start: {growth:.2f}; overlaps, dt = 1e-4 ... 100 in decades: {listed}"
    return happens(all(row["bounded"] for row in rows.values()) and growth < 1.1, words)


def _springs() -> Found:
    """Springs of strength 100: dt 100 = 2 / lambda_max, at 0.003 ... 0.02; bounded below, away above."""
    rows = {dt: run("penalty_100", dt)["growth"] for dt in (1e-4, 1e-3, 1e-1, 1.0)}
    words = ", ".join(f"dt = {dt:g}: {growth:.1e}" for dt, growth in rows.items())
    agrees = max(rows[1e-4], rows[1e-3]) < 1.1 and min(rows[1e-1], rows[1.0]) > FAR
    return happens(agrees, f"largest coordinate over that of the start, {words}")


CASES = (
    Case(
        "decades-pbd",
        "PBD over six decades of dt",
        "bounded drift: overlap grows up to a diameter, coordinates do not grow",
        _bounded,
    ),
    Case("decades-springs", "Springs of strength 100 on the same axis", "thrown apart beyond dt ≈ 0.01", _springs),
)
