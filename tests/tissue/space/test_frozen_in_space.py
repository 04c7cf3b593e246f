"""The frozen tissue in space: forces by differentiation and by the kernel, its sets, and one limit of all schemes."""

from functools import cache

import numpy as np
import pytest

import dincl
import tissue
from tests.tissue.space.in_space import of_surface
from tests.tissue.space.space_calls import make_substeps
from tests.twins.tissue.space.state import SpaceTissue, Steps
from tissue.model.energy import Elastic, parts_of
from tissue.state.surface import cylinder, plane
from verification.thesis.quasi_steady.frozen import (
    cells_at,
    constraints_in_space,
    frozen_problem_in_space,
    made_feasible_in_space,
    particles,
)

STEP = 1e-30  # of the complex step: its error is STEP^2, below any rounding
CHANGES = {"tissue__cells": 16, "numerics__t_end": "1 h"}


@cache
def grown():
    """A small tissue on an open plane, and its numbers."""
    given = of_surface("open", **CHANGES)
    return tissue.simulate(given, seed=1).final, given.numbers()


@cache
def in_s():
    frame, numbers = grown()
    return made_feasible_in_space(frame, numbers, dincl.Ipopt(1e-10)), numbers


def elastic(frame, numbers):
    cells, apical = frame.cells, frame.sheets.apical
    joined, rest = apical.edges, apical.rest
    k = numbers.junction_factor * cells.stiff_aa[joined].mean(axis=1)
    fields = cells.stiff_ax, cells.stiff_bx, cells.stiff_axb, 1 + cells.rest_ax, 1 + cells.rest_bx
    return Elastic(*fields, joined, rest, k, numbers.spring_power, numbers.repulsion)


def thirds(x):
    return [part.T for part in np.split(x, 3)]


def by_substeps(frame, numbers, h, substeps):
    """The particles (3n, 3) after so many substeps of length h, by the kernel, without noise."""
    cells, of, n = frame.cells, elastic(frame, numbers), len(frame.cells.x)
    x, a, b = thirds(particles(cells, "xyz"))
    held = np.isin(np.arange(n), frame.layers.basal).astype(float)
    own = {name: value for name, value in of._asdict().items() if name not in ("power", "repulsion")}
    near = frame.sheets.basal.edges
    state = SpaceTissue(x, a, b, cells.radius, **own, b_moves=np.ones(n), held=held, runs=0 * held, neighbours=near)
    steps = Steps(h, substeps, numbers.mu, numbers.spring_power, numbers.repulsion, numbers.max_basal_distance)
    made = make_substeps(state, steps)
    return np.concatenate([made.x.T, made.a.T, made.b.T])


def test_particles_and_back():
    frame, _ = grown()
    cells, n = frame.cells, len(frame.cells.x)
    x = particles(cells, "xyz")
    assert x[3].tolist() == [cells.x[3], cells.y[3], cells.z[3]]
    assert x[n + 3].tolist() == [cells.ax[3], cells.ay[3], cells.az[3]]
    for name, value in cells_at(x, frame.cells, frame.layers, "xyz")._asdict().items():
        assert value.tolist() == getattr(cells, name).tolist()
    moved = cells_at(x + 1.0, frame.cells, frame.layers, "xyz")
    assert moved.bz.tolist() == (cells.bz + 1).tolist()
    assert (moved.by[frame.layers.basal] == 0.0).all()
    with pytest.raises(dincl.InvalidProblem, match=r"must have the shape \(3n, 3\)"):
        cells_at(x[1:], frame.cells, frame.layers, "xyz")


def test_drift_is_the_gradient_over_damping():
    frame, numbers = in_s()
    problem, of = frozen_problem_in_space(frame, numbers), elastic(frame, numbers)
    slope = np.zeros_like(problem.x0)
    for place in np.ndindex(slope.shape):
        x = problem.x0.astype(complex)
        x[place] += 1j * STEP
        slope[place] = sum(parts_of(*thirds(x), of)).imag / STEP
    held = 2 * len(frame.cells.x) + frame.layers.basal
    assert abs(slope[held, 1]).max() > 0
    slope[held, 1] = 0.0
    assert abs(slope).max() > 0.1
    np.testing.assert_allclose(
        problem.velocity(0.0, problem.x0), -slope / numbers.mu, rtol=0.0, atol=1e-11 * abs(slope).max() / numbers.mu
    )


