"""Mobilities, equalities, periodic boxes and walls for some particles: exact solutions, formulas, what is invariant."""

import warnings
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest

import dincl
from dincl.drifts import constant, swirl
from dincl.steps.loop import Settings
from dincl.steps.stepper import CompiledStepper
from dincl.steps.sweeping import run_pbd

FIXED_STEP = {
    "PBD": (dincl.PBD, 1),
    "PBD, three sweeps": (lambda h: dincl.PBD(h, sweeps=3), 1),
    "XPBD": (lambda h: dincl.XPBD(h, sweeps=20), 1),
    "Penalty": (lambda h: dincl.Penalty(h, strength=0.25 / h), 1),
    "CatchUp": (lambda h: dincl.CatchUp(h, dincl.ActiveSet(1e-11)), 1),
    "LinearisedCatchUp": (lambda h: dincl.LinearisedCatchUp(h, dincl.ProjectedCG(1e-11)), 1),
    "MidpointCatchUp": (lambda h: dincl.MidpointCatchUp(h, dincl.ActiveSet(1e-11)), 2),
    "CatchUp by Daqp": (lambda h: dincl.CatchUp(h, dincl.Daqp(1e-9)), 1),
    "CatchUp by Piqp": (lambda h: dincl.CatchUp(h, dincl.Piqp(1e-8)), 1),
    "CatchUp by Ipopt": (lambda h: dincl.CatchUp(h, dincl.Ipopt(1e-8)), 1),
}
STATED = {"EventDriven": dincl.EventDriven(1e-9), "Auto": dincl.Auto(1e-5)}


def hangs(rod, **more):
    """A pendulum without inertia: b F along the tangent, so that the angle from below has phi' = -b sin phi."""
    x0 = np.array([[1.0, 2.0], [1.0 + np.sin(2.0), 2.0 - np.cos(2.0)]])
    return dincl.Problem(x0, constant((0.0, -1.0)), [rod], mobility=[0.0, 0.5], **more)


def hanging(t):
    phi = 2.0 * np.arctan(np.tan(1.0) * np.exp(-0.5 * t))
    return np.array([[1.0, 2.0], [1.0 + np.sin(phi), 2.0 - np.cos(phi)]])


def on_circle(x):
    return (x[1:] ** 2).sum(axis=1) - 2.0 * x[1, 0] - 4.0 * x[1, 1] + 4.0  # |X_1 - (1, 2)|^2 - 1


MOBILITY = np.array([1.0, 0.25, 2.0, 0.5])


def pushed():
    """Four discs on a line: gaps 0.5, 0.5 and 0; all are one cluster in the end, of velocity sum F / sum 1 / b."""
    x0 = np.array([[0.0], [1.5], [3.0], [4.0]])
    return dincl.Problem(x0, constant([[2.0], [0.0], [0.0], [-1.0]]), [dincl.NonOverlap(0.5)], mobility=MOBILITY)


def pushing(t):
    force, start = np.array([2.0, 0.0, 0.0, -1.0]), np.array([0.0, 1.5, 3.0, 4.0])
    x, now, clusters = start.copy(), 0.0, [[0], [1], [2, 3]]
    while True:
        v = np.zeros(4)
        for one in clusters:
            v[one] = force[one].sum() / (1.0 / MOBILITY[one]).sum()
        gaps = [(x[b[0]] - x[a[-1]] - 1.0, v[a[-1]] - v[b[0]]) for a, b in pairwise(clusters)]
        times = [gap / closing if closing > 0 else np.inf for gap, closing in gaps]
        k = int(np.argmin(times)) if times else 0
        if not times or now + times[k] > t:
            return (x + (t - now) * v)[:, None]
        x, now = x + times[k] * v, now + times[k]
        clusters[k : k + 2] = [clusters[k] + clusters[k + 1]]


def held():
    """A wall, an obstacle and a container, each for one of three particles that fall."""
    sets = [
        dincl.HalfSpace((0, 1), 0.25, radius=[0.25], particles=[1]),
        dincl.OutsideBall((4.0, -1.0), 0.5, particles=[2]),
        dincl.InsideBall((0.0, 1.0), [1.5], particles=[0]),
    ]
    return dincl.Problem([[0.0, 1.0], [2.0, 1.0], [4.0, 1.0], [6.0, 1.0]], constant((0.0, -1.0)), sets)


