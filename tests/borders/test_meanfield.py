"""Generated calls of meanfield: an answer without a NaN, or a documented error; no other one, no warning, no wait."""

import pytest

import meanfield
from tests.borders.harness import complaints
from tests.borders.meanfield_calls import CALLS

ALLOWED = (meanfield.InvalidModel, meanfield.SolveFailed)
SEED = 20260105


def test_generated_calls():
    assert complaints(CALLS, ALLOWED, SEED, 1000) == []


@pytest.mark.slow
def test_many_generated_calls():
    assert complaints(CALLS, ALLOWED, SEED + 1, 10_000) == []
