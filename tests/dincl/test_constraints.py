"""Every family: its rows against the formula, its derivative, its near rows, its exact projections."""

import numpy as np
import pytest

import dincl
from dincl.rows.affine import AffineRows, linearised
from dincl.steps.stepper import CompiledStepper
from dincl.steps.sweeping import pbd
from tests.dincl.catalog import CONSTRAINTS, quadratic, quadratic_jacobian

cases = pytest.mark.parametrize(("name", "d"), [(name, d) for name in CONSTRAINTS for d in (1, 2, 3)])


@cases
def test_rows_are_the_definition(name, d, rng):
    x = rng.normal(size=(6, d))
    constraint = CONSTRAINTS[name][0](d)
    rows = constraint.select(x, 100.0)
    assert rows.values(x) == pytest.approx(CONSTRAINTS[name][1](x), abs=1e-14)
    if isinstance(constraint, dincl.DifferentiableConstraint):
        assert constraint.values(x).tolist() == rows.values(x).tolist()
        jacobian = np.reshape(constraint.jacobian(x), (-1, x.size))
        assert jacobian.tolist() == rows.jacobian(x).toarray().tolist()


@cases
def test_jacobian_is_the_derivative(name, d, rng):
    x, h = rng.normal(size=(6, d)), 1e-6
    rows = CONSTRAINTS[name][0](d).select(x, 100.0)
    jacobian = rows.jacobian(x).toarray()
    for k in range(x.size):
        e = np.zeros(x.size)
        e[k] = h
        e = e.reshape(x.shape)
        central = (rows.values(x + e) - rows.values(x - e)) / (2 * h)
        assert jacobian[:, k] == pytest.approx(central, abs=1e-8)


@cases
def test_no_row_left_out_can_be_reached(name, d, rng):
    family, reach = CONSTRAINTS[name][0](d), 0.25
    for _ in range(200):
        x = 2 * rng.normal(size=(6, d))
        near, everything = family.select(x, reach), family.select(x, 1e3)
        # A random move, and for one row the worst: all its particles against its gradient.
        steepest = -rng.choice(everything.jacobian(x).toarray()).reshape(x.shape)
        for move in (rng.normal(size=x.shape), steepest):
            length = np.linalg.norm(move, axis=1, keepdims=True)
            z = x + reach * move / np.where(length > 0, length, 1.0)
            violated, found = (np.sort(rows.values(z)[rows.values(z) < 0]) for rows in (everything, near))
            assert found == pytest.approx(violated, abs=1e-14)


@cases
def test_linearisation_touches(name, d, rng):
    x = rng.normal(size=(6, d))
    rows = CONSTRAINTS[name][0](d).select(x, 100.0)
    linear = linearised(rows, x)
    assert isinstance(linear, AffineRows)
    assert linear.values(x) == pytest.approx(rows.values(x), abs=1e-13)
    assert linear.jacobian(x).toarray() == pytest.approx(rows.jacobian(x).toarray())


@cases
def test_a_carried_set_is_the_same_set_elsewhere(name, d, rng):
    x, shift = rng.normal(size=(6, d)), rng.normal(size=d)
    rows = CONSTRAINTS[name][0](d).select(x, 100.0)
    assert rows.shifted(shift).values(x + shift) == pytest.approx(rows.values(x), abs=1e-13)
    assert rows.shifted(shift).jacobian(x + shift).toarray() == pytest.approx(rows.jacobian(x).toarray(), abs=1e-12)


@cases
def test_taking_rows_keeps_their_order(name, d, rng):
    x = rng.normal(size=(6, d))
    rows = CONSTRAINTS[name][0](d).select(x, 100.0)
    keep = np.arange(len(rows.values(x))) % 2 == 0
    assert rows.take(keep).values(x).tolist() == rows.values(x)[keep].tolist()
    assert rows.take(keep).jacobian(x).toarray().tolist() == rows.jacobian(x).toarray()[keep].tolist()


