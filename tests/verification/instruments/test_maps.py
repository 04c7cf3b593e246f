"""Maps of where a method fails: outcomes of runs, limits that theory predicts, panels, wrong input."""

import pickle
from functools import partial

import numpy as np
import pytest

import dincl
import verification as v
from verification.instruments.outcome import FAR, judge
from verification.instruments.stability import StabilityRuns, judged_run

OK, OUT, STATUS = dincl.Status.SUCCESS, v.Outcome, dincl.Status
WALL = dincl.Problem([[2.0, 1.0]], lambda t, x: -x, [dincl.HalfSpace((0, 1), radius=0.5)])


@pytest.mark.parametrize(
    ("status", "error", "overlap", "growth", "expected"),
    [
        (OK, 0.0, 0.0, 1.0, OUT.CONVERGED),
        (OK, 0.02, 0.1, FAR, OUT.CONVERGED),
        (OK, 0.0201, 0.0, 1.0, OUT.INACCURATE),
        (OK, np.nan, 0.0, 1.0, OUT.INACCURATE),
        (OK, None, 0.0, 1.0, OUT.BOUNDED),
        (OK, None, 0.101, 1.0, OUT.INFEASIBLE),
        (OK, 0.0, 0.101, 1.0, OUT.INFEASIBLE),
        (OK, 0.0, 0.101, 1.01 * FAR, OUT.UNSTABLE),
        (STATUS.NON_FINITE, np.nan, np.nan, 1.0, OUT.UNSTABLE),
        (STATUS.NOT_CONVERGED, np.nan, 0.0, 1.0, OUT.NOT_TERMINATED),
        (STATUS.NOT_CONVERGED, np.nan, 0.0, 1e9, OUT.UNSTABLE),
        (STATUS.INFEASIBLE, np.nan, 0.0, 1.0, OUT.REFUSED),
        (STATUS.COINCIDENT_CENTRES, np.nan, 0.0, 1.0, OUT.REFUSED),
        (STATUS.CROWDED, np.nan, 0.0, 1.0, OUT.REFUSED),
    ],
)
def test_the_rule_of_outcomes(status, error, overlap, growth, expected):
    assert judge(status, error, overlap, growth, accurate=0.02, feasible=0.1) is expected


def pushed(x0=0.5, **sets):
    """A point that is pushed to the left, between walls."""
    return dincl.Problem([[x0]], lambda t, x: -np.ones_like(x), **sets)


def drawn(rate):
    return dincl.Problem([[1.0]], lambda t, x: -rate * x)


def pulled(speed):
    return dincl.Problem([[1.0]], lambda t, x: -speed * np.ones_like(x), [dincl.HalfSpace(normal=(1,))])


BETWEEN = pushed(constraints=[dincl.HalfSpace(normal=(1,)), dincl.HalfSpace(normal=(-1,), offset=-1.0)])
MAPS = {
    "penalty": (
        {"problem": BETWEEN, "method": dincl.Penalty, "x": ("dt", [0.01, 0.05]), "y": ("strength", [10.0, 1000.0])},
        ["bounded", "bounded", "bounded", "unstable"],
    ),
    "one argument of any name": (
        {
            "problem": drawn,
            "method": lambda h: dincl.PBD(h, sweeps=1),
            "x": ("dt", [0.1, 3.0]),
            "y": ("rate", [1.0]),
            "t": [30],
        },
        ["bounded", "unstable"],
    ),
    "a parameter of the problem": (
        {"problem": pulled, "method": dincl.PBD, "x": ("dt", [0.1]), "y": ("speed", [0.5, 4.0]), "t": [1.0]}
        | {"reference": lambda problem: lambda t: np.zeros((len(t), 1, 1))},
        ["inaccurate", "converged"],
    ),
}


@pytest.mark.parametrize("name", MAPS)
def test_outcomes_over_two_parameters(name):
    given, outcomes = MAPS[name]
    found = v.stability_map(**given)
    assert found.table["outcome"].tolist() == outcomes
    assert outcomes[-1] in repr(found)


def test_the_error_in_a_map_is_the_largest_of_all_times():
    errors = np.array([0.25, 1.0, 0.5])
    found = v.stability_map(
        pushed(1.0),
        partial(dincl.PBD),
        ("dt", [0.1]),
        ("dt", [0.1]),
        t=[0.5, 1.0, 1.5],
        reference=lambda problem: lambda t: 1.0 - t[:, None, None] + errors[:, None, None],
    )
    assert found.table["error"].tolist() == [pytest.approx(1.0)]
    assert found.title == "Stability"


def judged(dt, strength):
    return OUT.UNSTABLE if dt * strength > 2 else OUT.CONVERGED


def at_rest(problem):
    return problem.x0


