"""Nearest points of polyhedra in a metric and their duals, by every back end; the certificate is recomputed here."""

import copy
import pickle

import numpy as np
import pytest
from scipy import sparse
from scipy.optimize import minimize

import dincl
from dincl.projection import read_fclib, read_qp
from tests.dincl.catalog import PROJECTIONS
from tests.optional import need_module

SEED = 20261129
TOL = 1e-9
EVERY = pytest.mark.parametrize("projection", PROJECTIONS)


def tolerance(projection):
    """Ipopt, which is for curved sets, stops short of the others where many rows meet in a point."""
    return 1e-7 if projection is dincl.Ipopt else TOL


def dense(matrix):
    return matrix.toarray() if sparse.issparse(matrix) else np.asarray(matrix)


def certified(program, found, tol=TOL):
    """Fail unless point and multipliers obey all conditions, in units of the largest violation at c."""
    if isinstance(program, dincl.Lcp):
        A, M, gram = np.eye(len(program.q)), None, dense(program.W)
        gaps, far = gram @ found.multipliers + program.q, -program.q
        np.testing.assert_allclose(found.point, gaps, rtol=1e-12, atol=1e-12)
    else:
        A, M = dense(program.A), dense(program.metric) if program.metric is not None else np.eye(len(program.c))
        gram = A @ np.linalg.solve(M, A.T)
        gaps, far = A @ found.point - program.b, program.b - A @ program.c
    lengths = np.sqrt(np.diag(gram))
    lengths[lengths == 0] = 1.0
    fixed, far = program.equal, far / lengths
    scale = max(far[~fixed].max(initial=0.0), np.abs(far[fixed]).max(initial=0.0))
    assert found.scale == pytest.approx(scale)
    gaps, weights = gaps / lengths / (scale or 1.0), found.multipliers * lengths / (scale or 1.0)
    assert np.abs(gaps[fixed]).max(initial=0.0) <= tol
    assert np.abs(np.minimum(gaps, weights))[~fixed].max(initial=0.0) <= tol
    if M is not None:
        misfit = (M @ (found.point - program.c) - A.T @ found.multipliers) / np.sqrt(np.diag(M))
        assert np.abs(misfit).max() <= tol * (scale or 1.0)
    assert found.residual <= tol
    assert found.status is dincl.Status.SUCCESS


