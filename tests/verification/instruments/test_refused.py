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
            "errors = .*: must be one or more of largest, final, L2, dense, overlap, stated, output times, or",
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


WALL = dincl.Problem([[2.0, 1.0]], lambda t, x: -x, [dincl.HalfSpace((0, 1), radius=0.5)])
STEPS = [0.1 / 2**k for k in range(5)]


class OwnError(Exception):
    """An error that no library knows."""


def raising(error):
    def run(*_):
        raise error

    return run


ERRORS = [
    KeyError("k"),
    TypeError("k"),
    OSError("k"),
    AssertionError("k"),
    OwnError("k"),
    ValueError("k"),
    MemoryError("k"),
]


@pytest.mark.parametrize("error", ERRORS, ids=lambda one: type(one).__name__)
def test_a_method_that_raises_is_a_row_and_the_others_keep_theirs(error):
    """Test programs, functions that make schemes, and schemes, in all four instruments."""
    known = v.reference(WALL, tol=1e-9)([0.5, 1.0])

    class Broken(dincl.Scheme):
        def run(self, problem, times, span):
            raise error

    words = f"{type(error).__name__}: {error}"
    good = v.Method("good", scheme=dincl.PBD)
    bad = [
        v.Method("program", run=raising(error)),
        v.Method("maker", scheme=raising(error)),
        v.Method("scheme", scheme=lambda dt: Broken()),
    ]
    for result in (
        v.order_study(WALL, [good, *bad], STEPS, [0.5, 1.0], known),
        v.work_precision(WALL, [good, *bad], STEPS, [0.5, 1.0], known, v.CpuSeconds(1.0)),
    ):
        status = result.table.groupby("method")["status"].agg(set)
        assert status.to_dict() == {"good": {"SUCCESS"}} | {one.label: {"FAILED"} for one in bad}
        assert set(result.table.loc[result.table["status"] == "FAILED", "detail"]) == {words}
    advice = v.recommend(WALL, 1e-2, [0.5, 1.0], [good, *bad])
    assert advice.best == "good"
    assert all(words in why for why in advice.table.set_index("method").loc[[one.label for one in bad], "why"])
    for method in bad[1:]:
        cells = v.stability_map(lambda q: WALL, method.scheme, ("h", [0.1]), ("q", [1.0]), [1.0]).table
        assert cells[["outcome", "status", "detail"]].to_numpy().tolist() == [["refused", "FAILED", words]]
    made = v.stability_map(raising(error), dincl.PBD, ("dt", [0.1]), ("dt", [0.1]), [1.0]).table
    assert made["detail"].tolist() == [words]


class Mute(RuntimeError):
    def __str__(self):
        raise RuntimeError("no words")


@pytest.mark.parametrize(
    ("error", "words"), [(Mute(), "an error without a message"), (ValueError("\ud800"), "\\ud800")]
)
def test_an_error_whose_message_cannot_be_printed_is_a_row(error, words):
    known = v.reference(WALL, tol=1e-9)([0.5, 1.0])
    methods = [v.Method("good", scheme=dincl.PBD), v.Method("bad", run=raising(error))]
    study = v.order_study(WALL, methods, STEPS, [0.5, 1.0], known)
    assert set(study.table.loc[study.table["status"] == "FAILED", "detail"]) == {f"{type(error).__name__}: {words}"}


@pytest.mark.parametrize("stop", [KeyboardInterrupt, SystemExit])
def test_what_means_to_stop_a_study_stops_it(stop):
    with pytest.raises(stop):
        v.order_study(WALL, [v.Method("a", run=raising(stop()))], STEPS, [1.0], v.reference(WALL, tol=1e-9))
    with pytest.raises(stop):
        v.stability_map(WALL, raising(stop()), ("h", [0.1]), ("h", [0.1]), [1.0])


@pytest.mark.parametrize("made", [None, dincl.PBD, 3, "PBD"])
def test_a_function_that_makes_no_scheme_is_refused_everywhere(made):
    def maker(dt):
        return made

    advice = v.recommend(WALL, 1e-2, [1.0], {"good": dincl.PBD, "bad": maker}).table.set_index("method")
    assert "must make a dincl.Scheme" in advice.loc["bad", "why"]
    cells = v.stability_map(WALL, maker, ("dt", [0.1]), ("dt", [0.1]), [1.0]).table
    assert cells["outcome"].tolist() == ["refused"]
    assert "must make a dincl.Scheme" in cells["detail"][0]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"x": ("dt", [])}, r"dt = \[\]: must be one or more numbers"),
        ({"x": ("dt", {0.1})}, r"dt = \{0.1\}: must be one or more numbers"),
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


@pytest.mark.parametrize(
    ("reference", "message"),
    [
        (lambda t: v.reference(WALL, 1e-9)([0.1, 0.2]), "times = .* must be among the times of the reference"),
        (lambda t: v.reference(WALL, 1e-9)([0.5]), "times = .* must be among the times of the reference"),
        (lambda t: v.Known(t, np.ones((2, 1, 2)), np.full(2, np.nan)), "error = .* must be 2 finite numbers >= 0"),
        (lambda t: v.Known(t, np.ones((2, 1, 2)), np.full(2, -1e-9)), "error = .* must be 2 finite numbers >= 0"),
        (lambda t: v.Known(t, np.ones((2, 1, 2)), np.full(2, np.inf)), "error = .* must be 2 finite numbers >= 0"),
        (lambda t: v.Known(t, np.full((2, 1, 2), np.nan), np.zeros(2)), "must be a finite state for each of 2 times"),
        (lambda t: v.Known(t[::-1], np.ones((2, 1, 2)), np.zeros(2)), "must be increasing times"),
        (lambda t: np.full((2, 1, 2), np.nan), "reference = nan"),
        (lambda t: {}["k"], "reference = .* raised KeyError: 'k'"),
        (lambda t: None, "reference = None"),
    ],
)
def test_a_reference_to_another_question_is_refused(reference, message):
    with pytest.raises(dincl.InvalidProblem, match=message):
        v.order_study(WALL, {"PBD": dincl.PBD}, STEPS, [0.5, 1.0], reference)


def test_a_known_at_other_times_is_refused():
    known = v.reference(WALL, 1e-9)([0.5, 0.9])
    with pytest.raises(dincl.InvalidProblem, match="must be among the times of the reference"):
        v.order_study(WALL, {"PBD": dincl.PBD}, STEPS, [0.5, 1.0], known)


def test_a_quantity_that_raises_is_named():
    with pytest.raises(dincl.InvalidProblem, match="errors: 'height' raised IndexError"):
        v.order_study(
            WALL, {"PBD": dincl.PBD}, STEPS, [1.0], v.reference(WALL, 1e-9), errors={"height": lambda x: x[7]}
        )
