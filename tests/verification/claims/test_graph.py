"""Claims rest on claims: their order, and the corrections below each."""

import pytest

from dincl import InvalidProblem
from verification.claims import Claim, Correction, Effect, Evidence, Verdict, equal
from verification.claims.graph import corrected_below, ordered


def state(name: str, *rests_on: str, wrong: bool = False) -> Claim:
    correction = Correction("two", Effect.NUMBER, "all") if wrong else None
    recorded = Verdict.CORRECTED if wrong else Verdict.HOLDS
    found = Evidence(printed=(equal("one", 1, 1),))
    return Claim(name, "One.", lambda: found, rests_on=rests_on, correction=correction, recorded=recorded)


CLAIMS = [state("c", "a", "b"), state("b", "a", wrong=True), state("a", wrong=True), state("d", "c"), state("e")]


def test_claims_come_after_those_they_rest_on() -> None:
    order = ordered(CLAIMS)
    assert set(order) == set("abcde")
    assert [name for name in order if name in "abcd"] == list("abcd")


def test_corrections_mark_all_that_rests_on_them() -> None:
    below = corrected_below(CLAIMS)
    assert below == {"a": (), "e": (), "b": ("a",), "c": ("a", "b"), "d": ("a", "b")}


def test_unknown_names_and_circles_are_refused() -> None:
    with pytest.raises(InvalidProblem, match="claim c: rests_on names x, and there is no claim of this id"):
        ordered([state("c", "x")])
    with pytest.raises(InvalidProblem, match="claims rest on each other in a circle: "):
        ordered([state("a", "b"), state("b", "a")])
    with pytest.raises(InvalidProblem, match=r"claim a: rests_on = \('a',\): must be a tuple of ids of other claims"):
        state("a", "a")
