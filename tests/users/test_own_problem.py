"""The user: an own problem, an own scheme and an own back end, under every instrument."""

import numpy as np
import pytest
from scipy.optimize import nnls

import dincl
import verification as v
from dincl.projection import FeasibleSet, QpAnswer, QpSolver


def pressed(pull):
    """Three discs in a triangle whose floor rises, drawn to its middle and stirred."""
    floor, *sides = [dincl.HalfSpace((np.sin(a), np.cos(a)), offset=-1.3, radius=0.4) for a in (0.0, 2.1, 4.2)]
    walls = [dincl.NonOverlap(0.4), *sides, dincl.Moving(floor, lambda t: np.array([0.0, 0.1 * t]))]
    start = [[-0.45, 0.0], [0.0, -0.7], [0.45, 0.1]]
    return dincl.Problem(start, lambda t, x: -pull * x + np.sin(t) * x[:, ::-1], walls)


class Ldp(QpSolver):
    name = "nnls"

    def qp(self, matrix, least, multipliers, tol):
        p = nnls(np.vstack([matrix.toarray().T, least]), np.eye(matrix.shape[1] + 1)[-1])[0]
        return QpAnswer(matrix.toarray().T @ p / (1 - least @ p), p / (1 - least @ p), 1)


class Nnls(dincl.Projection):
    def solver(self):
        return Ldp(self.tol)


class Mine(dincl.FixedStep):
    def stepper(self, problem):
        return MyStepper(problem)


class MyStepper(dincl.Stepper):
    def __init__(self, problem):
        super().__init__(problem)
        self.set = FeasibleSet(problem, Nnls(tol=1e-10).solver(), self.work, linearised=False)

    def step(self, t, h, state):
        ahead = state.x + h * self.velocity(t + h / 2, state.x + h / 2 * self.velocity(t, state.x))
        return dincl.StepState(self.set.nearest(t + h, ahead, state.x, 2 * np.abs(ahead - state.x).max()).point)


def play():
    t, problem, known = [0.5, 1.0], pressed(2.0), v.reference(pressed(2.0), tol=1e-10)
    methods = {"PBD": dincl.PBD, "mine": Mine, "catch-up": lambda dt: dincl.CatchUp(dt, Nnls(tol=1e-10))}
    orders = v.order_study(problem, methods, [0.1 / 2**k for k in range(6)], t, known)
    chart = v.work_precision(problem, methods, [0.1 / 4**k for k in range(5)], t, known, budget=v.CpuSeconds(0.2))
    return orders, chart, v.stability_map(pressed, Mine, ("dt", [0.05, 0.2, 0.8]), ("pull", [1.0, 10.0]))


@pytest.fixture(scope="module")
def played():
    return play()


@pytest.mark.slow
def test_orders_of_own_and_built_in_schemes(played):
    fits = played[0].fits.set_index(["method", "error"])
    for label, order in (("PBD", 1.0), ("catch-up", 1.0), ("mine", 2.0)):
        low, high = fits.loc[(label, "largest"), ["low", "high"]]
        assert low < order + 0.1
        assert high > order - 0.1
        assert fits.loc[(label, "largest"), "slope"] == pytest.approx(order, abs=0.25)


@pytest.mark.slow
def test_chart_has_every_method(played):
    chart = played[1]
    assert set(chart.table.loc[chart.table["status"] == "SUCCESS", "method"]) == {"PBD", "mine", "catch-up"}
    assert chart.cheapest([1e-8])["cheapest"].tolist() == ["not reached"]


@pytest.mark.slow
def test_map_and_page(played, tmp_path):
    assert set(played[2].table["outcome"]) == {"bounded"}
    page = v.save(played, tmp_path).read_text("utf-8")
    assert page.count("<img") == 3


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
