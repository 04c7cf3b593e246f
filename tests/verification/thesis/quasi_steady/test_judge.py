"""The constrained minimiser: minima that are known, conditions that are recomputed, starts that are infeasible."""

import numpy as np
import pytest
from scipy.optimize import minimize

import dincl
from tests.tissue.states import cells, layers, numbers, tissue
from tissue.model.energy import energy, forces
from tissue.state.cells import CellLayers
from verification.thesis.quasi_steady import judge, program
from verification.thesis.quasi_steady.frozen import cells_at, constraints, particles
from verification.thesis.quasi_steady.judge import local_minimum

TOL = 1e-8
STEP = 1e-30


def shape(state):
    """The particles, moved along the line so that their mean is 0."""
    x = particles(state)
    return x - [x[:, 0].mean(), 0.0]


def slope(state, network, given):
    """Grad W by complex steps, shape (3n, 2), zero where the basal line holds."""
    x = particles(state).astype(complex)
    found = np.zeros(x.shape)
    for place in np.ndindex(x.shape):
        moved = x.copy()
        moved[place] += STEP * 1j
        found[place] = energy(cells_at(moved, state, network), network, given).imag / STEP
    found[2 * len(state.x) + network.basal, 1] = 0.0
    return found


def reactions(found):
    """The multipliers by the names of the particles."""
    labels = [(type(block).__name__, block.label(k, 2)) for block in found.rows.blocks for k in range(len(block))]
    return dict(zip(labels, found.multipliers, strict=True))


@pytest.mark.parametrize("power", [1, 2])
def test_a_bent_cell_becomes_straight_with_springs_at_their_lengths(power):
    bent = tissue([[0.7, 2.0]], [[-0.3, 4.0]], [[0.4, 0.0]], rest_ax=0.8, rest_bx=2.0)
    found = local_minimum(bent, layers(1), numbers(spring_power=power), TOL)
    x, a, b = particles(found.cells)
    assert found.status is dincl.Status.SUCCESS
    assert found.energy == pytest.approx(0, abs=1e-14)
    assert (np.linalg.norm(a - x), np.linalg.norm(b - x)) == pytest.approx((1.8, 3.0))
    assert np.linalg.norm(a - b) == pytest.approx(4.8)
    assert b[1] == 0


def test_a_chain_at_the_maximal_basal_distance():
    """Nuclei that repel each other spread the cells until the basal layer holds them; half of it is in balance."""
    side, given = np.array([-1.0, 0.0, 1.0]), numbers(repulsion=8.0)
    points = [np.column_stack((width * side, np.full(3, y))) for width, y in ((0.9, 2.5), (0.5, 5.0), (0.3, 0.0))]
    found = local_minimum(tissue(*points), layers(3), given, TOL)
    at, on = found.cells, reactions(found)
    assert np.diff(at.bx) == pytest.approx(np.full(2, given.max_basal_distance), abs=1e-9)
    arrows = np.diff(particles(at)[:6].reshape(2, 3, 2), axis=1)
    (gap, _), (reach, _) = np.linalg.norm(arrows, axis=2)
    push = given.repulsion * (2 - gap) * arrows[0, 0, 0] / gap
    tension = given.alpha_aa * (reach - 1 / 3) * arrows[1, 0, 0] / reach
    far = at.x[2] - at.x[0], at.y[2] - at.y[0]
    push += given.repulsion * max(0.0, 2 - np.hypot(*far)) * far[0] / np.hypot(*far)
    hold = on["DistanceRows", "particle 7 and 6"]
    assert hold == pytest.approx(push - tension, rel=1e-8)
    assert hold > 0.1
    assert on["DistanceRows", "particle 8 and 7"] == pytest.approx(hold, rel=1e-6)


