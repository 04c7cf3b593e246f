"""What three dimensions have in common with two, and what is the same from each side."""

import numpy as np
import pytest

from tests.tissue import kernel_calls as plane
from tests.tissue.space.space_calls import SURFACES, make_substeps, random_tissue
from tests.twins.tissue.space.state import SpaceTissue, Steps, distance, mapped
from tissue.files.parameters import preset
from tissue.runs.simulate import simulate

# One dt of 40 substeps: rounding grows by the dynamics.
ROUNDING = 1e-12


def section(cells, numbers):
    """The tissue of two dimensions in the plane z = 0: chains of junctions and of basal neighbours."""
    n = len(cells.x)
    chain = np.column_stack((np.arange(n - 1), np.arange(1, n)))
    flat, on, off = 0.0 * cells.x, np.ones(n), np.zeros(n)
    points = (np.array([*pair, flat]) for pair in ((cells.x, cells.y), (cells.ax, cells.ay), (cells.bx, cells.by)))
    k = numbers.junction_factor * (cells.stiff_aa[:-1] + cells.stiff_aa[1:]) / 2
    stiff = cells.stiff_ax, cells.stiff_bx, cells.stiff_axb
    lengths = 1 + cells.rest_ax, 1 + cells.rest_bx
    return SpaceTissue(*points, cells.radius, *stiff, *lengths, on, on, off, chain, cells.rest_aa[:-1], k, chain)


@pytest.mark.parametrize(("name", "seed", "substeps"), [("published", 0, 40), ("published", 1, 40), ("thesis", 2, 8)])
def test_the_planar_limit_is_the_step_of_two_dimensions(name, seed, substeps):
    """From the start of a run, and with the published parameters after an hour.

    In these substeps no basal point meets another, so that their order (C4) never comes up: it is no constraint here.
    """
    parameters = preset(name).changed({"numerics.t_end": "1 h", "numerics.keep": "1 h"})
    numbers = parameters.numbers()
    h = numbers.dt / numbers.substeps
    numbers = numbers._replace(dt=substeps * h, substeps=substeps)
    for frame in simulate(parameters, seed).frames[: 1 if name == "thesis" else 2]:
        expected = plane.make_substeps(frame.cells, frame.layers, numbers, None)
        steps = Steps(h, substeps, numbers.mu, numbers.spring_power, numbers.repulsion, numbers.max_basal_distance)
        made = make_substeps(section(frame.cells, numbers), steps)
        found = {"x": made.x[0], "y": made.x[1], "ax": made.a[0], "ay": made.a[1], "bx": made.b[0], "by": made.b[1]}
        for field, line in found.items():
            np.testing.assert_allclose(line, getattr(expected, field), rtol=0.0, atol=ROUNDING)
        np.testing.assert_array_equal([made.x[2], made.a[2], made.b[2]], 0.0)
        assert abs(expected.x - frame.cells.x).max() > 1e-2


def turned(axis, angle):
    """A rotation of points (3, n)."""
    cosine, sine, (k, m) = np.cos(angle), np.sin(angle), {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    matrix = np.eye(3)
    matrix[[k, k, m, m], [k, m, k, m]] = cosine, -sine, sine, cosine
    return lambda points: matrix @ points


def shifted(*by):
    return lambda points: points + np.array(by)[:, None]


def mirrored(axis):
    return lambda points: points * np.where(np.arange(3) == "xyz".index(axis), -1.0, 1.0)[:, None]


MAPS = {
    "a plane shifted": ("open plane", shifted(3.7, 0.0, -11.2)),
    "a plane turned": ("open plane", turned("y", 0.7)),
    "a plane mirrored": ("open plane", mirrored("z")),
    "a periodic plane shifted": ("periodic plane", shifted(2.9, 0.0, -31.7)),
    "a tight plane shifted by a period": ("tight plane", shifted(4.01, 0.0, -4.3)),
    "a periodic plane mirrored": ("periodic plane", mirrored("x")),
    "a cylinder turned": ("cylinder", turned("z", 2.1)),
    "a cylinder shifted": ("cylinder", shifted(0.0, 0.0, 5.3)),
    "a cylinder mirrored": ("open cylinder", mirrored("z")),
    "a sphere turned": ("sphere", lambda points: turned("z", 0.4)(turned("y", -2.0)(points))),
    "the inside of a sphere turned": ("inside of a sphere", turned("x", 1.1)),
    "a sphere mirrored": ("sphere", mirrored("y")),
}


@pytest.mark.parametrize("name", MAPS)
def test_steps_go_with_the_symmetries(name):
    """To rounding: balls keep the order of the cells, sums have another one."""
    where, image = MAPS[name]
    state, steps = random_tissue(120, 11, SURFACES[where]), Steps(0.00125, 4, surface=SURFACES[where])
    made = make_substeps(state, steps)
    assert distance(make_substeps(mapped(state, image), steps), mapped(made, image)) < ROUNDING
    assert distance(made, state) > 1e-2


@pytest.mark.parametrize("name", ["periodic plane", "tight plane", "strip", "cylinder"])
def test_cells_moved_by_periods_of_their_own_are_the_same(name):
    """Points are not wrapped: each cell may lie in a box of its own."""
    surface = SURFACES[name]
    state, steps = random_tissue(120, 12, surface), Steps(0.00125, 4, surface=surface)
    boxes = np.random.default_rng(0).integers(-3, 4, (3, 120)).astype(float)
    periods = np.array([[surface.period_x], [0.0], [surface.period_z]])
    away = boxes * np.where(np.isfinite(periods), periods, 0.0)
    made = make_substeps(state, steps)
    moved = make_substeps(mapped(state, lambda points: points + away), steps)
    assert distance(moved, mapped(made, lambda points: points + away)) < ROUNDING