def holding(t):
    heights = np.maximum(1.0 - t, [-0.5, 0.5, -0.5, -np.inf])
    return np.column_stack((np.arange(4) * 2.0, heights))


EXACT = {
    "a pendulum with a rod": (lambda: hangs(dincl.Distance([(0, 1)], 1.0)), hanging),
    "a pendulum on a level set": (lambda: hangs(dincl.Smooth(on_circle, equality=True)), hanging),
    "a pendulum with a rod in a box": (lambda: hangs(dincl.Distance([(0, 1)], 1.0), box=(3.0, 2.5)), hanging),
    "a row of four": (pushed, pushing),
    "walls for some": (held, holding),
}


@pytest.mark.parametrize("scene", EXACT)
@pytest.mark.parametrize("name", FIXED_STEP)
def test_time_steps_converge_with_their_order(name, scene):
    make, order = FIXED_STEP[name]
    problem, exact = EXACT[scene][0](), EXACT[scene][1]
    errors = [np.abs(dincl.solve(problem, make(h), 1.9).final - exact(1.9)).max() for h in (0.04, 0.02, 0.01)]
    assert errors[-1] <= {"Penalty": 0.2, "MidpointCatchUp": 3e-4}.get(name, 0.03)
    assert errors[-1] <= 1e-9 or errors[0] / errors[-1] > 0.75 * 4.0**order


@pytest.mark.parametrize("scene", EXACT)
@pytest.mark.parametrize("name", STATED)
def test_stated_errors_hold(name, scene):
    problem, exact = EXACT[scene][0](), EXACT[scene][1]
    path = dincl.solve(problem, STATED[name], [0.3, 0.9, 1.9])
    wrong = [np.sqrt(((x - exact(t)) ** 2).sum(axis=1)).max() for t, x in zip(path.t, path.x, strict=True)]
    assert (np.array(wrong) <= path.error + 1e-13).all()
    assert (path.violation() <= path.error + 1e-13).all()


def crowd(d, n, seed, *, box):
    rng = np.random.default_rng(seed)
    side = int(np.ceil(n ** (1 / d)))
    grid = np.stack(np.meshgrid(*[np.arange(side)] * d, indexing="ij"), -1).reshape(-1, d)[:n]
    x0 = 1.1 * grid + rng.uniform(-0.04, 0.04, (n, d)) + rng.uniform(-5, 5, d)
    mobility = rng.choice([0.0, 0.1, 1.0, 3.0], n, p=[0.1, 0.3, 0.3, 0.3])
    mobility[0] = 1.0
    drift = constant(rng.normal(size=(n, d)) * 20.0)
    periods = np.full(d, 1.1 * side) if box else None
    return dincl.Problem(x0, drift, [dincl.NonOverlap(0.5)], mobility=mobility, box=periods)


def arrows(problem, x, i, j):
    arrow = x[i] - x[j]
    if problem.box is not None:
        arrow = arrow - problem.box * np.rint(arrow / problem.box)
    return arrow


@pytest.mark.parametrize("box", [False, True])
@pytest.mark.parametrize(("d", "n"), [(1, 9), (2, 10), (2, 130), (3, 120)])
def test_a_step_of_pbd_moves_both_ends_in_proportion_to_their_mobilities(d, n, box):
    problem = crowd(d, n, n + d, box=box)
    b, x = problem.mobility, problem.x0.copy()
    x += 0.01 * b[:, None] * problem.velocity(0.0, x)
    for i in range(n):
        for j in range(i):
            arrow = arrows(problem, x, i, j)
            length = np.sqrt(arrow @ arrow)
            if length < 1.0 and b[i] + b[j] > 0:
                move = (1.0 - length) / (b[i] + b[j]) * arrow / length
                x[i], x[j] = x[i] + b[i] * move, x[j] - b[j] * move
    for scheme in (dincl.PBD(0.01), dincl.XPBD(0.01)):
        assert np.abs(dincl.solve(problem, scheme, 0.01).final - x).max() < 1e-12


