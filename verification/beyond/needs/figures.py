"""Simpler models beside the full one: their tissues, and their bias against their cost."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from tissue.pictures.bias import bias_chart
from tissue.pictures.charts import CHART_STYLE, WIDTH
from tissue.pictures.picture import box_of, draw_frame
from tissue.pictures.sheet import Figure, style, write
from tissue.runs.simulate import simulate
from tissue.study.elimination import AND
from tissue.study.plan import load_study, run_seeds
from tissue.study.question import asked
from tissue.study.simplifications import simplified
from verification.beyond.needs.questions import QUESTIONS

SIDES, AROUND = 1.5, 1.2  # inches: beside both panels; above and below them
DPI = 120  # many discs make large files


def draw_tissues(name: str, answer: str, path: Path) -> Path:
    """Draw the first run of the first scenario of a question at its end: the full model left, the simplest one right.

    Both have the same seed and the same scale. ``answer`` joins the names of simplifications, "" for none.
    """
    study, what = QUESTIONS[name]
    plan = load_study(study)
    question = asked(plan, what)
    scenario = question.scenarios[0]
    full = question.of(plan.scenarios[scenario])
    models = {"the full model": full}
    if answer:
        models["the simplest model"] = simplified(full, answer.split(AND))
    (seed,) = run_seeds(plan.seed, scenario, [0])
    frames = [simulate(parameters, seed, throw=False).final for parameters in models.values()]
    box = box_of(frames, full)
    wide = (WIDTH - SIDES) / len(models)
    with style(**CHART_STYLE | {"axes.grid": False}):
        height = wide * (box.high - box.low) / (box.right - box.left) + AROUND
        figure = Figure(figsize=(WIDTH, height), layout="constrained", dpi=DPI)
        panels = figure.subplots(1, len(models), sharey=True, squeeze=False)[0]
        for panel, (title, parameters), frame in zip(panels, models.items(), frames, strict=True):
            draw_frame(panel, frame, parameters, box)
            panel.set_title(title, pad=18.0)  # above the line on the state
    write(figure, path)
    return path


def draw_models(table: pd.DataFrame, tolerance: float, unit: str, answer: str, path: Path) -> Path:
    """Draw bias against cost; arguments as in ``bias_chart``."""
    write(bias_chart(table, tolerance, unit, answer), path)
    return path
