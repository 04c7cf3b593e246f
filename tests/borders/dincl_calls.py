"""The public functions and constructors of dincl, with values that are right."""

import numpy as np
from scipy.sparse import csr_array

import dincl
from dincl import drifts, geometry, scenes
from tests.borders.harness import Call

X0 = ([[0.0, 1.0], [3.0, 1.0]], np.array([[0.5, 1.0], [2.0, 3.0]]))
DRIFTS = (lambda t, x: -x, lambda t, x: 0.0 * x, lambda t, x: x - x**3, drifts.constant((0.1, -1.0)))
NUMBER, POSITIVE, NATURAL = (0.0, 0.5, -1.5, 2), (0.5, 1, 1e-3), (1, 2, 3, 5)
RADIUS, FLAG, LIMIT = (0.5, [0.5, 0.25], 1e-3), (True, False), (50, 500)
FLOOR = dincl.Smooth(lambda x: x[:, 1], lambda x: np.stack((np.eye(4)[1], np.eye(4)[3])))
SETS = (
    *(dincl.NonOverlap(0.5), dincl.HalfSpace((0, 1)), dincl.MaxDistance([(0, 1)], 9.0), dincl.OutsideBall((0, -5), 1)),
    *(
        FLOOR,
        dincl.Moving(dincl.HalfSpace((0, 1), -2.0), lambda t: np.array([0.0, 0.1 * t])),
        dincl.InsideBall((0, 0), 9),
    ),
)
LISTS = ((), [SETS[0]], list(SETS[:2]), [FLOOR], [SETS[5], SETS[0]], (SETS[6],))
PROJECTIONS = tuple(kind(1e-8) for kind in (dincl.ActiveSet, dincl.Daqp, dincl.Piqp, dincl.Clarabel, dincl.ProjectedCG))
STEPS = tuple(kind(0.1, PROJECTIONS[0]) for kind in (dincl.CatchUp, dincl.LinearisedCatchUp, dincl.MidpointCatchUp))
SCHEMES = (dincl.PBD(0.1), dincl.SecondOrderPBD(0.1), dincl.Penalty(0.1, 1.0), dincl.EventDriven(1e-6), *STEPS)
STOPS = (dincl.Stationary(1e-6), dincl.RelativeMove(1e-6))
PROBLEMS = (*(dincl.Problem(X0[0], DRIFTS[0], sets) for sets in LISTS), scenes.four_disks())
MINIMISERS = (
    dincl.ArrowHurwicz(0.1, 0.1, STOPS[0], limit=100),
    dincl.DampedArrowHurwicz(1.0, 1.0, 1.0, 1.0, 0.1, STOPS[0], limit=100),
)
RUN = dincl.solve(PROBLEMS[1], SCHEMES[0], [0.5, 1.0])
TIMES = ([1.0], [0.1, 0.3], 0.5, [0.0, 0.2])
AT = {"problem": PROBLEMS, "t": (0.0, 1.0), "x": X0, "tol": (1e-9, 0.6)}


def asked(problem, t, x, tol, u):
    """All that a normal cone is asked."""
    cone = geometry.normal_cone(problem, t, x, tol)
    return [cone.distance(u), cone.multipliers(u), cone.tangent_part(u)]


def solved(drift, constraints, scheme):
    """A problem of its own, solved: functions that fail at the start, or on the way."""
    return dincl.solve(dincl.Problem(X0[0], drift, constraints), scheme, [0.3])


def late(drift, at, scheme):
    """A drift that is another one from a time on."""
    problem = dincl.Problem(X0[0], lambda t, x: drift(t, x) if t >= at else -x, [SETS[0]])
    return dincl.solve(problem, scheme, [0.3], throw=False)


def smooth(g, jacobian, projection):
    """A set of the user's functions, projected onto."""
    problem = dincl.Problem(X0[0], DRIFTS[0], [dincl.Smooth(g, jacobian)])
    return dincl.project(problem, [[0.0, -1.0], [3.0, 1.0]], projection)


def carried(path, scheme):
    """A wall on the user's path."""
    problem = dincl.Problem(X0[0], DRIFTS[0], [dincl.Moving(dincl.HalfSpace((0, 1), -2.0), path)])
    return dincl.solve(problem, scheme, [0.3])


def nearest(c, A, b, equal=None, metric=None, projection=None):
    """A projection alone."""
    return dincl.NearestPoint(c, A, b, equal, metric).solve(projection)


def complementary(W, q, projection=None):
    """Its dual."""
    return dincl.Lcp(W, q).solve(projection)


PATHS = (lambda t: np.array([0.0, 0.1 * t]), lambda t: (0.0, 0.0))


