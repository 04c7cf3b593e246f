"""Bad input gives one clear error that names the argument, its value and what is allowed; never anything else."""

import math

import numpy as np
import pytest
from scipy.sparse import csr_array

import dincl
import meanfield

ONE = [[0.0, 1.0]]
APART = [[0.0, 1.0], [3.0, 1.0]]


def rest(t, x):
    return np.zeros_like(x)


def problem(x0=APART, drift=rest, constraints=()):
    return dincl.Problem(x0=x0, drift=drift, constraints=constraints)


def own(**functions):
    """A problem with a set of the user's own, one of whose functions is wrong."""
    right = {"values": lambda self, x: x[:, 0] + 1.0, "jacobian": lambda self, x: [[1, 0, 0, 0], [0, 0, 1, 0]]}
    return problem(constraints=[type("Own", (dincl.DifferentiableConstraint,), right | functions)()])


BAD_PROBLEMS = {
    "x0 flat": (lambda: problem(x0=[0.0, 1.0]), r"x0 of shape \(2,\).*\(N, d\)"),
    "x0 empty": (lambda: problem(x0=np.zeros((0, 2))), r"x0 of shape \(0, 2\)"),
    "x0 infinite": (lambda: problem(x0=[[math.inf, 0.0]]), r"x0 = inf at index \(0, 0\)"),
    "x0 too large": (lambda: problem(x0=[[1e101, 0.0]]), r"x0 = 1e\+101.*1e\+100"),
    "overlap": (
        lambda: problem(x0=[[0.0, 0.0], [0.5, 0.0]], constraints=[dincl.NonOverlap(0.5)]),
        "x0 violates NonOverlap by 0.5 at particle 1 and 0",
    ),
    "coincident": (
        lambda: problem(x0=[[0.0, 0.0], [0.0, 0.0]], constraints=[dincl.NonOverlap(0.5)]),
        "x0 violates NonOverlap by 1 at particle 1 and 0",
    ),
    "below the wall": (
        lambda: problem(constraints=[dincl.HalfSpace((0, 1), offset=1.5)]),
        "x0 violates HalfSpace by 0.5 at particle 0",
    ),
    "too far": (
        lambda: problem(constraints=[dincl.MaxDistance([(0, 1)], 2.0)]),
        "MaxDistance by 1 at particle 0 and 1",
    ),
    "wrong order": (lambda: problem(constraints=[dincl.Ordered([1, 0], axis=0)]), "Ordered by 3 at particle 0 and 1"),
    "in the obstacle": (
        lambda: problem(constraints=[dincl.OutsideBall((0, 1), 0.5)]),
        "OutsideBall by 0.5 at particle 0",
    ),
    "out of the container": (
        lambda: problem(constraints=[dincl.InsideBall((0, 1), 0.5)]),
        "InsideBall by 2.5 at particle 1",
    ),
    "g negative": (
        lambda: problem(constraints=[dincl.Smooth(lambda x: np.array([1.0, -2.0]), lambda x: np.zeros((2, 4)))]),
        "Smooth by 2 at row 1 of g",
    ),
    "g of a wrong shape": (
        lambda: problem(constraints=[dincl.Smooth(lambda x: x, lambda x: x)]),
        r"constraints\[0\]: g returned an array of shape \(2, 2\)",
    ),
    "g that raises": (
        lambda: problem(constraints=[dincl.Smooth(lambda x: x[9], lambda x: x)]),
        r"constraints\[0\]: g\(x of shape \(2, 2\)\) raised IndexError",
    ),
    "g not callable": (lambda: dincl.Smooth(3.0, lambda x: x), "g = 3.0"),
    "radius zero": (lambda: dincl.NonOverlap(radius=0.0), "radius = 0.0: must be .*> 0"),
    "radius negative": (lambda: dincl.NonOverlap(radius=[0.5, -0.5]), r"radius = .*-0.5.*> 0"),
    "radii too few": (lambda: problem(constraints=[dincl.NonOverlap([0.5] * 3)]), "radius has 3 entries.*2 particles"),
    "among twice": (lambda: dincl.NonOverlap(0.5, among=[1, 0, 1]), r"among = \[1, 0, 1\]: must name each .* once"),
    "among text": (lambda: dincl.NonOverlap(0.5, among="all"), "among = 'all': must be integers"),
    "among index": (lambda: problem(constraints=[dincl.NonOverlap(0.5, among=[2])]), "among = 2: .*below .* 2"),
    "radii for among": (
        lambda: problem(constraints=[dincl.NonOverlap([1, 1], among=[0])]),
        "radius has 2 .* 1 particles",
    ),
    "wall radius": (lambda: dincl.HalfSpace((0, 1), radius=-1.0), "radius = -1.0"),
    "normal zero": (lambda: dincl.HalfSpace(normal=(0, 0)), r"normal = \(0, 0\)"),
    "normal of wrong d": (lambda: problem(constraints=[dincl.HalfSpace((0, 0, 1))]), r"normal of shape \(3,\)"),
    "offset infinite": (lambda: dincl.HalfSpace((0, 1), offset=-math.inf), "offset = -inf"),
    "pair index": (lambda: problem(constraints=[dincl.MaxDistance([(0, 2)], 9.0)]), "pairs = 2: .*below .* 2"),
    "pair with itself": (lambda: dincl.MaxDistance([(0, 1), (1, 1)], 9.0), r"pairs\[1\] = \[1, 1\]"),
    "pair of three": (lambda: dincl.MaxDistance([(0, 1, 2)], 9.0), "pairs"),
    "length zero": (lambda: dincl.MaxDistance([(0, 1)], 0.0), "length = 0.0"),
    "lengths too many": (lambda: dincl.MaxDistance([(0, 1)], [1.0, 2.0]), "length has 2 entries.*1 pairs"),
    "chain index": (lambda: problem(constraints=[dincl.Ordered([0, 5], axis=0)]), "chain = 5"),
    "chain twice": (lambda: dincl.Ordered([0, 1, 0], axis=0), r"chain = \[0, 1, 0\]"),
    "axis": (lambda: problem(constraints=[dincl.Ordered([0, 1], axis=2)]), "axis = 2.*d = 2"),
    "centre": (lambda: problem(constraints=[dincl.OutsideBall((9.0,), 1.0)]), r"centre of shape \(1,\)"),
    "moving what is no set": (lambda: dincl.Moving(1.0, lambda t: 0), "constraint = 1.0: must be a Constraint"),
    "path of a wrong shape": (
        lambda: problem(constraints=[dincl.Moving(dincl.HalfSpace((0, 1)), lambda t: 0.0)]),
        r"path\(0.0\) of shape \(\)",
    ),
    "path nan": (
        lambda: problem(constraints=[dincl.Moving(dincl.HalfSpace((0, 1)), lambda t: np.full(2, np.nan))]),
        r"path returned nan",
    ),
    "drift no function": (lambda: problem(drift=1.0), "drift = 1.0"),
    "drift of a wrong shape": (lambda: problem(drift=lambda t, x: x[0]), r"drift returned.*\(2,\).*\(2, 2\)"),
    "drift raises": (
        lambda: problem(drift=lambda t, x: x.no),
        r"drift\(t = 0, x of shape \(2, 2\)\) raised AttributeError",
    ),
    "drift writes x": (lambda: problem(drift=lambda t, x: x.__iadd__(1.0)), r"drift\(.*\) raised ValueError"),
    "constraints bare": (lambda: problem(constraints=dincl.NonOverlap(0.5)), "constraints = NonOverlap.*list"),
    "constraints of other things": (lambda: problem(constraints=["wall"]), r"constraints = \['wall'\]"),
    "path that turns": (
        lambda: problem(constraints=[dincl.Moving(dincl.HalfSpace((0, 1)), lambda t: np.eye(2))]),
        "path.* of shape .2, 2.*RigidMotion",
    ),
    "rotation of two": (
        lambda: problem(constraints=[dincl.Moving(dincl.HalfSpace((0, 1)), dincl.RigidMotion(lambda t: (0.1, 0.2)))]),
        "an angle, or a matrix",
    ),
    "rotation that stretches": (
        lambda: problem(
            constraints=[dincl.Moving(dincl.HalfSpace((0, 1)), dincl.RigidMotion(lambda t: np.eye(2) * (2 + t)))]
        ),
        "must be orthogonal",
    ),
    "rotation no function": (lambda: dincl.RigidMotion(0.3), "rotation"),
    "centre of a rotation": (
        lambda: problem(constraints=[dincl.Moving(dincl.HalfSpace((0, 1)), dincl.RigidMotion(abs, centre=(0, 0, 0)))]),
        "centre",
    ),
    "normal in time": (
        lambda: problem(constraints=[dincl.HalfSpace(lambda t: (0.0, 0.0, 1.0))]),
        "normal of shape .3,.",
    ),
    "radius in time": (lambda: problem(constraints=[dincl.NonOverlap(lambda t: -1.0)]), "radius"),
    "jacobian without time": (
        lambda: problem(constraints=[dincl.Smooth(lambda t, x: x[:, 1], lambda x: np.eye(2))]),
        r"must be a callable of \(t, x\), as g is",
    ),
    "values of a wrong shape": (
        lambda: own(values=lambda self, x: x),
        r"Own.values returned an array of shape \(2, 2\)",
    ),
    "values that raise": (lambda: own(values=lambda self, x: x[:, 7]), r"Own.values\(.*\) raised IndexError"),
    "values negative": (
        lambda: own(values=lambda self, x: x[:, 0] - 9.0),
        "x0 violates Own by 9 at row 0 of Own.values",
    ),
    "own jacobian": (
        lambda: own(jacobian=lambda self, x: np.zeros(5)),
        r"Own.jacobian returned an array of shape \(5,\): must be real numbers of shape \(2, 4\)",
    ),
    "sparse jacobian": (
        lambda: problem(constraints=[dincl.Smooth(lambda x: x[:, 1] + 0.5, lambda x: csr_array(np.ones((2, 3))))]),
        r"sparse matrix of shape \(2, 3\): must .* \(2, 4\)",
    ),
    "tol": (lambda: dincl.EventDriven(0.0), "tol = 0.0"),
    "tol too small": (lambda: dincl.Daqp(1e-101), "tol = 1e-101"),
    "tol of adaptive steps": (lambda: dincl.AdaptiveCatchUp(math.nan), "tol = nan"),
    "error": (lambda: dincl.Auto("small"), "error = 'small'"),
    "dt zero": (lambda: dincl.PBD(dt=0.0), "dt = 0.0: must be a finite number > 0"),
    "dt negative": (lambda: dincl.Penalty(dt=-0.1, strength=1.0), "dt = -0.1"),
    "dt text": (lambda: dincl.PBD(dt="0.1"), "dt = '0.1'"),
    "sweeps": (lambda: dincl.PBD(dt=0.1, sweeps=0), "sweeps = 0: must be an integer from 1 to 1000000"),
    "compliance": (lambda: dincl.XPBD(dt=0.1, compliance=-1.0), "compliance = -1.0: must be a finite number >= 0"),
    "strength": (lambda: dincl.Penalty(dt=0.1, strength=math.inf), "strength = inf"),
    "exponent": (lambda: dincl.Penalty(dt=0.1, strength=1.0, exponent=3), "exponent = 3: must be an integer from 1"),
    "projection by name": (lambda: dincl.CatchUp(dt=0.1, projection="ipopt"), "projection = 'ipopt'"),
    "v0": (
        lambda: dincl.solve(problem(), dincl.SecondOrderPBD(0.1, v0=[[1.0, 0.0]]), [1.0]),
        r"v0 = .*of shape \(2, 2\)",
    ),
    "no problem": (lambda: dincl.solve(None, dincl.PBD(0.1), [1.0]), "problem = None"),
    "no scheme": (lambda: dincl.solve(problem(), 0.1, [1.0]), "scheme = 0.1"),
    "times decreasing": (lambda: dincl.solve(problem(), dincl.PBD(0.1), [1.0, 0.5]), r"t = \[1.0, 0.5\]: .*increasing"),
    "times negative": (lambda: dincl.solve(problem(), dincl.PBD(0.1), [-1.0, 0.5]), r"t = \[-1.0, 0.5\]"),
    "times none": (lambda: dincl.solve(problem(), dincl.PBD(0.1), []), "t = "),
    "start infinite": (
        lambda: dincl.solve(problem(), dincl.PBD(0.1), [1.0], t0=math.inf),
        "t0 = inf: must be",
    ),
    "start negative": (
        lambda: dincl.solve(problem(), dincl.EventDriven(1e-6), [1.0], t0=-1),
        "t0 = -1: .*>= 0",
    ),
    "start text": (lambda: dincl.solve(problem(), dincl.PBD(0.1), [1.0], t0="now"), "t0 = 'now'"),
    "times before the start": (
        lambda: dincl.solve(problem(), dincl.PBD(0.1), [1.0, 3.0], t0=2.5),
        r"t = \[1.0, 3.0\]: must be one or more increasing times >= 2.5",
    ),
    "start outside at t0": (
        lambda: dincl.solve(
            problem(constraints=[dincl.HalfSpace((0, 1), lambda t: t - 1.0)]), dincl.PBD(0.1), [4.0], t0=3.0
        ),
        r"x0 violates HalfSpace by 1 at particle 0 at t = 3 \(constraints\[0\]\).* projection, t=3\) gives",
    ),
    "start outside in a box": (
        lambda: dincl.Problem([(0.1, 0.0), (3.9, 0.0)], rest, [dincl.NonOverlap(0.5)], box=(4.0, None)),
        r"x0 violates NonOverlap by 0.8 .* dincl.project\(problem with this box and any feasible x0, x0, projection\)",
    ),
    "drift that fails at t0": (
        lambda: dincl.solve(problem(drift=lambda t, x: x if t < 2 else x.no), dincl.PBD(0.1), [4.0], t0=3.0),
        r"drift\(t = 3, x of shape \(2, 2\)\) raised AttributeError",
    ),
    "start of a path": (
        lambda: dincl.solve(dincl.solve(problem(), dincl.PBD(0.1), [1.0]), dincl.PBD(0.1), [2.0], t0=1.0),
        "t0 = 1.0: must be None",
    ),
    "times before the end of a path": (
        lambda: dincl.solve(dincl.solve(problem(), dincl.PBD(0.1), [1.0]), dincl.PBD(0.1), [0.5]),
        "t = .*0.5.*: must be .* >= 1",
    ),
    "breaks outside": (
        lambda: dincl.solve(problem(), dincl.PBD(0.1), [1.0, 2.0], breaks=[0.5, 2.1]),
        r"breaks = \[0.5, 2.1\]: must be increasing times from 0 to 2",
    ),
    "breaks before the start": (
        lambda: dincl.solve(problem(), dincl.EventDriven(1e-6), [2.0], t0=1.0, breaks=[0.5]),
        r"breaks = \[0.5\]: must be increasing times from 1 to 2",
    ),
    "breaks decreasing": (lambda: dincl.solve(problem(), dincl.PBD(0.1), [2.0], breaks=[1.0, 0.5]), "breaks = .*incr"),
    "breaks flat": (
        lambda: dincl.solve(problem(), dincl.PBD(0.1), [2.0], breaks=[[0.5]]),
        "breaks = .*0.5.*must",
    ),
    "breaks nan": (lambda: dincl.solve(problem(), dincl.PBD(0.1), [2.0], breaks=[math.nan]), "breaks = nan at index"),
    "until no function": (
        lambda: dincl.solve(problem(), dincl.PBD(0.1), [1.0], until=2.0),
        "until = 2.0: must",
    ),
    "until of one argument": (
        lambda: dincl.solve(problem(), dincl.PBD(0.1), [1.0], until=lambda t: t),
        r"until: until\(t = 0, x of shape \(2, 2\)\) raised TypeError",
    ),
    "until an array": (
        lambda: dincl.solve(problem(), dincl.PBD(0.1), [1.0], until=lambda t, x: x),
        r"until: until returned an array of shape \(2, 2\): must be real numbers of shape \(\)",
    ),
    "until nan": (
        lambda: dincl.solve(problem(), dincl.PBD(0.1), [1.0], until=lambda t, x: math.nan),
        "until: until returned nan",
    ),
    "too many steps": (lambda: dincl.solve(problem(), dincl.PBD(1e-12), [1.0]), r"dt = 1e-12: needs 1e\+12 steps"),
    "time outside of the run": (lambda: dincl.solve(problem(), dincl.PBD(0.1), [1.0])(1.5), r"t = 1.5: .*\[0, 1.0\]"),
}


