"""Speed against accuracy: every method on every scene, from coarse settings to fine ones, within a budget a run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import pandas as pd

from dincl.study import Key, Row, Study
from verification.beyond.chart.references import SCENES
from verification.instruments.budget import Budget, CpuSeconds
from verification.instruments.chart import WorkPrecision
from verification.instruments.references import Known
from verification.instruments.speed_accuracy import rows_of, settings_of
from verification.thesis.chapter2.methods import CHARTED, METHODS, NamedMethod

ERRORS = ("largest", "final", "overlap")


@dataclass(frozen=True)
class Form:
    """Settings, budget and scenes of a study.

    Attributes
    ----------
    settings
        By the name of the setting, from coarse to fine: steps [time], tolerances [length].
    budget
        Of one run.
    scenes, methods
        Names of the scenes; the methods on each of them.
    """

    settings: Mapping[str, Sequence[float]]
    budget: Budget
    scenes: tuple[str, ...] = tuple(SCENES)
    methods: tuple[NamedMethod, ...] = CHARTED


FULL = Form({"dt": [0.1 / 2**k for k in range(21)], "tol": [10.0**-k for k in range(1, 13)]}, CpuSeconds(5.0))


@dataclass(frozen=True)
class ChartRun:
    """All settings of one method on one scene: one row each."""

    references: Mapping[str, Known]
    form: Form

    def __call__(self, key: Key) -> list[Row]:
        method, known = METHODS[key["method"]], self.references[key["scene"]]
        settings = settings_of(method, self.form.settings)
        rows = rows_of(SCENES[key["scene"]](), method, settings, known, ERRORS, self.form.budget)
        return [row | dict(key) for row in rows]


def chart(table: pd.DataFrame, scene: str, form: Form) -> WorkPrecision:
    """Return the chart of one scene, with labels for names."""
    labels = {method.name: method.label for method in CHARTED}
    rows = table[table["scene"] == scene].replace({"method": labels})
    there = [method for method in CHARTED if method.label in set(rows["method"])]
    looks = {method.label: {"family": method.family} | dict(method.look) for method in there}
    return WorkPrecision(rows, ERRORS, form.budget, looks, title=SCENES[scene]().title)


def study(references: Mapping[str, Known], form: Form) -> Study:
    """Return all methods of the chart on all scenes; the scenes of many particles first."""
    runs = [
        {"scene": name, "method": method.name} for name in reversed(form.scenes) for method in reversed(form.methods)
    ]
    return Study(
        name="work_precision",
        title="Speed against accuracy",
        key=("scene", "method"),
        runs=tuple(runs),
        run=ChartRun(references, form),
        settings={"references": references, "settings": form.settings, "budget": form.budget},
    )
