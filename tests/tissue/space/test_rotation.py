"""No rule of the third dimension knows a direction: a tissue that is turned has the turned run, to rounding.

Hard balls are small, basal neighbours free and apical points not crowded, so that neither the order of the sweeps nor
that of exchanges of neighbours matters. The direction of a division is drawn from one that turns with a cylinder;
sheets and spheres are turned without divisions.
"""

from dataclasses import replace

import numpy as np
import pytest

from tests.tissue.space.in_space import of_surface
from tissue.files.parameters import Parameters
from tissue.runs.simulate import simulate
from tissue.state.cells import NAMED
from tissue.state.surface import laid

QUIET = {
    "tissue__diffusion": "0 um^2/h",
    "cell__hard_radius": "1e-3 R_soft",
    "cell__enlarged_radius": "1e-3 R_soft",
    "tissue__max_basal_distance": "5 R_soft",
    "start__nuclei": "own_basal",
    "types__slow__cells": 20,
    "types__slow__place": "scattered",
    "types__slow__rate_aa": "0.01 1/h",
    "types__slow__alpha_aa": 20,
    "types__leaving__cells": 6,
    "types__leaving__place": "scattered",
    "types__leaving__divides": False,
    "types__leaving__rate_aa": "5 1/h",
    "types__leaving__a": "0.5 h",
    "types__leaving__b": "0.5 h to 1 h",
    "types__leaving__p": "1 h",
    "numerics__t_end": "1.5 h",
}
STAYS, OUTSIDE = {"tissue__two_daughters": 0}, {"layer__side": "outside"}
TURNS = {
    "cylinder, with divisions": ("cylinder", OUTSIDE, (0.0, 0.0, 2.0)),
    "cylinder upside down": ("cylinder", OUTSIDE | STAYS, (np.pi, 0.0, 0.0)),
    "open sheet": ("open", STAYS, (0.0, 0.7, 0.0)),
    "periodic sheet by half a turn": ("plane", STAYS, (0.0, np.pi, 0.0)),
    "sphere": ("sphere", STAYS, (0.4, -1.1, 0.8)),
}


def rotation(x, y, z):
    """The matrix of the rotation by the vector (Rodrigues)."""
    angle = float(np.hypot(np.hypot(x, y), z))
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]) / angle
    return np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * k @ k


def points(cells):
    """X, A and B, (3, 3, n)."""
    return np.array([[getattr(cells, letter + axis) for axis in "xyz"] for letter in ("", "a", "b")])


def junctions(frame):
    """The rest length of each apical junction, by its cells."""
    mesh = frame.sheets.apical
    ends = zip(*mesh.edges.T.tolist(), mesh.rest.tolist(), strict=True)
    return {(i, j): rest for i, j, rest in ends}


@pytest.mark.parametrize("name", TURNS)
def test_a_turned_tissue_has_the_turned_run(name, monkeypatch):
    surface, changes, turn = TURNS[name]
    given, lattice = of_surface(surface, **{**QUIET, **changes}), Parameters.lattice
    matrix = rotation(*turn)

    def final(rotated):
        """The end of the run from a lattice out of order: in order, edges would be as long as others."""

        def basal(parameters):
            found = lattice(parameters)
            shaken = found.basal + 0.1 * found.spacing * np.random.default_rng(0).uniform(-1, 1, found.basal.shape)
            points = np.array([laid(found.surface, point) for point in shaken.T]).T
            return replace(found, basal=np.ascontiguousarray(rotated @ points))

        monkeypatch.setattr(Parameters, "lattice", basal)
        return simulate(given, 1).final

    frame, other = final(np.eye(3)), final(matrix)
    assert (frame.cells.events[frame.cells.kind == NAMED + 1] > 0).all()
    assert (len(frame.cells.x) > given.tissue.cells) == ("with divisions" in name)
    np.testing.assert_allclose(points(other.cells), np.einsum("ij,ajn->ain", matrix, points(frame.cells)), atol=1e-9)
    for rest in ("rest_ax", "rest_bx"):
        np.testing.assert_allclose(getattr(other.cells, rest), getattr(frame.cells, rest), atol=1e-9)
    one, two = junctions(frame), junctions(other)
    assert one.keys() == two.keys()
    assert max(abs(one[ends] - two[ends]) for ends in one) < 1e-9
    assert np.ptp(list(one.values())) > 0.1
