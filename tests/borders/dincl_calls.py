"""The public functions and constructors of dincl, with values that are right."""

import numpy as np
from scipy.sparse import csr_array

import dincl
from dincl import drifts, geometry, scenes
from tests.borders.harness import calls

X0 = ([[0.0, 1.0], [3.0, 1.0]], np.array([[0.5, 1.0], [2.0, 3.0]]))
DRIFTS = (lambda t, x: -x, lambda t, x: 0.0 * x, lambda t, x: x - x**3, drifts.constant((0.1, -1.0)))
NUMBER, POSITIVE, NATURAL, RADIUS = (0.0, 0.5, -1.5, 2), (0.5, 1, 1e-3), (1, 2, 3, 5), (0.5, [0.5, 0.25], 1e-3)
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


# Right values by the names of arguments; some functions have others.
POOL = {"problem": PROBLEMS, "scheme": SCHEMES, "projection": PROJECTIONS, "minimiser": MINIMISERS, "stop": STOPS}
POOL |= {"x0": X0, "x": X0, "y": X0, "u": X0, "v0": X0, "direction": X0, "drift": DRIFTS, "constraints": LISTS}
POOL |= {
    **dict.fromkeys(("dt", "tol", "eps", "alpha", "beta", "gamma", "damping", "dtau", "step", "strength"), POSITIVE)
}
POOL |= {"length": POSITIVE, "exponent": (1, 2), "limit": (50, 500), "at": (0.05, 0.25)}
POOL |= {**dict.fromkeys(("sweeps", "n", "seed"), NATURAL), "offset": NUMBER, "t": NUMBER, "radius": RADIUS}
POOL |= {"distance": RADIUS, "rate": (1.0, [1.0, 2.0]), "throw": (True, False), "squared": (True, False)}
POOL |= {"among": ([0, 1], None), "normal": ((0, 1), [1.0, 2.0]), "pairs": ([(0, 1)],), "chain": ([0, 1], [2, 0, 1])}
POOL |= {"axis": (0, 1), "centre": ((0.0, 1.0), 0), "velocity": ((0.0, 1.0), X0[0]), "g": (FLOOR.g,)}
POOL |= {"jacobian": (FLOOR.jacobian,), "constraint": SETS}
POOL |= {"path": (lambda t: np.array([0.0, 0.1 * t]), lambda t: (0.0, 0.0)), "c": ([0.0, 1.0], (3, -1))}
POOL |= {"b": ([1.0], [1.0, 2.0], [0.0, -1.0])}
POOL |= {"A": (np.ones((1, 2)), [[1.0, 2.0], [3.0, 4.0]], csr_array([[0.0, 1.0], [1.0, 0.0]]), [[0.0, 0.0]])}
POOL |= {"equal": (None, [True], [True, False]), "q": ([-1.0], [1.0, -2.0], (-1, -1))}
POOL |= {"metric": (None, np.diag([1.0, 2.0]), csr_array([[2.0, 1.0], [1.0, 2.0]]))}
POOL |= {"W": ([[1.0]], np.diag([1.0, 2.0]), csr_array([[1.0, 1.0], [1.0, 1.0]]), [[0.0, 0.0], [0.0, 1.0]])}
CENTRE, TIMES = {"centre": ((0, 1), [0.0])}, {"t": ([1.0], [0.1, 0.3], 0.5, [0.0, 0.2])}
AT, ANY = {"t": (0.0, 1.0), "tol": (1e-9, 0.6)}, {"projection": (None, *PROJECTIONS)}
CALLS = calls(
    POOL,
    *(dincl.Problem, dincl.NonOverlap, dincl.HalfSpace, dincl.MaxDistance, dincl.Ordered, dincl.Smooth, dincl.Moving),
    *((dincl.InsideBall, CENTRE), (dincl.OutsideBall, CENTRE)),
    *(*map(type, PROJECTIONS[:-1]), dincl.Ipopt, dincl.CvxpyQP, dincl.EventDriven, dincl.Stationary),
    *(dincl.RelativeMove, dincl.PBD, *map(type, STEPS), dincl.Penalty, dincl.SecondOrderPBD),
    *(dincl.ArrowHurwicz, dincl.DampedArrowHurwicz, (dincl.Uzawa, {"stop": STOPS[:1]})),
    *(drifts.constant, drifts.attraction, drifts.swirl, (dincl.solve, TIMES), solved, late, carried),
    *((smooth, {"projection": PROJECTIONS[:3]}), (RUN, {"t": (0.7, [0.1, 0.2])})),
    *(dincl.project, dincl.minimise, (nearest, ANY), (complementary, ANY)),
    *((geometry.normal_cone, AT), (asked, AT), (geometry.support, AT)),
    *(scenes.pile, scenes.ball_pile, dincl.shapes.radii, dincl.shapes.shapes_at),
)