@cases
def test_a_sweep_is_one_exact_projection_after_another(name, d, rng):
    """The nearest point of {g_k >= 0} satisfies x - y = multiplier grad g_k(x), multiplier >= 0, g_k(x) = 0."""
    moved = 0
    for y in starts(name, d, rng):
        family = CONSTRAINTS[name][0](d)
        rows = family.select(y, 100.0)
        swept = after_a_sweep(family, y)
        moved += (swept != y).any()
        x, count = y.copy(), len(rows.values(y))
        for k in range(count):
            row = rows.take(np.arange(count) == k)
            x, before = _nearest_point(row, x), x
            gradient = row.jacobian(x).toarray()[0]
            multiplier = gradient @ (x - before).ravel() / (gradient @ gradient)
            assert (x - before).ravel() == pytest.approx(multiplier * gradient, abs=1e-10)
            assert multiplier >= 0
            assert row.values(x)[0] >= -1e-10
        assert swept == pytest.approx(x, abs=1e-9)
    assert moved > 5


def after_a_sweep(family, y):
    """What PBD makes of y (N, d), which may lie anywhere."""
    problem = dincl.Problem(y, lambda t, x: 0 * x)
    object.__setattr__(problem, "constraints", (family,))
    stepper = CompiledStepper.sweeping(problem, pbd, [1])
    return stepper.step(0.0, 1.0, dincl.StepState(y)).x


def starts(name, d, rng):
    """Random states; for a curved g without formula not deep outside, where the nearest point is a fixed point."""
    drawn = rng.normal(size=(400, 6, d))
    if name == "Smooth":
        lack = np.array([quadratic(y).min() for y in drawn])
        drawn = drawn[(lack > -0.15) & (lack < 0)]
    elif name in ("own", "own rows"):
        level = 1 - np.array([CONSTRAINTS[name][1](y) for y in drawn])
        drawn = drawn / np.sqrt(np.maximum(level / 1.15, 1.0))[:, :, None]
    return drawn[:20]


def _nearest_point(row, y):
    """Fixed point of x = y + lambda grad g(x), g(x) = 0, found by plain iteration, independent of the sweeps."""
    if row.values(y)[0] >= 0:
        return y
    x = y
    for _ in range(500):
        gradient = row.jacobian(x).toarray()[0]
        lack = gradient @ (x - y).ravel() - row.values(x)[0]
        x, last = y + (max(lack, 0.0) / (gradient @ gradient) * gradient).reshape(y.shape), x
        if np.abs(x - last).max() < 1e-13:
            break
    return x


def test_all_pairs_of_many_discs(rng):
    x = rng.normal(size=(150, 2))
    assert dincl.NonOverlap(0.1).select(x, np.inf).values(x) == pytest.approx(
        [np.linalg.norm(x[i] - x[j]) - 0.2 for i in range(150) for j in range(i)], abs=1e-14
    )


def test_sparse_jacobians_of_smooth_constraints(rng):
    from scipy.sparse import csc_array

    x = rng.normal(size=(6, 2))
    dense = dincl.Smooth(quadratic, quadratic_jacobian).select(x, 0.0).jacobian(x).toarray()
    sparse = dincl.Smooth(quadratic, lambda x: csc_array(quadratic_jacobian(x).reshape(2, -1))).select(x, 0.0)
    assert sparse.jacobian(x).toarray().tolist() == dense.tolist()


def test_normals_are_made_unit_vectors_and_offsets_stay():
    wall = dincl.HalfSpace(normal=(0, 4), offset=1.0, radius=0.5)
    assert wall.normal.tolist() == [0.0, 1.0]
    assert wall.select(np.array([[0.0, 3.0]]), 10.0).values(np.array([[0.0, 3.0]])).tolist() == [1.5]


def test_checked_arrays_cannot_be_changed_later():
    radius = np.array([0.5, 0.5])
    family = dincl.NonOverlap(radius)
    radius[0] = -1.0
    assert family.radii(2).tolist() == [0.5, 0.5]
    with pytest.raises(ValueError, match="read-only"):
        family.radius[0] = -1.0


def test_threads_allow_their_ends_to_meet():
    problem = dincl.Problem([[0.0], [1.0]], lambda t, x: np.array([[1.0], [0.0]]), [dincl.MaxDistance([(0, 1)], 2.0)])
    for scheme in (
        dincl.PBD(0.5),
        dincl.LinearisedCatchUp(0.5, dincl.Daqp(1e-9)),
        dincl.CatchUp(0.5, dincl.Daqp(1e-9)),
    ):
        assert dincl.solve(problem, scheme, t=[1.0, 3.0, 5.0]).x[:, 0, 0] == pytest.approx([1.0, 3.0, 4.0])
