"""Kernels stay in the room that they are handed: what lies around it is neither read nor written."""

import numpy as np
import pytest

import dincl
from dincl.steps.stepper import CompiledStepper
from tests.dincl.catalog import SCENES

SCHEMES = [dincl.PBD(0.05), dincl.SecondOrderPBD(0.05), dincl.Penalty(0.05, 10.0)]


@pytest.fixture
def guarded(monkeypatch):
    """Arrays of steps with a row of NaN on each side."""
    arrays, begin = [], CompiledStepper.__init__

    def surrounded(self, *given, **named):
        begin(self, *given, **named)
        for name in ("x", "after", "rate"):
            arrays.append(np.full((3, self.problem.x0.size), np.nan))
            arrays[-1][1] = 0.0
            self.pointer.replace({name: arrays[-1][1]})

    monkeypatch.setattr(CompiledStepper, "__init__", surrounded)
    return arrays


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: type(scheme).__name__)
def test_steps_stay_in_their_arrays(scheme, guarded):
    path = dincl.solve(SCENES[0], scheme, [0.5])
    assert np.isfinite(path.final).all()
    assert guarded
    for array in guarded:
        assert np.isnan(array[[0, 2]]).all()
        assert np.isfinite(array[1]).all()
