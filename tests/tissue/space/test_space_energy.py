"""Forces in three dimensions are -grad W, by complex steps; the energy is that of two dimensions in the plane z = 0."""

import numpy as np
import pytest

import dincl
from tests.tissue import states
from tests.tissue.space import space_calls as kernels
from tests.tissue.space.space_calls import SURFACES, random_tissue
from tests.twins.tissue.space import steps as twins
from tests.twins.tissue.space.state import Steps
from tissue.model import energy as plane_energy
from tissue.model.energy import parts_of

STEP = 1e-30  # of the complex step: its error is STEP^2, below any rounding


def gradient(state, steps):
    """dW/dX, dW/dA, dW/dB, (3, n) each, coordinate by coordinate."""
    points, found = [state.x, state.a, state.b], np.zeros((3, *state.x.shape))
    for place in np.ndindex(found.shape):
        shifted = [part.astype(complex) for part in points]
        shifted[place[0]][place[1:]] += 1j * STEP
        found[place] = sum(parts_of(*shifted, twins.elastic(state, steps), steps.surface)).imag / STEP
    return found


@pytest.mark.parametrize("name", ["open plane", "tight plane", "cylinder"])
@pytest.mark.parametrize("power", [1, 2])
def test_forces_are_the_gradient(name, power):
    """Of the twins to rounding; of the kernels, over one substep, to rounding of the coordinates over h / mu."""
    surface = SURFACES[name]
    steps = Steps(power=power, surface=surface, h=0.05)
    n = 40
    free = {"held": np.zeros(n), "b_moves": np.ones(n), "runs": np.zeros(n), "radius": np.zeros(n)}
    state = random_tissue(n, 3, surface, **free, neighbours=np.zeros((0, 2), np.int64))
    slope, scale = gradient(state, steps), steps.h / steps.mu
    np.testing.assert_allclose(-slope, twins.forces(state, steps), rtol=0.0, atol=1e-12 * abs(slope).max())
    made = kernels.make_substeps(state, steps)
    moved = np.array([made.x - state.x, made.a - state.a, made.b - state.b]) / scale
    np.testing.assert_allclose(-slope, moved, rtol=0.0, atol=2e-14 * (10.0 + abs(slope).max()) / scale)


def test_a_step_of_descent_lowers_the_energy():
    """By h / mu |grad W|^2 to first order."""
    steps = Steps(h=1e-6)
    free = {"held": np.zeros(30), "b_moves": np.ones(30), "runs": np.zeros(30), "radius": np.zeros(30)}
    state = random_tissue(30, 5, steps.surface, **free, neighbours=np.zeros((0, 2), np.int64))
    made, elastic = kernels.make_substeps(state, steps), twins.elastic(state, steps)
    before, after = (sum(parts_of(one.x, one.a, one.b, elastic)) for one in (state, made))
    square = sum((force**2).sum() for force in twins.forces(state, steps))
    assert before - after == pytest.approx(steps.h / steps.mu * square, rel=1e-3)


def test_in_the_plane_it_is_the_energy_of_two_dimensions():
    cells, layers, numbers = states.cells(30, 0), states.layers(30), states.numbers()
    edges = np.column_stack((np.arange(29), np.arange(1, 30)))
    k = numbers.junction_factor * (cells.stiff_aa[:-1] + cells.stiff_aa[1:]) / 2
    x, a, b = (
        np.array([*pair, 0.0 * cells.x]) for pair in ((cells.x, cells.y), (cells.ax, cells.ay), (cells.bx, cells.by))
    )
    fields = cells.stiff_ax, cells.stiff_bx, cells.stiff_axb, 1 + cells.rest_ax, 1 + cells.rest_bx
    elastic = twins.Elastic(*fields, edges, cells.rest_aa[:-1], k, numbers.spring_power, numbers.repulsion)
    parts = parts_of(x, a, b, elastic)
    np.testing.assert_allclose(parts, plane_energy.parts(cells, layers, numbers), rtol=1e-12)


def test_bad_points():
    state = random_tissue(5, 0, SURFACES["open plane"])
    elastic = twins.elastic(state, Steps())
    with pytest.raises(dincl.InvalidProblem, match="nucleus and apical point of cell 0 lie on one point"):
        parts_of(state.x, state.x, state.b, elastic)
    with pytest.raises(dincl.InvalidProblem, match="b has coordinates that are not finite"):
        parts_of(state.x, state.a, state.b * np.nan, elastic)
