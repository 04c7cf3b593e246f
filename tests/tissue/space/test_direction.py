"""The direction in which a cell divides lies in the surface, wherever the cell is, and turns by what is asked for."""

import math

import numpy as np
import pytest

from tissue.rules.sheet import direction
from tissue.state.surface import cylinder, plane, sphere

SURFACES = {
    "plane": (plane(), lambda X: np.array([0.0, 1.0, 0.0])),
    "cylinder": (cylinder(3.0, inside=True), lambda X: np.array([X[0], X[1], 0.0]) / math.hypot(X[0], X[1])),
    "sphere": (sphere(3.0, inside=False), lambda X: X / np.linalg.norm(X)),
}
# Also near the poles, where the z axis is the normal of the sphere.
PLACES = [*np.random.default_rng(20260120).normal(size=(30, 3)), *np.array([[0.1, 0.2, 3.0], [-0.3, 0.1, -2.0]])]


@pytest.mark.parametrize("turn", [0.0, 1 / 6, 0.4, 0.75])
@pytest.mark.parametrize("name", SURFACES)
def test_it_is_a_unit_vector_in_the_surface_that_turns(name, turn):
    surface, normal = SURFACES[name]
    for X in PLACES:
        first, found = (np.array(direction(surface, part, *map(float, X))) for part in (0.0, turn))
        assert np.linalg.norm(found) == pytest.approx(1.0)
        assert found @ normal(X) == pytest.approx(0.0, abs=1e-12)
        assert found @ first == pytest.approx(math.cos(2 * math.pi * turn))
        assert abs(np.cross(first, found) @ normal(X)) == pytest.approx(abs(math.sin(2 * math.pi * turn)))
