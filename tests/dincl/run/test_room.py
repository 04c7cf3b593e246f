"""Kernels stay in the room that they are handed: what lies around it is neither read nor written."""

import numpy as np
import pytest

import dincl
from dincl.run import compiled_sweeps
from tests.dincl.catalog import SCENES

SCHEMES = [dincl.PBD(0.05), dincl.SecondOrderPBD(0.05), dincl.Penalty(0.05, 10.0)]


@pytest.fixture
def guarded(monkeypatch):
    """Rooms with a row of NaN on each side; the arrays that hold them."""
    arrays, begin = [], compiled_sweeps._WithoutSolver.__init__

    def surrounded(self, *given):
        begin(self, *given)
        arrays.append(np.full((4, self.room.shape[1]), np.nan))
        arrays[-1][1:3] = self.room
        self.room = arrays[-1][1:3]

    monkeypatch.setattr(compiled_sweeps._WithoutSolver, "__init__", surrounded)
    return arrays


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: type(scheme).__name__)
def test_steps_stay_in_their_room(scheme, guarded):
    scene = SCENES[0]
    path = dincl.solve(scene, scheme, [0.5])
    assert np.isfinite(path.final).all()
    assert guarded
    for array in guarded:
        assert np.isnan(array[[0, 3]]).all()
        assert np.isfinite(array[1:3]).all()
