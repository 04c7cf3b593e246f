"""Tissues of the simplest and of the full model beside each other."""

from __future__ import annotations

from pathlib import Path

from dincl.equivalence.search import AND
from tissue.pictures.picture import box_of, draw_frame
from tissue.pictures.sheet import Figure, style, write
from tissue.runs.simulate import simulate
from tissue.study.plan import load_study, run_seeds
from tissue.study.question import asked
from tissue.study.simplifications import simplified
from verification.beyond.needs.questions import QUESTIONS


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
    path.parent.mkdir(parents=True, exist_ok=True)
    with style():
        figure = Figure(figsize=(7.6, 3.1), layout="constrained")
        panels = figure.subplots(1, len(models), sharey=True, squeeze=False)[0]
        for panel, (title, parameters), frame in zip(panels, models.items(), frames, strict=True):
            draw_frame(panel, frame, parameters, box)
            panel.set_title(title, fontsize=10, pad=20)
        write(figure, path)
    return path
