"""The chart names all that is drawn on it, beside its axes."""

from dataclasses import dataclass

import numpy as np
import pytest

import dincl
import verification as v
from verification.instruments import charts

SLIDE = dincl.scenes.sliding_disc()
T = [1.0, 2.0]
METHODS = [
    v.Method("PBD", scheme=dincl.PBD),
    v.Method("fails", run=lambda problem, dt, t: np.nan * problem.drift(0.0, problem.x0) * np.ones((len(t), 1, 1))),
    v.Method("small", scheme=dincl.PBD, most_unknowns=1),
    v.Method("refuses", scheme=lambda tol: dincl.PBD(1e-15), setting="tol"),
    v.Method("slow", scheme=lambda dt: dincl.PBD(dt * 1e-4)),
]


@pytest.fixture(scope="module")
def drawn():
    settings = {"dt": [0.1, 0.01, 0.001], "tol": [1e-3]}
    found = v.work_precision(SLIDE, METHODS, settings, T, SLIDE.exact, v.DriftEvaluations(10**4))
    return found, found.plot(cost="drift_evaluations")


def entries(axes):
    handles, labels = axes.get_legend_handles_labels()
    return dict(zip(labels, handles, strict=True))


def test_every_method_has_an_entry_and_those_without_a_run_say_why(drawn):
    labels = set(entries(drawn[1]))
    assert {"PBD (compiled)", "fails: failed", "small: left out", "slow: too slow"} <= labels
    assert "refuses: refused" in labels


@pytest.mark.slow
def test_methods_are_marked_by_what_their_steps_are_made_of():
    class Slow(dincl.Stepper):
        def step(self, t, h, state):
            return dincl.StepState(state.x + h * self.velocity(t, state.x))

    @dataclass(frozen=True)
    class Euler(dincl.FixedStep):
        def stepper(self, problem):
            return Slow(problem)

    methods = [
        v.Method("PBD", scheme=dincl.PBD),
        v.Method("Euler", scheme=Euler),
        v.Method("Ipopt", scheme=lambda dt: dincl.CatchUp(dt, dincl.Ipopt(tol=1e-9))),
        v.Method("fast", run=lambda problem, dt, t: SLIDE.exact(t), compiled=True),
        v.Method("unknown", run=lambda problem, dt, t: SLIDE.exact(t)),
    ]
    found = v.work_precision(SLIDE, methods, [0.1, 0.05], T, SLIDE.exact, v.CpuSeconds(5.0))
    marked = {"PBD (compiled)", "Euler (calls Python)", "Ipopt (calls Python)", "fast (compiled)", "unknown"}
    assert marked <= set(entries(found.plot()))


def test_crosses_have_an_entry_where_there_are_any(drawn):
    found, axes = drawn
    failed = ~found.table["status"].isin(("SUCCESS", "OUT_OF_BUDGET", "LEFT_OUT", "REFUSED"))
    assert failed.any()
    assert entries(axes)[charts.FAILED].get_marker() == "x"
    none = v.work_precision(SLIDE, METHODS[:1], [0.1], T, SLIDE.exact, v.CpuSeconds(1.0))
    assert charts.FAILED not in entries(none.plot())
