"""Generated calls of dincl: an answer without a NaN, or a documented error; never another one, a warning or a wait."""

import pytest

import dincl
from tests.borders.dincl_calls import CALLS
from tests.borders.harness import Call, complaints

ALLOWED = (dincl.InvalidProblem, dincl.StepFailed, dincl.ProjectionFailed, dincl.MinimisationFailed)
SEED = 20260101


@pytest.mark.slow
def test_generated_calls():
    assert complaints(CALLS, ALLOWED, SEED, 1000) == []


@pytest.mark.xslow
def test_many_generated_calls():
    assert complaints(CALLS, ALLOWED, SEED + 1, 10_000) == []


@pytest.mark.parametrize(
    ("function", "kind"),
    [
        (lambda x: x["k"], "TypeError"),
        (lambda x: float("nan"), "NaN in the answer"),
        (lambda x: __import__("warnings").warn("so", UserWarning, stacklevel=2), "warning UserWarning"),
    ],
)
def test_the_judge_sees(function, kind):
    found = complaints([Call("f", function, {"x": (1.0,)})], ALLOWED, 3, 30)
    assert any(text.startswith(kind) for text in found)
    assert all("seed 3" in text for text in found)
