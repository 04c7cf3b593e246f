"""A constraint written outside of the package works with everything, as if it were one of the package."""

import re
from pathlib import Path

import numpy as np
import pytest

import dincl
from tests.dincl.catalog import PROJECTIONS, SCHEMES
from tests.dincl.own_constraints import InBall, InEllipse, InEllipseByRows

AXES = (2.0, 1.2)
START = np.array([[0.1, 0.0], [1.1, 0.2], [-0.6, 0.8]])
DISCS = dincl.NonOverlap(0.4)
ALL = [*SCHEMES, pytest.param(lambda dt: dincl.EventDriven(1e-9), id="EventDriven")]
MINIMISERS = [
    dincl.ArrowHurwicz(0.05, 0.5, dincl.Stationary(1e-6), limit=400),
    dincl.DampedArrowHurwicz(0.05, 0.2, 0.4, 2.0, 1.0, dincl.Stationary(1e-6), limit=400, squared=True),
    dincl.Uzawa(0.2, dincl.Stationary(1e-6), limit=40),
]


def smooth(axes):
    """The ellipse from the functions of InEllipse."""
    own = InEllipse(axes)
    return dincl.Smooth(own.values, own.jacobian)


def path(t):
    return (0.6 * np.sin(2 * t), 0.3 * t)


def at_rest(constraint):
    return constraint


def moving(constraint):
    return dincl.Moving(constraint, path)


def problem(constraint):
    """Three discs that leave for the right, up or down."""
    return dincl.Problem(
        START, lambda t, x: np.array([[1.0, 0.3], [2.0, 0.0], [1.0, -0.5]]) - x / 9, [DISCS, constraint]
    )


@pytest.mark.slow_with("moving-XPBD", "moving-EventDriven")
@pytest.mark.parametrize("make", ALL)
@pytest.mark.parametrize("placed", [at_rest, moving])
@pytest.mark.parametrize(("own", "same"), [(InEllipse(AXES), smooth(AXES)), (InEllipseByRows(AXES), smooth(AXES))])
def test_every_scheme_takes_it(make, placed, own, same):
    """Values and Jacobian give the very bits of Smooth; rows of an own kind round in another order."""
    found, expected = (dincl.solve(problem(placed(one)), make(0.02), t=[0.5, 1.5]) for one in (own, same))
    inside = 1 - (((expected.final - (np.array(path(1.5)) if placed is moving else 0.0)) / AXES) ** 2).sum(axis=1)
    assert inside.min() < 0.05
    if type(own) is InEllipse:
        assert found.x.tobytes() == expected.x.tobytes()
        assert found.stats == expected.stats
    assert found.x == pytest.approx(expected.x, abs=1e-8)


@pytest.mark.slow_with("moving-EventDriven")
@pytest.mark.parametrize("make", ALL)
@pytest.mark.parametrize("placed", [at_rest, moving])
def test_own_exact_projections_agree_with_those_of_the_package(make, placed):
    sets = InBall(1.5), dincl.InsideBall((0.0, 0.0), 1.5)
    found, expected = (dincl.solve(problem(placed(one)), make(0.02), t=[0.5, 1.5]) for one in sets)
    assert np.abs(expected.final - problem(sets[1]).x0).max() > 0.3
    assert found.x == pytest.approx(expected.x, abs=1e-8)


@pytest.mark.parametrize("make", PROJECTIONS)
@pytest.mark.parametrize("own", [InEllipse(AXES), InEllipseByRows(AXES)])
def test_every_projection_takes_it(make, own):
    y = START + np.array([[0.0, 0.1], [1.3, 0.4], [-0.5, 0.3]])
    found, expected = (dincl.project(problem(one), y, make(1e-9)) for one in (own, smooth(AXES)))
    assert found.residual <= 1e-9
    assert np.abs(found.point - y).max() > 0.1
    assert found.point == pytest.approx(expected.point, abs=1e-8)


@pytest.mark.parametrize("minimiser", MINIMISERS, ids=lambda m: type(m).__name__)
@pytest.mark.parametrize("own", [InEllipse(AXES), InEllipseByRows(AXES)])
def test_every_minimiser_takes_it(minimiser, own):
    target = np.array([[3.0, 0.5], [0.5, 2.0], [-3.0, 0.0]])
    found, expected = (
        dincl.minimise(dincl.Problem(START, lambda t, x: target - x, [DISCS, one]), minimiser, throw=False)
        for one in (own, smooth(AXES))
    )
    assert found.status is expected.status
    assert found.x == pytest.approx(expected.x, abs=1e-9)
    assert len(found.reactions()) == 3


def test_geometry_takes_it():
    x = np.array([[2.0, 0.0], [0.0, 0.3], [0.0, -1.2]])
    found, expected = (
        dincl.geometry.normal_cone(problem(one), 0.0, x, 1e-9) for one in (InEllipse(AXES), smooth(AXES))
    )
    assert found.generators.tolist() == expected.generators.tolist() != []
    assert found.names == ((1, "row 0 of InEllipse.values"), (1, "row 2 of InEllipse.values"))


def test_it_needs_values_and_jacobian():
    class Half(dincl.DifferentiableConstraint):
        def values(self, x):
            return x[:, 0]

    with pytest.raises(TypeError, match="jacobian"):
        Half()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"values": lambda self, x: x}, r"Bad.values returned an array of shape \(3, 2\): must be .* of shape \(n,\)"),
        ({"values": lambda self, x: x[:, 7]}, r"Bad.values\(.*\) raised IndexError"),
        ({"values": lambda self, x: x[:, 0] - 9.0}, "x0 violates Bad by 9.6 at row 2 of Bad.values"),
        (
            {"jacobian": lambda self, x: np.zeros(5)},
            r"Bad.jacobian returned an array of shape \(5,\): must be real numbers of shape \(3, 6\)",
        ),
    ],
)
def test_what_is_wrong_is_told_by_its_name(change, message):
    bad = type("Bad", (InEllipse,), change)
    with pytest.raises(dincl.InvalidProblem, match=message):
        problem(bad(AXES))


def test_the_page_for_those_who_add_one_runs():
    page = (Path(__file__).parents[2] / "docs/extend/constraint.md").read_text()
    scope = {}
    for block in re.findall(r"^```python\n(.*?)^```", page, flags=re.MULTILINE | re.DOTALL):
        exec(block, scope)
    assert scope["path"].status is dincl.Status.SUCCESS
    assert scope["path"].violation().max() < 1e-3
    # Without the bowl, which comes from the left, the discs would rest on both sides of the origin.
    assert scope["path"].final[:, 0].min() > -0.01