@pytest.mark.parametrize("box", [False, True])
@pytest.mark.parametrize("projection", [dincl.ActiveSet(1e-11), dincl.ProjectedCG(1e-10), dincl.Daqp(1e-10)])
def test_projections_are_those_of_the_metric_of_the_inverse_mobility(projection, box):
    """With y = x + h B F the nearest z has z - y = B A^T lambda, lambda >= 0, lambda g = 0 for the linearised rows."""
    problem, h = crowd(2, 40, 3, box=box), 0.004
    b, x = problem.mobility, problem.x0
    y = x + h * b[:, None] * problem.velocity(0.0, x)
    z = dincl.solve(problem, dincl.LinearisedCatchUp(h, projection), h).final
    push, moves = np.zeros_like(x), b > 0
    gaps, normals = [], []
    for i in range(len(x)):
        for j in range(i):
            arrow = arrows(problem, x, i, j)
            length = np.sqrt(arrow @ arrow)
            if length < 2.0:
                normal = np.zeros_like(x)
                normal[i], normal[j] = arrow / length, -arrow / length
                gaps.append(length - 1.0 + (normal * (z - x)).sum())
                normals.append(normal.ravel())
    gaps, normals = np.array(gaps), np.array(normals)
    push[moves] = (z - y)[moves] / b[moves, None]
    closed = gaps < 1e-7
    multipliers = np.linalg.lstsq((normals[closed] * np.repeat(moves, 2)).T, push.ravel(), rcond=None)[0]
    assert gaps.min() > -1e-8
    assert closed.sum() > 10
    assert multipliers.min() > -1e-7
    assert np.abs((multipliers @ normals[closed]) * np.repeat(moves, 2) - push.ravel()).max() < 1e-7
    assert (z[~moves] == x[~moves]).all()


SCHEMES = [*(make(0.002) for make, _ in FIXED_STEP.values()), dincl.EventDriven(1e-8), dincl.Auto(1e-4)]


@pytest.mark.parametrize("scheme", SCHEMES[:7] + SCHEMES[-2:], ids=lambda one: type(one).__name__)
def test_a_mobility_of_all_is_a_faster_clock(scheme):
    x0, sets = crowd(2, 20, 1, box=False).x0, [dincl.NonOverlap(0.5)]
    drift = swirl((0.0, 0.0), 1.0)
    heavy = dincl.solve(dincl.Problem(x0, drift, sets, mobility=3.0), scheme, 0.1).final
    plain = dincl.solve(dincl.Problem(x0, swirl((0.0, 0.0), 3.0), sets), scheme, 0.1).final
    assert np.abs(heavy - plain).max() < 1e-12


@pytest.mark.parametrize("d", [1, 2, 3])
@pytest.mark.parametrize("scheme", SCHEMES[:7] + SCHEMES[-2:], ids=lambda one: type(one).__name__)
def test_a_box_has_no_place_where_it_begins(scheme, d):
    problem = crowd(d, 30, d, box=True)
    slow = constant(problem.velocity(0.0, problem.x0) / 20.0)
    shift = np.linspace(0.3, 2.9, d) * problem.box
    here, there = (
        dincl.solve(
            dincl.Problem(x0, slow, problem.constraints, mobility=problem.mobility, box=problem.box), scheme, 0.2
        ).final
        for x0 in (problem.x0, problem.x0 + shift)
    )
    assert np.abs(there - shift - here).max() < (1e-9 if not isinstance(scheme, dincl.Auto) else 1e-4)
    far = here + problem.box * np.arange(30)[:, None]
    assert problem.violation(0.0, far) == pytest.approx(problem.violation(0.0, here), abs=1e-12)