METRICS = {
    "identity": lambda n, rng: None,
    "masses": lambda n, rng: sparse.diags_array(10.0 ** rng.uniform(-3, 3, n)),
    "bodies": lambda n, rng: sparse.block_diag([q @ q.T + 0.1 * np.eye(3) for q in rng.normal(size=(n // 3, 3, 3))]),
    "springs": lambda n, rng: sparse.diags_array([2.1, -1.0, -1.0], offsets=[0, 1, -1], shape=(n, n)),
    "dense": lambda n, rng: np.cov(rng.normal(size=(n, n + 2))),
}
# Metric, coordinates, rows, part of the entries that are not zero, equalities.
POLYHEDRA = {
    "one row": ("identity", 3, 1, 1.0, 0),
    "few dense rows": ("dense", 30, 20, 1.0, 0),
    "many dense rows": ("dense", 12, 60, 1.0, 0),
    "many dense rows and equalities": ("identity", 30, 40, 1.0, 6),
    "sparse rows": ("masses", 60, 40, 0.1, 0),
    "sparse rows and equalities": ("bodies", 60, 60, 0.1, 15),
    "springs": ("springs", 60, 40, 0.1, 4),
    "equalities alone": ("dense", 6, 6, 1.0, 6),
}


def polyhedron(name):
    """Rows of lengths 1e-3 to 1e3 that a known point meets, some twice, of equalities too; c violates them."""
    kind, n, m, filled, count = POLYHEDRA[name]
    rng = np.random.default_rng([SEED, len(name)])
    A = rng.normal(size=(m, n)) * (rng.random((m, n)) < filled)
    A[-1] = A[0]
    inside, equal = rng.normal(size=n), np.arange(m) < count
    equal[-1] = equal[0]
    b = A @ inside - rng.exponential(size=m) * (rng.random(m) < 0.5)
    b[equal] = (A @ inside)[equal]
    length = 10.0 ** rng.uniform(-3, 3, m)
    A, b = length[:, None] * A, length * b
    rows = A if filled == 1.0 else sparse.csc_array(A)
    return dincl.NearestPoint(inside + rng.normal(size=n), rows, b, equal, METRICS[kind](n, rng))


@EVERY
@pytest.mark.parametrize("name", POLYHEDRA)
def test_nearest_points_are_certified(name, projection):
    program = polyhedron(name)
    certified(program, program.solve(projection(tolerance(projection))), tolerance(projection))


@EVERY
@pytest.mark.parametrize("over", [0.0, 0.1])
def test_a_row_that_follows_from_equalities(over, projection):
    """Met to rounding it does nothing; with a larger right-hand side it contradicts them."""
    A, b = [[0.3, 0.1, 0.0], [0.1, 0.7, 0.0], [0.4, 0.8, 0.0], [0.0, 0.0, 1.0]], [0.1, 0.2, 0.1 + 0.2 + over, 0.5]
    program = dincl.NearestPoint([0.0, 0.0, 0.0], A, b, [True, True, False, False])
    found = program.solve(projection(TOL))
    if over == 0:
        certified(program, found)
        assert found.multipliers[2] == 0
    else:
        assert found.status is dincl.Status.INFEASIBLE
        assert "rows 2:" in found.detail


def gram(m, rank, seed):
    rows = np.random.default_rng(seed).normal(size=(m, rank)) * 10.0 ** np.random.default_rng(seed).uniform(
        -2, 2, (m, 1)
    )
    return rows @ rows.T


# W, and a function of W for q: in the range of W, so that gaps >= 0 are possible.
COMPLEMENTARITY = {
    "one": ([[2.0]], [-3.0]),
    "many solutions": ([[1.0, 1.0], [1.0, 1.0]], [-1.0, -1.0]),
    "nothing to do": (gram(5, 2, 1), np.ones(5)),
    "of full rank": (gram(40, 40, 2), -np.linspace(-1.0, 2.0, 40)),
    "of low rank": (gram(40, 12, 3), -gram(40, 12, 3) @ np.linspace(-0.5, 1.0, 40)),
    "with a row of zeros": (np.diag([2.0, 0.0, 1.0]), [-1.0, 0.5, -2.0]),
    "sparse": (sparse.diags_array([2.0, -1.0, -1.0], offsets=[0, 1, -1], shape=(200, 200)), np.sin(np.arange(200.0))),
}


@EVERY
@pytest.mark.parametrize("name", COMPLEMENTARITY)
def test_complementarity_is_certified(name, projection):
    program = dincl.Lcp(*COMPLEMENTARITY[name])
    certified(program, program.solve(projection(tolerance(projection))), tolerance(projection))


def test_the_point_is_that_of_another_program():
    """A metric moves the point: SLSQP of SciPy finds the same one."""
    metric, c = np.array([[4.0, 0.5], [0.5, 1.0]]), np.array([0.0, -1.0])
    A, b = np.array([[1.0, 1.0], [1.0, -2.0]]), np.array([2.0, -1.0])
    other = minimize(
        lambda v: 0.5 * (v - c) @ metric @ (v - c),
        [2.0, 0.0],
        jac=lambda v: metric @ (v - c),
        constraints={"type": "ineq", "fun": lambda v: A @ v - b, "jac": lambda v: A},
        options={"ftol": 1e-14},
    )
    found = dincl.NearestPoint(c, A, b, metric=metric).solve()
    np.testing.assert_allclose(found.point, other.x, atol=1e-6)
    assert np.abs(found.point - dincl.NearestPoint(c, A, b).solve().point).max() > 0.1
    dual = dincl.Lcp(A @ np.linalg.solve(metric, A.T), A @ c - b).solve()
    np.testing.assert_allclose(dual.multipliers, found.multipliers, atol=1e-9)


def test_units_of_rows_and_of_the_metric_change_nothing():
    one = polyhedron("few dense rows")
    other = dincl.NearestPoint(one.c, 1e6 * one.A, 1e6 * one.b, one.equal, 1e-8 * one.metric)
    first, second = one.solve(), other.solve()
    np.testing.assert_allclose(first.point, second.point, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(first.multipliers, 1e14 * second.multipliers, rtol=1e-6, atol=1e-6)
    assert second.status is dincl.Status.SUCCESS


def test_a_feasible_point_stays_and_programs_can_be_sent():
    program = dincl.NearestPoint([3.0, 0.0], [[1.0, 0.0]], [1.0], metric=[[2.0, 0.0], [0.0, 1.0]])
    for sent in (program, pickle.loads(pickle.dumps(program)), copy.deepcopy(program)):
        found = sent.solve()
        assert (found.residual, found.scale, found.multipliers.tolist(), found.point.tolist()) == (0, 0, [0], [3, 0])


@EVERY
@pytest.mark.parametrize(
    ("program", "named"),
    [
        (lambda: dincl.NearestPoint([0.0, 5.0], [[0, 1.0], [1.0, 0], [-1.0, 0]], [0.0, 1.0, 1.0]), "rows 1, 2"),
        (lambda: dincl.NearestPoint([0.0], [[0.0], [1.0]], [1.0, 0.5]), "rows 0"),
        (lambda: dincl.NearestPoint([0.0, 0.0], [[1.0, 1.0], [2.0, 2.0]], [1.0, 3.0], [True, True]), "in row"),
        (
            lambda: dincl.NearestPoint([0.0, 0], [[1, 1.0], [0, 1.0], [-1, -1.0]], [1, 0, 1.0], [True, False, False]),
            "rows 2",
        ),
        (lambda: dincl.Lcp([[1.0, -1.0], [-1.0, 1.0]], [-1.0, -1.0]), "rows 0, 1"),
    ],
    ids=["two walls", "a row of zeros", "equalities", "an equality and a row", "multipliers without bound"],
)
def test_rows_that_contradict_each_other_are_named(program, named, projection):
    found = program().solve(projection(TOL))
    assert found.status is dincl.Status.INFEASIBLE
    assert named in found.detail
    assert found.residual > 0.1


def test_a_tolerance_that_rounding_forbids_is_no_success():
    found = dincl.NearestPoint([1e9, 0.1], [[0.3, 0.7], [0.3, -0.7]], [3e8 + 1, 3e8 + 1]).solve(dincl.Daqp(1e-12))
    assert found.status is dincl.Status.NOT_CONVERGED
    assert found.detail


EYE = np.eye(2)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: dincl.NearestPoint([0.0, 0.0], np.ones((3, 3)), [0, 0, 0]), "A"),
        (lambda: dincl.NearestPoint([0.0, 0.0], sparse.csr_array(np.ones((3, 3))), [0, 0, 0]), r"A of shape \(3, 3\)"),
        (lambda: dincl.NearestPoint([0.0, np.nan], EYE, [0, 0]), "c = nan at index"),
        (lambda: dincl.NearestPoint([0.0, 0.0], EYE, [0, np.inf]), "b = inf at index"),
        (lambda: dincl.NearestPoint([0.0, 0.0], sparse.csr_array(EYE * np.nan), [0, 0]), "A = nan at index"),
        (lambda: dincl.NearestPoint([0.0, 0.0], EYE, [0, 0], [0, 1]), "equal = .* must be 2 truth values"),
        (lambda: dincl.NearestPoint([0.0, 0.0], EYE, [0, 0], metric=[[1, 2], [0, 1]]), "metric = .* must be symmetric"),
        (lambda: dincl.NearestPoint([0.0, 0.0], EYE, [0, 0], metric=[[1, 2], [2, 1]]), "metric = .* positive definite"),
        (lambda: dincl.NearestPoint([0.0, 0.0], EYE, [0, 0], metric=sparse.csr_array([[1, 2], [2, 1.0]])), "positive"),
        (lambda: dincl.NearestPoint([0.0, 0.0], EYE, [0, 0], metric=sparse.csr_array([[1, 0], [0, 0.0]])), "positive"),
        (lambda: dincl.Lcp([[1.0, 0.5], [0.4, 1.0]], [0, 0]), r"W\[0, 1\] = 0.5, W\[1, 0\] = 0.4: must be symm"),
        (lambda: dincl.Lcp([[1.0, 0.5], [0.5 + 1e-9, 1.0]], [0, 0]), r"W\[0, 1\] = 0.5"),
        (lambda: dincl.Lcp([[1.0, 2.0], [2.0, 1.0]], [0, 0]), "not positive semidefinite"),
        (lambda: dincl.Lcp([[0.0, 1.0], [1.0, 0.0]], [0, 0]), "not positive semidefinite"),
        (lambda: dincl.Lcp(sparse.csr_array([[-1.0]]), [0]), "not positive semidefinite"),
        (lambda: dincl.Lcp(EYE, [0, 0, 0]), "W"),
        (lambda: dincl.Lcp(EYE, [-1, 0]).solve("Daqp"), "must be a projection"),
    ],
)
def test_bad_input_is_named(make, words):
    with pytest.raises(dincl.InvalidProblem, match=words):
        make()


# Files.


def test_programs_of_qpsolvers_are_read(tmp_path):
    """As ``numpy.savez`` writes them, None as an object: its rows are those of G, A, lb and ub with finite bounds."""
    rng = np.random.default_rng(SEED)
    P, q, G = np.diag([1.0, 2.0, 4.0]), np.array([1.0, -2.0, 0.0]), rng.normal(size=(2, 3))
    data = {"P": P, "q": q, "G": G, "h": np.ones(2), "A": np.ones((1, 3)), "b": np.zeros(1)}
    np.savez(tmp_path / "all.npz", **data, lb=np.array([-1.0, -np.inf, 0.1]), ub=np.array(None))
    program = read_qp(tmp_path / "all.npz")
    np.testing.assert_allclose(program.c, [-1.0, 1.0, 0.0], atol=1e-15)
    np.testing.assert_array_equal(dense(program.A), np.vstack((np.ones((1, 3)), EYE3[[0, 2]], -G)))
    np.testing.assert_array_equal(program.b, [0.0, -1.0, 0.1, -1.0, -1.0])
    assert program.equal.tolist() == [True, False, False, False, False]
    certified(program, program.solve())
    np.savez(tmp_path / "flat.npz", **(data | {"P": np.diag([1.0, 1.0, 0.0])}))
    np.savez(tmp_path / "other.npz", P=P)
    whole = (tmp_path / "all.npz").read_bytes()
    (tmp_path / "cut.npz").write_bytes(whole[: len(whole) // 2])
    (tmp_path / "text.mat").write_text("words" * 100)
    refused = {"flat.npz": "P is not positive definite"}
    for name, words in (
        refused | dict.fromkeys(("other.npz", "cut.npz", "text.mat"), "as qpbenchmark keeps it")
    ).items():
        with pytest.raises(dincl.InvalidProblem, match=words):
            read_qp(tmp_path / name)


EYE3 = np.eye(3)


def test_programs_of_maros_and_meszaros_are_read(tmp_path):
    from scipy.io import savemat

    A, low, high = np.vstack((np.ones((2, 3)), EYE3)), [1.0, 2.0, -1e20, 0.0, 0.0], [1.0, 1e20, 1e20, 3.0, 1e20]
    data = {"P": sparse.csc_matrix(2 * EYE3), "A": sparse.csc_matrix(A), "l": np.c_[low], "u": np.c_[high]}
    savemat(tmp_path / "one.mat", data | {"q": np.zeros((3, 1)), "n": 3, "m": 5})
    program = read_qp(tmp_path / "one.mat")
    np.testing.assert_array_equal(dense(program.A), np.vstack((A[[0, 1, 3, 4]], -A[3:4])))
    np.testing.assert_array_equal(program.b, [1.0, 2.0, 0.0, 0.0, -3.0])
    assert program.equal.tolist() == [True, False, False, False, False]
    assert program.solve().status is dincl.Status.INFEASIBLE


def test_files_of_fclib_that_are_none_are_refused(tmp_path):
    need_module("h5py")
    import h5py

    file = tmp_path / "one.hdf5"
    with h5py.File(file, "w") as made:
        made["fclib_local/spacedim"] = [1]
        made["fclib_local/vectors/mu"] = [0.0]
        made["fclib_local/vectors/q"] = [-1.0, 2.0]
        for name, values in {"nz": [2], "i": [0, 1], "p": [0, 1], "x": [2.0, 1.0]}.items():
            made[f"fclib_local/W/{name}"] = values
    np.testing.assert_allclose(read_fclib(file).solve().multipliers, [0.5, 0.0], atol=1e-15)
    changes = {"vectors/mu": [0.3], "W/i": [0, 7], "W/x": "words", "V": [1.0], "vectors/q": None}
    words = [
        "friction, mu = 0.3",
        "not have the shape",
        "does not support dtype",
        "equalities",
        "with vectors/q",
    ]
    for (name, value), word in zip(changes.items(), words, strict=True):
        other = tmp_path / "other.hdf5"
        other.write_bytes(file.read_bytes())
        with h5py.File(other, "r+") as made:
            if f"fclib_local/{name}" in made:
                del made[f"fclib_local/{name}"]
            if value is not None:
                made[f"fclib_local/{name}"] = value
        with pytest.raises(dincl.InvalidProblem, match=word):
            read_fclib(other)
    with h5py.File(file, "r+") as made:
        del made["fclib_local/W/x"]
        made.create_dataset("fclib_local/W/x", shape=(10**9,), dtype=float, chunks=(1000,))
    with pytest.raises(dincl.InvalidProblem, match="no more data than fit into it"):
        read_fclib(file)