CALLS = (
    Call("Problem", dincl.Problem, {"x0": X0, "drift": DRIFTS, "constraints": LISTS}, ("constraints",)),
    Call("NonOverlap", dincl.NonOverlap, {"radius": RADIUS, "among": ([0, 1], None)}, ("among",)),
    Call(
        "HalfSpace",
        dincl.HalfSpace,
        {"normal": ((0, 1), [1.0, 2.0]), "offset": NUMBER, "radius": RADIUS},
        ("offset", "radius"),
    ),
    Call("MaxDistance", dincl.MaxDistance, {"pairs": ([(0, 1)],), "length": POSITIVE}),
    Call("Ordered", dincl.Ordered, {"chain": ([0, 1], [2, 0, 1]), "axis": (0, 1)}),
    Call("InsideBall", dincl.InsideBall, {"centre": ((0, 1), [0.0]), "distance": RADIUS}),
    Call("OutsideBall", dincl.OutsideBall, {"centre": ((0, 1), [0.0]), "distance": RADIUS}),
    Call("Smooth", dincl.Smooth, {"g": (FLOOR.g,), "jacobian": (FLOOR.jacobian,)}),
    Call("Moving", dincl.Moving, {"constraint": SETS, "path": PATHS}),
    *(
        Call(kind.__name__, kind, {"tol": POSITIVE})
        for kind in (*map(type, PROJECTIONS[:-1]), dincl.Ipopt, dincl.CvxpyQP, dincl.EventDriven, dincl.Stationary)
    ),
    Call("RelativeMove", dincl.RelativeMove, {"eps": POSITIVE}),
    Call("PBD", dincl.PBD, {"dt": POSITIVE, "sweeps": NATURAL}, ("sweeps",)),
    *(Call(kind.__name__, kind, {"dt": POSITIVE, "projection": PROJECTIONS}) for kind in map(type, STEPS)),
    Call("Penalty", dincl.Penalty, {"dt": POSITIVE, "strength": POSITIVE, "exponent": (1, 2)}, ("exponent",)),
    Call("SecondOrderPBD", dincl.SecondOrderPBD, {"dt": POSITIVE, "v0": X0, "sweeps": NATURAL}, ("v0", "sweeps")),
    Call(
        "ArrowHurwicz",
        dincl.ArrowHurwicz,
        {"alpha": POSITIVE, "beta": POSITIVE, "stop": STOPS, "limit": LIMIT, "squared": FLAG},
        ("limit", "squared"),
    ),
    Call(
        "DampedArrowHurwicz",
        dincl.DampedArrowHurwicz,
        {**dict.fromkeys(("alpha", "beta", "gamma", "damping", "dtau"), POSITIVE), "stop": STOPS, "limit": LIMIT},
        ("limit",),
    ),
    Call("Uzawa", dincl.Uzawa, {"step": POSITIVE, "stop": STOPS[:1], "limit": LIMIT}, ("limit",)),
    Call("constant", drifts.constant, {"velocity": ((0.0, 1.0), X0[0])}),
    Call("attraction", drifts.attraction, {"centre": ((0.0, 1.0), 0), "rate": (1.0, [1.0, 2.0])}, ("rate",)),
    Call("swirl", drifts.swirl, {"centre": ((0.0, 1.0), 0), "rate": (1.0, [1.0, 2.0])}),
    Call("solve", dincl.solve, {"problem": PROBLEMS, "scheme": SCHEMES, "t": TIMES, "throw": FLAG}, ("throw",)),
    Call("solved", solved, {"drift": DRIFTS, "constraints": LISTS, "scheme": SCHEMES}),
    Call("late", late, {"drift": DRIFTS, "at": (0.05, 0.25), "scheme": SCHEMES}),
    Call("smooth", smooth, {"g": (FLOOR.g,), "jacobian": (FLOOR.jacobian,), "projection": PROJECTIONS[:3]}),
    Call("carried", carried, {"path": PATHS, "scheme": SCHEMES}),
    Call("path", RUN, {"t": (0.7, [0.1, 0.2])}),
    Call("project", dincl.project, {"problem": PROBLEMS, "y": X0, "projection": PROJECTIONS, "t": NUMBER}, ("t",)),
    Call(
        "minimise",
        dincl.minimise,
        {"problem": PROBLEMS, "minimiser": MINIMISERS, "throw": FLAG},
        ("throw",),
    ),
    Call(
        "NearestPoint",
        nearest,
        {
            "c": ([0.0, 1.0], (3, -1)),
            "A": (np.ones((1, 2)), [[1.0, 2.0], [3.0, 4.0]], csr_array([[0.0, 1.0], [1.0, 0.0]]), [[0.0, 0.0]]),
            "b": ([1.0], [1.0, 2.0], [0.0, -1.0]),
            "equal": (None, [True], [True, False]),
            "metric": (None, np.diag([1.0, 2.0]), csr_array([[2.0, 1.0], [1.0, 2.0]])),
            "projection": (None, *PROJECTIONS),
        },
        ("equal", "metric", "projection"),
    ),
    Call(
        "Lcp",
        complementary,
        {
            "W": ([[1.0]], np.diag([1.0, 2.0]), csr_array([[1.0, 1.0], [1.0, 1.0]]), [[0.0, 0.0], [0.0, 1.0]]),
            "q": ([-1.0], [1.0, -2.0], (-1, -1)),
            "projection": (None, *PROJECTIONS),
        },
        ("projection",),
    ),
    Call("normal_cone", geometry.normal_cone, AT),
    Call("cone", asked, {**AT, "u": X0}),
    Call("support", geometry.support, {**AT, "direction": X0, "radius": POSITIVE}, ("radius",)),
    Call("pile", scenes.pile, {"n": NATURAL, "seed": NATURAL}, ("seed",)),
    Call("ball_pile", scenes.ball_pile, {"n": NATURAL, "seed": NATURAL}, ("seed",)),
    Call("radii", dincl.shapes.radii, {"problem": PROBLEMS}),
    Call("shapes_at", dincl.shapes.shapes_at, {"problem": PROBLEMS, "t": NUMBER}),
)
