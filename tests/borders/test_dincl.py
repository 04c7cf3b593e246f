"""Generated calls of dincl: an answer without a NaN, or a documented error; never another one, a warning or a wait."""

import pytest

import dincl
from tests.borders.dincl_calls import CALLS
from tests.borders.harness import complaints

ALLOWED = (dincl.InvalidProblem, dincl.StepFailed, dincl.ProjectionFailed, dincl.MinimisationFailed)
SEED = 20260101


@pytest.mark.slow
def test_generated_calls():
    assert complaints(CALLS, ALLOWED, SEED, 1000) == []


@pytest.mark.xslow
def test_many_generated_calls():
    assert complaints(CALLS, ALLOWED, SEED + 1, 10_000) == []