def test_several_methods_have_a_panel_each_with_the_limits_that_theory_predicts():
    found = v.stability_map(
        pushed(0.0, constraints=[dincl.HalfSpace(normal=(side,)) for side in (1, -1)]),
        {"springs": dincl.Penalty, "as printed": partial(dincl.Penalty, exponent=1)},
        x=("dt", [0.001, 0.01, 0.1], "step dt [time]"),
        y=("strength", [10.0, 100.0, 1000.0]),
        t=lambda dt: 100 * dt + dt * np.arange(3),
        reference=at_rest,
        accurate=1.0,
        feasible=1.0,
        limits=[v.Limit("dt k = 2", lambda dt: 2 / dt, ["springs"]), v.Limit("load", 1.0)],
    )
    springs, curves = found.table[found.table["method"] == "springs"], found.limits
    assert ((springs["outcome"] == "unstable") == (springs["dt"] * springs["strength"] > 2)).all()
    limits = curves.groupby("label")["method"].unique().map(list).to_dict()
    assert limits == {"dt k = 2": ["springs"], "load": ["springs", "as printed"]}
    mine = curves[curves["label"] == "dt k = 2"]
    assert mine["x"].iloc[[0, -1]].to_numpy() == pytest.approx([1e-3 / 10**0.5, 0.1 * 10**0.5])
    assert (mine["x"] * mine["y"]).to_numpy() == pytest.approx(2.0)
    first = found.plot()
    assert [panel.get_title(loc="left") for panel in first.figure.axes] == ["springs", "as printed"]
    assert [line.get_label() for line in first.lines] == ["dt k = 2", "load"]
    assert found.plot(method="as printed").get_xlabel() == "step dt [time]"
    assert pickle.loads(pickle.dumps(found)).summaries().keys() == found.summaries().keys()


def test_runs_that_judge_themselves_may_be_several():
    runs = StabilityRuns(None, {"a": judged, "b": judged}, ("dt", [0.1, 1.0]), ("strength", [1.0, 10.0]))
    found = runs.result(runs.study().rows())
    assert found.table["method"].tolist() == ["a"] * 4 + ["b"] * 4
    assert found.table["outcome"].tolist() == ["converged", "converged", "converged", "unstable"] * 2
    runs.result(found.table.iloc[:3]).plot()  # a cell without a run is white


@pytest.mark.parametrize("found", ["fine", 1, {"outcome": "good"}, {}])
def test_a_run_that_judges_itself_must_return_an_outcome(found):
    cells = v.stability_map(None, lambda a, b: found, ("a", [1.0]), ("b", [1.0]))
    assert cells.table["outcome"].iloc[0] == "refused"


def test_a_judged_run_tells_falling_from_flying_and_takes_the_largest_error():
    assert judged_run(pushed(0.0), dincl.PBD(dt=0.5), [50.0], [[0.0]])["outcome"] == "inaccurate"
    flying = judged_run(dincl.Problem([[1.0]], lambda t, x: x), dincl.PBD(dt=0.5), [50.0], [[1.0]])
    assert flying["outcome"] == "unstable"
    assert flying["growth"] == pytest.approx(1.5**100 / 51, rel=1e-12)  # over the free path 1 + 50
    wall, scheme = pushed(1.0, constraints=[dincl.HalfSpace(normal=(1,))]), dincl.PBD(dt=0.25)
    for outcome, exact in {"converged": [[[0.5]], [[0.0]]], "inaccurate": [[[0.5]], [[0.75]]]}.items():
        assert judged_run(wall, scheme, [0.5, 2.0], exact)["outcome"] == outcome
    assert judged_run(wall, scheme, [2.0])["outcome"] == "bounded"
    assert judged_run(wall, scheme, [0.25], reach=0.1)["outcome"] == "unstable"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"x": ("dt", [])}, r"dt = \[\]: must be one or more numbers"),
        ({"x": ("dt", {0.1})}, r"dt = \{0.1\}: must be one or more numbers"),
        ({"x": [0.1]}, r"x = \[0.1\]: must be \(name, values\)"),
        ({"y": ("strength", [1.0])}, "'strength': must be an argument of the method, which has dt"),
        ({"problem": 3}, "problem = 3: must be a dincl.Problem"),
        ({"method": dict}, "must be a function with named arguments"),
        ({"method": {}}, "method = {}: must have one or more methods"),
        ({"x": ("dt", [0.1], 3)}, "x = .*: must be .name, values. or .name, values, label of the axis."),
        ({"method": {"PBD": dincl.PBD}, "limits": [v.Limit("2", 2.0, ["XPBD"])]}, "'XPBD': must be among PBD"),
        ({"limits": [v.Limit("1/0", lambda x: x / 0)]}, "limits: '1/0' at x = .*: ZeroDivisionError"),
        ({"x": ("outcome", [0.1])}, "x = .*: must have another name than"),
        ({"t": [1.0, 0.5]}, "t = .*: must be one or more increasing times"),
        ({"t": "late"}, "t = 'late': must be"),
    ],
)
def test_maps_of_nothing_are_named(changes, message):
    given = {"problem": WALL, "method": dincl.PBD, "x": ("dt", [0.1]), "y": ("dt", [0.1]), "t": [1.0]} | changes
    with pytest.raises(dincl.InvalidProblem, match=message):
        v.stability_map(**given)
