"""Wrong input to the instruments is named; a method that makes something else is refused in its row."""

import numpy as np
import pytest

import dincl
import verification as v
from verification.instruments.method import as_methods

SLIDE = dincl.scenes.sliding_disc()
T = [1.0, 2.0, 3.0]


def own(problem, dt, t):
    """A program of one's own, which is no scheme."""


def known(t):
    return SLIDE.exact(t)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"methods": {}}, "methods has no entry"),
        ({"methods": {"PBD": 3}}, r"methods\['PBD'\] = 3: must be a Method or a function"),
        ({"methods": [v.Method("a", scheme=dincl.PBD)] * 2}, r"two named \['a'\]"),
        ({"settings": [0.1, -1.0]}, "settings = .*: must be 1 or more different numbers > 0"),
        ({"settings": {"tol": [0.1]}}, "settings has no entry 'PBD' or 'dt'"),
        ({"t": [2.0, 1.0]}, "t = .*: must be one or more increasing times"),
        (
            {"errors": ("largest", "smallest")},
            "errors = .*: must be one or more of largest, final, L2, dense, overlap, or",
        ),
        ({"budget": 2.0}, r"budget = 2.0: must be CpuSeconds\(...\) or DriftEvaluations"),
        ({"reference": np.zeros((2, 1, 2))}, "reference of shape .*: must give one state for each of 3 times"),
        ({"reference": lambda t: SLIDE.exact(t)[:, 0]}, r"reference of shape \(3, 2\): must have shape \(K, N, d\)"),
        ({"methods": [dincl.PBD]}, "methods holds .*: a list must hold Method; or map labels to functions"),
    ],
)
def test_bad_input_is_named(changes, message):
    given = {
        "problem": SLIDE,
        "methods": {"PBD": dincl.PBD},
        "settings": [0.1],
        "t": T,
        "reference": known,
        "budget": v.CpuSeconds(1.0),
    }
    with pytest.raises(dincl.InvalidProblem, match=message):
        v.work_precision(**(given | changes))


@pytest.mark.parametrize(
    ("method", "detail"),
    [
        (v.Method("a", scheme=lambda dt: None), "'a' made None of the setting 0.1: must make a dincl.Scheme"),
        (v.Method("a", run=lambda *_: None), "'a' returned None: must return an array of real states"),
        (v.Method("a", run=lambda *_: np.zeros(3)), "'a' returned shape (3,): must return (3, 1, 2)"),
        (v.Method("a", run=lambda *_: np.full((3, 1, 2), 1j)), "must return an array of real states"),
        (v.Method("a", run=lambda problem, dt: None), "is called with (problem, setting, t): too many positional"),
        (
            v.Method("a", scheme=own),
            "is called with (setting): missing a required argument: 'dt'; a program is",
        ),
    ],
)
def test_a_method_that_makes_something_else_is_refused(method, detail):
    chart = v.work_precision(SLIDE, [method], [0.1], T, SLIDE.exact, v.CpuSeconds(1.0))
    assert chart.table["status"].tolist() == ["REFUSED"]
    assert detail in chart.table["detail"].iloc[0]
    assert detail in repr(chart)


def test_bad_methods_and_maps_are_named():
    with pytest.raises(dincl.InvalidProblem, match="give scheme, a function setting -> Scheme, or run"):
        v.Method("both", scheme=dincl.PBD, run=own)
    with pytest.raises(dincl.InvalidProblem, match=r"settings = .*: must be 5 or more"):
        v.order_study(SLIDE, {"PBD": dincl.PBD}, [0.1], T, SLIDE.exact)
    with pytest.raises(dincl.InvalidProblem, match="'strength': must be an argument of the method, which has dt"):
        v.stability_map(SLIDE, dincl.PBD, ("dt", [0.1]), ("strength", [1.0]))
    with pytest.raises(dincl.InvalidProblem, match=r"x = \[0.1\]: must be \(name, values\)"):
        v.stability_map(SLIDE, dincl.PBD, [0.1], ("sweeps", [1.0]))
    with pytest.raises(dincl.InvalidProblem, match=r"problem = 3: must be a dincl\.Problem"):
        v.reference(3, 1e-9)
    with pytest.raises(dincl.InvalidProblem, match=r"dt = 0.1: is the first step of a scheme"):
        v.reference(SLIDE, 1e-9, dt=0.1)
    with pytest.raises(dincl.InvalidProblem, match="results holds 3"):
        v.save([3], "unused")
    methods = {"PBD": dincl.PBD, "catch-up": lambda dt: dincl.CatchUp(dt, dincl.Daqp(tol=1e-12))}
    assert [method.label for method in as_methods(methods)] == list(methods)