@pytest.mark.parametrize("name", BAD_PROBLEMS)
def test_one_clear_message(name):
    make, message = BAD_PROBLEMS[name]
    with pytest.raises(dincl.InvalidProblem, match=message):
        make()


STEPPED = [dincl.PBD(0.1), dincl.Penalty(0.1, 1.0), dincl.CatchUp(0.1, dincl.Daqp(1e-9))]


@pytest.mark.parametrize("scheme", STEPPED, ids=lambda scheme: type(scheme).__name__)
def test_a_sparse_jacobian_whose_shape_changes(scheme):
    slopes = np.array([[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
    floor = dincl.Smooth(lambda x: x[:, 1] + 0.5, lambda x: csr_array(slopes if x[0, 1] > -0.2 else slopes[:1]))
    falling = problem(drift=lambda t, x: np.tile([0.0, -1.0], (2, 1)), constraints=[floor])
    path = dincl.solve(falling, scheme, t=[3.0], throw=False)
    assert path.status is dincl.Status.CONSTRAINT_FAILED
    assert "sparse matrix of shape (1, 4): must have shape (2, 4)" in path.detail


@pytest.mark.slow
def test_a_crowd_on_one_point_is_refused():
    with pytest.raises(dincl.InvalidProblem, match=r"constraints\[0\]: More than 50,000,000 pairs"):
        dincl.Problem(np.zeros((20_000, 2)), rest, [dincl.NonOverlap(0.5)])


@pytest.mark.slow
def test_a_crowd_driven_onto_one_point_ends_with_its_status():
    x0 = 1.1 * np.stack(np.unravel_index(np.arange(20_000), (200, 100)), axis=1)
    for scheme in (dincl.PBD(1.0), dincl.LinearisedCatchUp(1.0, dincl.Piqp(1e-6))):
        path = dincl.solve(dincl.Problem(x0, lambda t, x: -x, [dincl.NonOverlap(0.5)]), scheme, t=[1.0], throw=False)
        assert path.status is dincl.Status.CROWDED
        assert path.final == pytest.approx(x0)


NO_NUMBERS = {
    "complex": np.array([[1.0 + 0j, 2.0]]),
    "truth": [[True, False]],
    "masked": np.ma.array([[1.0, 2.0]], mask=[[0, 1]]),
    "text": [["1.0", "2.0"]],
    "bytes": b"12",
    "records": np.zeros((1, 2), dtype=[("x", float)]),
    "dates": np.zeros((1, 2), dtype="datetime64[s]"),
    "ragged": [[1.0, 2.0], [1.0]],
    "objects": [[None, 1.0]],
}


@pytest.mark.parametrize("kind", NO_NUMBERS)
def test_what_is_no_real_number_is_refused(kind):
    value = NO_NUMBERS[kind]
    with pytest.raises(dincl.InvalidProblem, match=r"^x0 = .*: must be finite real numbers$"):
        dincl.Problem(value, lambda t, x: -x)
    with pytest.raises(dincl.InvalidProblem, match=r"drift returned .*: must be real numbers of shape \(1, 2\)\.$"):
        dincl.Problem([[0.0, 0.0]], lambda t, x: value)


def test_messages_name_the_shape_that_was_given():
    with pytest.raises(dincl.InvalidProblem, match=r"must be finite real numbers of shape \(N, nx\), not \(2,\)$"):
        meanfield.State(X=[1.0, 2.0], y=[1.2], v=[0.3])


@pytest.mark.parametrize("time", [0.5, [0.5], np.float64(0.5)])
def test_one_time_is_a_list_of_one_in_all_packages(time):
    model = meanfield.LinearFibre(m=0.5, k0=1.0, y_rest=1.0, k1=0.5)
    start = meanfield.State(X=[[1.0]], y=[1.2], v=[0.3])
    assert meanfield.solve_ode(model, start, time, 1e-6).t.tolist() == [0.5]
    assert dincl.solve(dincl.Problem([[1.0]], lambda t, x: -x), dincl.PBD(0.1), time).t.tolist() == [0.5]
