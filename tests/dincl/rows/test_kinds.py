"""What a kind of row says beyond values and Jacobian agrees with these; the rows come from every constraint."""

import numpy as np
import pytest

from tests.dincl.catalog import CONSTRAINTS

cases = pytest.mark.parametrize(("name", "d"), [(name, d) for name in CONSTRAINTS for d in (1, 2, 3)])


def drawn(name, d, rng):
    x = rng.normal(size=(6, d))
    return CONSTRAINTS[name][0](d).select(x, 100.0), x


@cases
def test_keys_tell_rows_apart_and_stay_with_them(name, d, rng):
    rows, _ = drawn(name, d, rng)
    keys = rows.keys()
    assert keys.shape == (len(rows), 2)
    assert len(np.unique(keys, axis=0)) == len(rows)
    keep = np.arange(len(rows)) % 2 == 1
    assert rows.take(keep).keys().tolist() == keys[keep].tolist()
    assert len({rows.label(k, d) for k in range(len(rows))}) == len(rows)


@cases
def test_polynomials_have_the_sign_of_g_and_their_steepness(name, d, rng):
    rows, y = drawn(name, d, rng)
    scale, w = 0.3, rng.normal(size=(6, d))
    polynomial = rows.polynomial(y, scale)
    if polynomial is None:
        assert rows.steepness(y).tolist() == [1.0] * len(rows)
        return
    # A program that was compiled for one row must not be taken for another.
    structures = {rows.take(np.arange(len(rows)) == k).structure for k in range(len(rows))}
    assert len(structures) == len(rows)

    def value(w):
        found = polynomial.constant + polynomial.linear @ w.ravel()
        if polynomial.i is not None:
            arrows = w[polynomial.i] - (0 if polynomial.j is None else w[polynomial.j])
            found = found + polynomial.weight * (arrows**2).sum(axis=1)
        return found

    x = y + scale * w
    assert (np.sign(value(w)) == np.sign(rows.values(x))).all()
    slope = differences(lambda x: scale * value((x - y) / scale), x)
    assert slope == pytest.approx(rows.steepness(x)[:, None] * rows.jacobian(x).toarray(), abs=1e-8)


@cases
def test_lengths_scale_with_the_unit_of_length(name, d, rng):
    """Rounding is measured in units of the lengths of a formula: a wall has none."""
    rows, _ = drawn(name, d, rng)
    assert rows.longest_length() == float(np.max(getattr(rows, "length", 0.0)))


@cases
def test_the_squared_form_has_the_sign_of_g_and_its_jacobian(name, d, rng):
    rows, x = drawn(name, d, rng)

    def value(x):
        return rows.squared_values(rows.values(x), rows.squared_steepness(x))

    assert (np.sign(value(x)) == np.sign(rows.values(x))).all()
    assert differences(value, x) == pytest.approx(rows.squared_jacobian(x).toarray(), abs=1e-7)
    steep = rows.squared_steepness(x)[:, None] * rows.jacobian(x).toarray()
    assert rows.squared_jacobian(x).toarray() == pytest.approx(steep, abs=1e-13)


@cases
def test_rows_of_other_particles_are_projected_by_their_formula(name, d, rng):
    """One row after another, x - y = multiplier grad g(x) and g(x) = 0 where it was violated."""
    rows, y = drawn(name, d, rng)
    if not rows.closed_form:
        with pytest.raises(NotImplementedError, match="no closed form"):
            rows.project(y.copy())
        with pytest.raises(NotImplementedError, match="no closed form"):
            rows.rows_per_particle(6)
        return
    tied = np.abs(rows.jacobian(y).toarray()).reshape(len(rows), 6, d).max(axis=2) > 0
    assert rows.rows_per_particle(6).tolist() == tied.sum(axis=0).tolist()
    for k in range(len(rows)):
        row, x = rows.take(np.arange(len(rows)) == k), y.copy()
        multiplier = row.project(x)
        assert row.values(x)[0] == pytest.approx(max(row.values(y)[0], 0.0), abs=1e-14)
        assert (x - y).ravel() == pytest.approx(multiplier * row.jacobian(x).toarray()[0], abs=1e-14)
        assert (multiplier[0] > 0) == (row.values(y)[0] < 0)


def differences(function, x):
    """The Jacobian by central differences."""
    columns = []
    for k in range(x.size):
        e = np.zeros(x.size)
        e[k] = 1e-6
        e = e.reshape(x.shape)
        columns.append((function(x + e) - function(x - e)) / 2e-6)
    return np.array(columns).T
