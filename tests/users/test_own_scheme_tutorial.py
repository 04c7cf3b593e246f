"""The tutorial about an own scheme, projection and constraint: its notebook runs, and what its text says is so."""

import numpy as np
import pytest

import dincl
from tests.pages import ROOT, play

pytestmark = pytest.mark.slow

PAGE = ROOT / "docs" / "tutorials" / "own_scheme.md"


@pytest.fixture(scope="module")
def own(tmp_path_factory):
    return play(PAGE, tmp_path_factory.mktemp("own_scheme"))


def test_scheme_has_the_orders_that_the_text_names(own):
    free = own["orders"](own["free"], np.exp(-1.0) * own["free"].x0, 1.0, own["heun"])
    contact = own["orders"](own["slide"], own["slide"].exact(2.0), 2.0, own["heun"])
    assert abs(free[-1] - 2) < 0.05
    assert abs(contact[-1] - 1) < 0.1


def test_the_scheme_with_memory_has_order_two_with_one_projection_a_step(own):
    for problem, exact, t in (
        (own["free"], np.exp(-1.0) * own["free"].x0, 1.0),
        (own["slide"], own["slide"].exact(2.0), 2.0),
    ):
        assert abs(own["orders"](problem, exact, t, own["bdf"])[-1] - 2) < 0.1
    path = dincl.solve(own["slide"], own["bdf"](0.1), t=[2.0])
    assert path.stats.solver_calls <= path.stats.steps


def test_the_compiled_scheme_is_marked_and_makes_twice_the_work_of_pbd(own):
    table = own["table"].set_index(["method", "setting"])
    assert table["compiled"].groupby("method").all().to_dict() == {"PBD": True, "HeunPBD": True, "HeunCatchUp": False}
    work = table["drift_evaluations"]
    assert (work["HeunPBD"] == 2 * work["PBD"]).all()


def test_own_back_end_finds_the_same_points(own):
    assert own["ours"].stats.back_ends == ("slsqp",)
    np.testing.assert_allclose(own["ours"].x, own["theirs"].x, atol=1e-5)


def test_own_constraint_goes_with_every_scheme(own):
    exact = dincl.solve(own["problem"], dincl.EventDriven(1e-8), t=[1.0])
    for scheme in own["schemes"]:
        path = dincl.solve(own["problem"], scheme, t=[1.0])
        np.testing.assert_allclose(path.x, exact.x, atol=0.1 if isinstance(scheme, dincl.Penalty) else 0.02)


def test_own_constraint_is_refused_in_words(own):
    ellipse = own["InsideEllipse"](2.0, 1.0)
    with pytest.raises(dincl.InvalidProblem, match="a = -1: must be a finite number > 0"):
        own["InsideEllipse"](-1, 1.0)
    with pytest.raises(dincl.InvalidProblem, match="in the plane"):
        dincl.Problem([[0.0]], lambda t, x: x, [ellipse])


def test_own_constraint_is_drawn(own):
    levels = [item for item in own["ax"].collections if hasattr(item, "levels")]
    assert len(levels) == 2
    top = max(path.vertices[:, 1].max() for path in levels[1].get_paths())
    assert top <= 1.0 + 1e-2


def test_what_is_no_scheme_is_named():
    class Forgetful(dincl.FixedStep):
        def stepper(self, problem):
            return Returns(problem)

    class Returns(dincl.Stepper):
        def step(self, t, h, state):
            return state.x

    problem = dincl.Problem([[1.0]], lambda t, x: -x)
    with pytest.raises(
        dincl.InvalidProblem, match=r"Returns.step returned array\(\[\[1.\]\]\): must be a dincl.StepState"
    ):
        dincl.solve(problem, Forgetful(0.1), t=[1.0])

    class Endless(dincl.Scheme):
        def run(self, problem, times):
            return times

    with pytest.raises(dincl.InvalidProblem, match=r"Endless.run returned array\(\[1.\]\): must be a RunOutcome"):
        dincl.solve(problem, Endless(), t=[1.0])


def test_what_is_no_constraint_is_named():
    class Rowless(dincl.Constraint):
        def check(self, count, d):
            pass

        def select(self, x, search_radius):
            return [1.0]

        def sweep_rows(self, x):
            raise NotImplementedError

    with pytest.raises(dincl.InvalidProblem, match=r"Rowless.select returned \[1.0\]: must be AffineRows"):
        dincl.Problem([[1.0]], lambda t, x: -x, [Rowless()])