@pytest.mark.parametrize("scheme", SCHEMES[:7] + SCHEMES[-2:], ids=lambda one: type(one).__name__)
def test_a_fixed_disc_is_an_obstacle_also_one_that_grows_or_is_carried(scheme):
    x0, drift = [[0.0, 1.2], [1.3, 1.0], [0.0, 0.0]], constant((0.2, -1.0))
    fixed = [dincl.NonOverlap(lambda t: 0.5 + 0.05 * t)]
    rest = [
        dincl.NonOverlap(lambda t: 0.5 + 0.05 * t, among=[0, 1]),
        dincl.OutsideBall((0.0, 0.0), lambda t: 1.0 + 0.1 * t, particles=[0, 1]),
    ]
    wall = dincl.Moving(dincl.HalfSpace((0.0, 1.0), -2.0, particles=[0, 1]), lambda t: np.array([0.0, 1.5 * t]))
    one = dincl.solve(dincl.Problem(x0, drift, [*fixed, wall], mobility=[0.4, 2.0, 0.0]), scheme, 1.0)
    other = dincl.solve(dincl.Problem(x0, drift, [*rest, wall], mobility=[0.4, 2.0, 0.0]), scheme, 1.0)
    exact = not isinstance(scheme, (dincl.PBD, dincl.Penalty, dincl.XPBD, dincl.Auto))
    near = 1e-7 if exact else 0.05 if isinstance(scheme, dincl.Penalty) else 0.02
    assert np.abs(one.final - other.final).max() < near
    assert one.violation().max() < near


PUSHED = [*SCHEMES[:3], *SCHEMES[4:7], dincl.AdaptiveCatchUp(1e-4), *SCHEMES[-2:]]
PUSHING = {
    "a wall that rises": (lambda: dincl.HalfSpace((0, 1), lambda t: 0.5 * t, 0.4, particles=[0]), 0.9),
    "a wall that is carried": (lambda: dincl.Moving(dincl.HalfSpace((0, 1), 0.0, 0.4), lambda t: (0.0, 0.5 * t)), 0.9),
    "an obstacle that grows": (lambda: dincl.OutsideBall((0.0, -0.5), lambda t: 0.9 + 0.5 * t, [0]), 0.9),
    "a container that shrinks": (lambda: dincl.InsideBall((0.0, 0.0), lambda t: 0.9 - 0.5 * t, [0]), 0.4),
}


@pytest.mark.parametrize("name", PUSHING)
@pytest.mark.parametrize("scheme", PUSHED, ids=lambda one: type(one).__name__)
def test_a_set_that_moves_pushes_a_heavy_particle_and_cannot_push_a_fixed_one(scheme, name):
    make, height = PUSHING[name]
    x0, drift = [[0.0, 0.5], [3.0, 30.0]], constant([(0.0, 0.0), (3.0, 0.0)])
    path = dincl.solve(dincl.Problem(x0, drift, [make()], mobility=[1e-6, 1.0]), scheme, 1.0)
    assert np.abs(path.final - [[0.0, height], [6.0, 30.0]]).max() < 1e-4
    path = dincl.solve(dincl.Problem(x0, drift, [make()], mobility=[0.0, 1.0]), scheme, 1.0, throw=False)
    assert path.final[0].tolist() == x0[0]
    swept = isinstance(scheme, (dincl.PBD, dincl.XPBD))  # these only state by how much
    assert path.violation().max() > 0.09 if swept else not path.status
    assert path.t[-1] == 1.0 if swept else path.t[-1] < 0.9


@pytest.mark.parametrize("scheme", PUSHED, ids=lambda one: type(one).__name__)
def test_rounding_between_a_fixed_particle_and_a_wall_does_not_matter(scheme):
    sets = [dincl.HalfSpace((0, 1), 0.2, radius=0.1), dincl.NonOverlap(0.2)]
    problem = dincl.Problem([[0.0, 0.3], [0.0, 0.75]], constant((0.0, -1.0)), sets, mobility=[0.0, 1.0])
    path = dincl.solve(problem, scheme, 1.0)
    assert 0.0 < problem.violation(0.0, problem.x0) < 1e-16
    assert np.abs(path.final - [[0.0, 0.3], [0.0, 0.7]]).max() < 0.05
    forces = path.forces(1.0)
    assert np.abs(forces.multiplier[forces.constraint == 1] - 1.0).max() < 1e-2
    assert (forces.constraint == 0).sum() == 1  # the fixed one touches the wall, too