def test_constraints_are_distances():
    """(C1) of all pairs of balls, (C2) along the edges of the basal network."""
    frame, numbers = in_s()
    cells, n = frame.cells, len(frame.cells.x)
    x = particles(cells, "xyz")
    balls, links = (part.select(x, 1e3).values(x) for part in constraints_in_space(frame, numbers))
    i, j = np.tril_indices(n, -1)
    gaps = np.linalg.norm(x[i] - x[j], axis=1) - cells.radius[i] - cells.radius[j]
    ends = 2 * n + frame.sheets.basal.edges
    slack = numbers.max_basal_distance - np.linalg.norm(x[ends[:, 0]] - x[ends[:, 1]], axis=1)
    np.testing.assert_allclose(np.sort(balls), np.sort(gaps), atol=1e-13)
    np.testing.assert_allclose(np.sort(links), np.sort(slack), atol=1e-13)
    assert min(gaps.min(), slack.min()) > -1e-8


def test_one_tiny_substep_is_the_drift():
    """Where nothing is projected, the displacement of the kernel is h times the drift, to rounding of coordinates."""
    frame, numbers = in_s()
    problem, h = frozen_problem_in_space(frame, numbers), 1e-6
    moved = (by_substeps(frame, numbers, h, 1) - problem.x0) / h
    drift = problem.velocity(0.0, problem.x0)
    n = len(frame.cells.x)
    free = slice(n, 2 * n)  # no constraint acts on apical points
    np.testing.assert_allclose(moved[free], drift[free], rtol=0.0, atol=1e-14 * abs(problem.x0).max() / h)


def test_substeps_approach_catch_up():
    """The distance of substeps to catch-up falls with their number, as does that of catch-up to itself."""
    frame, numbers = in_s()
    problem, end = frozen_problem_in_space(frame, numbers), numbers.dt
    scheme = dincl.MidpointCatchUp(end / 160, dincl.ProjectedCG(tol=1e-10))
    true = dincl.solve(problem, scheme, t=[end]).final
    errors = [abs(by_substeps(frame, numbers, end / k, k) - true).max() for k in (20, 80, 320)]
    moved = abs(true - problem.x0).max()
    assert errors[0] < 0.2 * moved
    assert errors[1] < 0.6 * errors[0]
    assert errors[2] < 0.6 * errors[1]


def test_the_problem_keeps_its_own_copy():
    frame, numbers = in_s()
    cells = frame.cells._replace(**{name: value.copy() for name, value in frame.cells._asdict().items()})
    problem = frozen_problem_in_space(frame._replace(cells=cells), numbers)
    before = problem.velocity(0.0, problem.x0)
    for array in cells:
        array[:] = 0
    assert problem.velocity(0.0, problem.x0).tolist() == before.tolist()


@pytest.mark.parametrize("surface", [plane(period_x=9.0, period_z=9.0), cylinder(3.0, inside=True)])
def test_surfaces_without_constraints_are_refused(surface):
    frame, numbers = grown()
    other = frame._replace(sheets=frame.sheets._replace(surface=surface))
    with pytest.raises(dincl.InvalidProblem, match="must be an open plane"):
        frozen_problem_in_space(other, numbers)


def test_a_basal_point_off_the_plane_is_refused():
    frame, numbers = grown()
    cells = frame.cells._replace(by=frame.cells.by + 0.5)
    with pytest.raises(dincl.InvalidProblem, match=r"must be 0 in the basal layer  \(C3\)"):
        frozen_problem_in_space(frame._replace(cells=cells), numbers)


def test_a_frame_of_the_plane_is_refused():
    frame, numbers = grown()
    with pytest.raises(dincl.InvalidProblem, match=r"frame\.sheets = None"):
        frozen_problem_in_space(frame._replace(sheets=None), numbers)
