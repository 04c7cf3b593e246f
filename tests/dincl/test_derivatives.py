"""Jacobians of users are compared with differences at construction, and computed where none is given."""

import numpy as np
import pytest

import dincl

X = np.array([[0.3, 0.4], [-0.2, 0.5]])


def inside(x):
    """g_i = 1 - x_i^2 - 2 y_i^2."""
    return 1 - x[:, 0] ** 2 - 2 * x[:, 1] ** 2


def jacobian(x):
    rows = np.zeros((len(x), *x.shape))
    for i in range(len(x)):
        rows[i, i] = -2 * x[i] * [1, 2]
    return rows


def problem(constraint, x=X):
    return dincl.Problem(x, lambda t, x: np.tile([0.0, -1.0], (len(x), 1)), [constraint])


def real_only(x):
    return 1 - np.abs(x[:, 0]) ** 2 - 2 * np.float64(1.0) * np.abs(x[:, 1]) ** 2


@pytest.mark.parametrize(
    ("g", "method", "most"), [(inside, "complex steps", 1e-15), (real_only, "central differences", 1e-9)]
)
def test_a_missing_jacobian_is_computed_and_the_repr_says_how(g, method, most):
    made = problem(dincl.Smooth(g))
    assert f"Smooth(jacobian: {method})" in repr(made)
    given = problem(dincl.Smooth(inside, jacobian))
    assert "Smooth(jacobian: given)" in repr(given)
    rows, expected = (one.rows_within(0.0, X, np.inf).jacobian(X).toarray() for one in (made, given))
    assert np.abs(rows - expected).max() <= most
    schemes = [dincl.PBD(0.01), dincl.CatchUp(0.01, dincl.ActiveSet(tol=1e-9)), dincl.EventDriven(tol=1e-7)]
    for scheme in schemes:
        ours, theirs = (dincl.solve(one, scheme, t=[0.5, 1.0]) for one in (made, given))
        assert np.abs(ours.x - theirs.x).max() <= 1e-6


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (
            lambda x: -jacobian(x),
            "jacobian: along a test direction row 0 of g changes by .*, the wrong sign: must return",
        ),
        (lambda x: 2 * jacobian(x), "a wrong factor of 2: must return dg/dx"),
        (lambda x: jacobian(x)[:, :, ::-1], "jacobian: along a test direction row 0 of g changes by"),
        (lambda x: jacobian(x)[:, :, :1], r"jacobian returned an array of shape \(2, 2, 1\): must be real numbers of"),
    ],
)
def test_a_wrong_jacobian_is_found_at_construction(wrong, said):
    with pytest.raises(dincl.InvalidProblem, match=said):
        problem(dincl.Smooth(inside, wrong))


def test_kinks_and_edges_of_the_domain_are_not_judged():
    kink = dincl.Smooth(lambda x: 1 - np.abs(x[:, 0] - 0.3), lambda x: np.zeros((len(x), *x.shape)))
    problem(dincl.Moving(kink, lambda t: (0.0, 0.0)), X[:1])

    def root(x):
        if x[0, 1] < 0.4:
            raise ValueError("outside of the domain")
        return 1 - x[:, 0] ** 2

    problem(dincl.Smooth(root, lambda x: np.zeros((len(x), *x.shape))), X[:1])


def test_a_class_of_the_user_is_checked_too():
    class Inside(dincl.DifferentiableConstraint):
        def values(self, x):
            return inside(x)

        def jacobian(self, x):
            return -jacobian(x)

    with pytest.raises(dincl.InvalidProblem, match=r"Inside.jacobian: along a test direction row 0 of Inside.values"):
        problem(Inside())


@pytest.mark.parametrize(
    ("scale", "centre", "at"),
    [
        (1.0, 0.0, 1e-12),  # a start near the origin, derivatives far from it
        (1.0, 0.0, 1e6),
        (1e-3, 1e3, 1e3),  # a small set far from the origin
        (1e6, 1e6, 0.0),
        (1e-6, 0.0, 1e-15),
    ],
)
def test_differences_take_their_step_from_the_point_and_the_function(scale, centre, at):
    def ring(x):
        assert not np.iscomplexobj(x)
        return scale - np.linalg.norm(x - centre, axis=1)

    made = dincl.Smooth(ring)
    made.jacobian(np.array([[0.0, at]]))
    toward = np.array([[0.6, -0.8]])
    for distance in (0.5, 1.0):
        found = made.jacobian(centre + distance * scale * toward)
        assert np.abs(found + toward).max() <= 1e-5  # rounding of x alone: (1e-10)^(2/3)
        assert np.array_equal(found, dincl.Smooth(ring).jacobian(centre + distance * scale * toward))


def test_a_start_near_the_origin_changes_no_motion():
    """A bead falls from the origin, then slides along the inside of a ring of radius 3, exact by a quarter circle."""

    def drift(t, x):
        return np.array([[0.0, -0.999]]) if t < 1.0 else np.array([[1.0, 0.0]])

    for y in (1e-3, 1e-9, 1e-15):
        ring = dincl.Smooth(lambda x: 3 - np.linalg.norm(x, axis=1))
        path = dincl.solve(dincl.Problem([[0.0, -y]], drift, [ring]), dincl.CatchUp(0.01, dincl.ActiveSet(1e-9)), [6.0])
        hit = np.sqrt(9.0 - (0.999 + y) ** 2)
        angle = 2 * np.arctan(np.tan(np.arctan2(0.999 + y, hit) / 2) * np.exp(-(5.0 - hit) / 3))
        assert np.abs(path.final - 3 * np.array([[np.cos(angle), -np.sin(angle)]])).max() <= 0.01


def test_a_function_with_noise_is_refused():
    digits = np.random.default_rng(0)
    noisy = dincl.Smooth(lambda x: 1 - np.linalg.norm(x, axis=1) + 1e-2 * digits.random(len(x)))
    with pytest.raises(dincl.InvalidProblem, match=r"g has noise: .* or pass jacobian"):
        problem(noisy)
    single = dincl.Smooth(lambda x: (1 - np.linalg.norm(x.astype(np.float32), axis=1)).astype(float))
    assert np.abs(single.jacobian(np.array([[0.6, -0.8]])) - [[-0.6, 0.8]]).max() <= 1e-3