TISSUES = {
    "crowded": (cells(14, 0), layers(14), {}),
    "published": (cells(14, 1), layers(14), {"spring_power": 2, "junction_factor": 0.25, "repulsion": 0.5}),
    "some in no layer": (cells(10, 2), layers(10, apical=[0, 1, 4, 5, 8, 9], basal=[0, 2, 3, 5, 6, 7, 9]), {}),
    "upside down": (cells(8, 3)._replace(y=-cells(8, 3).y, ay=-cells(8, 3).ay), layers(8), {}),
}


@pytest.mark.parametrize("name", TISSUES)
def test_the_conditions_of_a_minimum_hold(name):
    """Recomputed from complex steps and from the constraints, not from the forces and not by the minimiser."""
    state, network, changes = TISSUES[name]
    given = numbers(**changes)
    found = local_minimum(state, network, given, TOL)
    x = particles(found.cells)
    misfit = slope(found.cells, network, given) - (found.multipliers @ found.rows.jacobian(x)).reshape(x.shape)
    misfit[2 * len(state.x) + network.basal, 1] = 0.0
    assert found.status is dincl.Status.SUCCESS
    assert found.stationarity == pytest.approx(np.abs(misfit).max(), abs=1e-12)
    assert found.multipliers.min() >= 0
    assert (found.multipliers > 0.01).sum() >= 3
    assert np.abs(found.multipliers * found.rows.values(x)).max() < TOL
    assert max(found.residual, found.violation, np.abs(misfit).max()) <= TOL
    for family in constraints(state, network, given):
        assert family.select(x, 0.0).values(x).min(initial=0.0) >= -TOL
    assert found.energy == pytest.approx(energy(found.cells, network, given))
    assert found.energy < 0.8 * energy(state, network, given)
    assert x[:, 0].sum() == pytest.approx(particles(state)[:, 0].sum(), abs=1e-9)
    assert found.cells.rest_ax is state.rest_ax


def by_slsqp(state, network, given):
    """The same minimum by a method of another kind, from the same start; all pairs, dense."""
    x0 = particles(state)
    free = np.ones(x0.shape, dtype=bool)
    free[2 * len(state.x) + network.basal, 1] = False
    sets = constraints(state, network, given)

    def full(z):
        x = x0.copy()
        x[free] = z
        return x

    def gaps(z):
        return np.concatenate([family.select(full(z), 100.0).values(full(z)) for family in sets])

    def value(z):
        at = cells_at(full(z), state, network)
        return energy(at, network, given), -particles(forces(at, network, given))[free]

    rules = {"type": "ineq", "fun": gaps}
    return minimize(
        value, x0[free], jac=True, constraints=rules, method="SLSQP", options={"ftol": 1e-15, "maxiter": 1000}
    )


@pytest.mark.parametrize("seed", [1, 2, 3])  # from seed 0 both find a minimum, Ipopt the lower one
def test_three_cells_against_slsqp(seed):
    state, network, given = cells(3, seed, radius=0.7), layers(3), numbers(max_basal_distance=0.25)
    state = local_minimum(state, network, given, TOL).cells
    rng = np.random.default_rng(seed)
    state = state._replace(y=state.y + rng.uniform(0.0, 0.1, 3), ay=state.ay + rng.uniform(-0.2, 0.2, 3))
    state = state._replace(x=state.x * 1.05, rest_ax=state.rest_ax + 0.1)
    found, other = local_minimum(state, network, given, TOL), by_slsqp(state, network, given)
    assert found.energy == pytest.approx(other.fun, abs=1e-8)
    assert found.energy <= other.fun + 1e-10
    assert found.residual <= TOL


@pytest.mark.parametrize("seed", range(3))
def test_at_a_minimum_the_search_stays(seed):
    network, given = layers(30), numbers()
    least = local_minimum(cells(30, seed), network, given, TOL)
    again = local_minimum(least.cells, network, given, TOL)
    assert np.abs(particles(again.cells) - particles(least.cells)).max() < 1e-6
    rng = np.random.default_rng(seed)
    noisy = least.cells._replace(
        x=least.cells.x + 1e-2 * rng.normal(size=30), y=least.cells.y + 1e-2 * rng.normal(size=30)
    )
    back = local_minimum(noisy, network, given, TOL)
    assert energy(noisy, network, given) > least.energy + 1e-4
    assert back.energy == pytest.approx(least.energy, abs=1e-9)
    assert np.abs(shape(back.cells) - shape(least.cells)).max() < 1e-6