LENGTHENS = dincl.Distance([(0, 1), (1, 2), (0, 2)], lambda t: [1.0, 1.0, 1.0 + 2.0 * t])  # than both others together
WALLS = [dincl.HalfSpace([side], lambda t, at=at: t + at) for side, at in ((1.0, -1.0), (-1.0, -2.0))]
TRIANGLE = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.75**0.5]]
IMPOSSIBLE = {
    "a triangle": (TRIANGLE, [LENGTHENS]),
    "a triangle that moves": (TRIANGLE, [dincl.Moving(LENGTHENS, lambda t: (0.0, 0.0))]),
    "a level beyond a wall": (
        [[0.0], [1.0]],
        [
            dincl.Smooth(lambda t, x: x[1] - 1.0 - t, equality=True),
            dincl.HalfSpace([-1.0], -2.0),
            dincl.Ordered([0, 1], 0),
        ],
    ),
    "a rod between walls": ([[0.0], [1.0]], [*WALLS, dincl.Distance([(0, 1)], 1.0)]),
    "walls around a rod": ([[0.0], [1.0]], [dincl.Distance([(0, 1)], 1.0), *WALLS]),
}


@pytest.mark.parametrize("name", IMPOSSIBLE)
@pytest.mark.parametrize("scheme", SCHEMES[:7], ids=lambda one: type(one).__name__)
def test_equalities_that_cannot_be_met_are_no_silent_success(scheme, name):
    x0, sets = IMPOSSIBLE[name]
    problem = dincl.Problem(x0, constant(np.zeros(len(x0[0]))), sets)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        path = dincl.solve(problem, scheme, 1.9, throw=False)
        before = dincl.solve(problem, scheme, 0.4)
    assert not path.status or "cannot be met together" in str(said[0].message)
    assert before.status is dincl.Status.SUCCESS
    assert not [one for one in said if "t = 0.4" in str(one.message)]


@pytest.mark.parametrize("level", [lambda t: 0.0, lambda t: t * (1.0 - t)], ids=["fixed", "moving"])
@pytest.mark.parametrize("scheme", [*SCHEMES[:7], SCHEMES[8]], ids=lambda one: type(one).__name__)
def test_an_equality_at_zero_is_not_said_to_be_off_by_rounding(scheme, level):
    problem = dincl.Problem([[0.0]], constant([0.7]), [dincl.Smooth(lambda t, x: x[0] - level(t), equality=True)])
    assert abs(dincl.solve(problem, scheme, 1.0).final[0, 0]) < 0.02  # of Penalty: 1.7 over its strength


def test_a_wall_must_not_turn_across_an_axis_that_repeats():
    wall = dincl.HalfSpace(lambda t: (0.0 if t < 0.5 else t, 1.0), -1.0)
    problem = dincl.Problem([[0.0, 0.0]], constant((0.0, -1.0)), [wall], box=(10.0, None))
    for scheme in (dincl.PBD(0.1), dincl.EventDriven(1e-6)):
        path = dincl.solve(problem, scheme, 1.0, throw=False)
        assert path.status is dincl.Status.CONSTRAINT_FAILED
        assert "must not cross an axis that repeats" in path.detail


def test_an_order_holds_along_an_axis_of_a_box_that_does_not_repeat():
    crossing = constant([[1.0, 1.0], [1.0, -1.0]])
    problem = dincl.Problem([[0.0, 0.0], [0.0, 1.0]], crossing, [dincl.Ordered([0, 1], 1)], box=(9.0, None))
    assert dincl.solve(problem, dincl.EventDriven(1e-9), 2.0).final == pytest.approx(np.array([[2.0, 0.5], [2.0, 0.5]]))


@pytest.mark.parametrize("box", [False, True])
@pytest.mark.parametrize("d", [2, 3])
def test_sets_that_are_functions_of_time_are_tabulated_with_mobilities_and_boxes_too(d, box):
    problem = crowd(d, 27, d, box=box)
    grow = [dincl.NonOverlap(lambda t: 0.5 + 0.01 * np.sin(3.0 * t))]
    drift = constant(problem.velocity(0.0, problem.x0) / 20.0)
    problem = dincl.Problem(problem.x0, drift, grow, mobility=problem.mobility, box=problem.box)
    path = dincl.solve(problem, dincl.EventDriven(1e-7), [0.2, 0.4])
    other = dincl.solve(problem, dincl.MidpointCatchUp(2e-4, dincl.ActiveSet(1e-11)), [0.2, 0.4])
    assert path.stats.callbacks == other.stats.callbacks == 0
    assert len(path.events) > 5
    assert np.abs(path.x - other.x).max() < 5e-4