def test_a_start_that_breaks_every_rule():
    rng = np.random.default_rng(3)
    state = cells(12, 3)
    state = state._replace(
        x=rng.uniform(-0.4, 0.4, 12), y=3 + rng.uniform(-0.4, 0.4, 12), bx=5 * rng.permutation(state.bx)
    )
    broken = [
        family.select(particles(state), 0.0).values(particles(state)).min()
        for family in constraints(state, layers(12), numbers())
    ]
    assert max(broken) < -0.5
    found = local_minimum(state, layers(12), numbers(), TOL)
    assert found.status
    assert found.violation <= TOL


def test_pairs_that_are_met_on_the_way_are_taken_in():
    """Nuclei far apart at the start, held together by their cells at the end."""
    state = tissue([[-5.0, 2.5], [5.0, 2.5]], [[-0.1, 5.0], [0.1, 5.0]], [[-0.1, 0.0], [0.1, 0.0]], radius=0.9)
    found = local_minimum(state, layers(2), numbers(repulsion=0.1), TOL)
    assert found.status
    assert found.starts > 1
    assert found.cells.x[1] - found.cells.x[0] == pytest.approx(1.8, abs=1e-8)


def test_a_pair_may_end_at_the_kink_of_the_energy():
    """Cells of no layer part until their soft discs just touch; there the second derivative of W jumps."""
    state = tissue([[0.0, 2.5], [1.0, 2.6]], [[0.0, 5.0], [1.0, 5.0]], [[0.0, 0.0], [1.0, 0.0]])
    found = local_minimum(state, CellLayers(np.zeros(0, np.int64), np.zeros(0, np.int64)), numbers(), TOL)
    at = found.cells
    assert found.status
    assert found.energy == pytest.approx(0, abs=1e-12)
    assert np.hypot(at.x[1] - at.x[0], at.y[1] - at.y[0]) > 2 - 1e-7


def test_failure_is_said_and_the_start_comes_back(monkeypatch):
    state = cells(6, 0)
    monkeypatch.setattr(program, "OPTIONS", program.OPTIONS | {"ipopt.max_iter": 2})
    found = local_minimum(state, layers(6), numbers(), TOL)
    assert found.status is dincl.Status.NOT_CONVERGED
    assert "Maximum_Iterations_Exceeded" in found.detail
    assert found.starts == len(program.BARRIERS)
    assert particles(found.cells).tolist() == particles(state).tolist()
    assert np.isfinite(found.residual)
    assert found.residual > 1


BAD = {
    "tol": ({}, 0.0, "tol = 0.0: must be .* > 0"),
    "off the line": ({"by": [0.0, 0.2]}, TOL, r"cells.by\[1\] = 0.2: must be 0 in the basal layer"),
    "no force": ({"x": [0.0, 0.0]}, TOL, "nuclei of cells 1 and 0 lie on one point"),
    "nan": ({"ay": [5.0, np.nan]}, TOL, "a has coordinates that are not finite"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_refused_before_the_search(case, monkeypatch):
    monkeypatch.setattr(judge, "_search", None)
    change, tol, message = BAD[case]
    good = tissue([[0.0, 2.5], [1.0, 2.5]], [[0.0, 5.0], [1.0, 5.0]], [[0.0, 0.0], [0.3, 0.0]])
    bad = good._replace(**{name: np.array(values) for name, values in change.items()})
    with pytest.raises(dincl.InvalidProblem, match=message):
        local_minimum(bad, layers(2), numbers(), tol)