def test_second_order_pbd_takes_velocities_of_the_user():
    problem = dincl.Problem([[0.0, 1.0], [5.0, 1.0]], constant((0.0, -2.0)), mobility=[0.25, 0.0])
    path = dincl.solve(problem, dincl.SecondOrderPBD(1e-3, v0=[[1.0, 2.0], [3.0, 3.0]]), [1.0])
    assert np.abs(path.final - [[1.0, 1.0 + 2.0 - 0.25], [5.0, 1.0]]).max() < 1e-3


@dataclass(frozen=True)
class OfPlainDiscs(dincl.FixedStep):
    """A scheme of a user, whose kernel reads neither mobilities nor a box."""

    def stepper(self, problem):
        return CompiledStepper.sweeping(problem, run_pbd, Settings())


@pytest.mark.parametrize("more", [{"mobility": [1.0, 0.5]}, {"box": (9.0, None)}])
def test_a_kernel_of_plain_discs_is_refused(more):
    x0, sets = np.array([[0.0, 1.0], [3.0, 1.0]]), [dincl.NonOverlap(0.5), dincl.HalfSpace((0, 1))]
    plain = dincl.Problem(x0, swirl((0.0, 0.0), 1.0), sets)
    assert np.array_equal(*(dincl.solve(plain, one, [1.0]).x for one in (OfPlainDiscs(0.1), dincl.PBD(0.1))))
    with pytest.raises(dincl.InvalidProblem, match="of_any"):
        dincl.solve(dincl.Problem(x0, plain.drift, sets, **more), OfPlainDiscs(0.1), [1.0])


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda x: dincl.Problem(x, constant((0.0, 0.0)), mobility=-1.0), "mobility = -1.0: must be one number"),
        (lambda x: dincl.Problem(x, constant((0.0, 0.0)), mobility=[1.0]), "mobility has 1 entries"),
        (lambda x: dincl.Problem(x, constant((0.0, 0.0)), mobility=0.0), "mobility = 0.0: must be > 0 for at least"),
        (lambda x: dincl.Problem(x, constant((0.0, 0.0)), mobility=[1.0, np.nan]), "mobility"),
        (lambda x: dincl.Problem(x, constant((0.0, 0.0)), box=(1.0,)), r"box = \(1.0,\): must be 2 numbers"),
        (lambda x: dincl.Problem(x, constant((0.0, 0.0)), box=(1.0, -2.0)), r"box\[1\] = -2.0"),
        (lambda x: dincl.Problem(x, constant((0.0, 0.0)), [dincl.NonOverlap(0.5)], box=(1.9, None)), "radius: .* half"),
        (
            lambda x: dincl.Problem(x, constant((0.0, 0.0)), [dincl.HalfSpace((1, 1))], box=(9.0, None)),
            "normal = .*wall",
        ),
        (lambda x: dincl.Problem(x, constant((0.0, 0.0)), [dincl.Ordered([0, 1], 0)], box=(9.0, None)), "axis = 0"),
        (
            lambda x: dincl.Problem(x, constant((0.0, 0.0)), [dincl.Ordered([0, 1], 2)], box=(9.0, 9.0)),
            "axis = 2.*d = 2",
        ),
        (lambda x: dincl.Distance([(0, 1), (1, 0)], 1.0), "each pair at most once"),
        (
            lambda x: dincl.Problem(x, constant((0.0, 0.0)), [dincl.Distance([(0, 1)], 1.5)]),
            "Distance by 1.5 at",
        ),
        (lambda x: dincl.HalfSpace((0, 1), particles=[0, 0]), "particles = .*at most once"),
        (lambda x: dincl.Problem(x, constant((0.0, 0.0)), [dincl.HalfSpace((0, 1), particles=[2])]), "particles = 2"),
        (lambda x: dincl.Smooth(lambda x: x[:, 0], equality="yes"), "equality"),
    ],
)
def test_one_clear_message(make, words):
    with pytest.raises(dincl.InvalidProblem, match=words):
        make(np.array([[0.0, 1.0], [3.0, 1.0]]))
