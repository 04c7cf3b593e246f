"""Techniques of proof: they prove what is true, refute what is false, refuse wrong variants that stand."""
# ruff: noqa: RUF001 - formulas are written with the minus sign of mathematics

import re
import sys
from typing import Any

import pytest

from verification.claims import (
    Correction,
    Effect,
    Evidence,
    FormalProof,
    Technique,
    Verdict,
    at_most,
    claim,
    proved,
    put_right,
)
from verification.claims.formal import Step, UnsoundProof, enclosures
from verification.claims.formal.algebra import library, matrices, squares, vanishes
from verification.claims.formal.enclosures import least_upper_bound
from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument, identity, implication

a, b, x, y = library().symbols("a b x y", real=True)
r, s = reals("r s")
A, B = matrices("A B")
f, g = (library().Function(name)(x) for name in "fg")


def binomial() -> FormalProof:
    return vanishes((a + b) ** 2 - a**2 - 2 * a * b - b**2, (a + b) ** 2 - a**2 + 2 * a * b - b**2)(
        "(a + b)² = …", "−2ab"
    )


@pytest.mark.parametrize(
    ("step", "true"),
    [
        (vanishes((a + b) ** 2 - a**2 - 2 * a * b - b**2, a), True),
        (vanishes((a + b) ** 2 - a**2 - b**2, a), False),
        (vanishes([a - a, a], b), False),
        (vanishes((A * B) * B**-1 * A**-1 - 1, A * B - 1), True),
        (vanishes(A * B - B * A, A), False),
        (vanishes((f * g).diff(x) - f.diff(x) * g - f * g.diff(x), f), True),
        (vanishes((f * g).diff(x) - f.diff(x) * g.diff(x), f), False),
        (squares(x**2 - 2 * x * y + y**2, x**2 - 4 * x * y + y**2, [(1, x - y)]), True),
        (squares(x**2 - 2 * x * y + y**2, x**2 - 4 * x * y + y**2, [(1, x + y)]), False),
        (squares(-(x**2), -(x**2), [(-1, x)]), False),
        (follows([r >= 1], r * r >= r, r * r >= 2 * r), True),
        (follows([r >= 0], r * r >= r, r * r >= 2 * r), False),
        (follows([r >= 1], [r * r >= r, r >= 0], ([r >= 0], r * r >= r)), True),
    ],
)
def test_what_is_true_is_proved_and_what_is_false_is_refuted(step: Step, true: bool) -> None:
    found = step("said", "a wrong variant")
    assert found.true is true
    assert proved(found).verdict is (Verdict.PROVED if true else Verdict.REFUTED)
    assert str(found).startswith(f"said: {'proved' if true else 'refuted'} by ")
    assert str(found).endswith("a wrong variant: refuted")


@pytest.mark.parametrize(
    ("step", "message"),
    [
        (vanishes(a - a, b - b), "is not refuted"),
        (squares(x**2, x**2, [(1, x)]), "is not refuted"),
        (follows([], r * r >= 0, s * s >= 0), "is not refuted"),
        (follows([r > 0, r < 0], r == 1, r == 2), "contradict"),
        (follows([r >= 1], r >= 1, r >= 2), "nothing follows"),
    ],
)
def test_a_proof_that_says_nothing_is_refused(step: Step, message: str) -> None:
    with pytest.raises(UnsoundProof, match=message):
        step("said", "the same")


def test_two_programs_decide_implications_of_real_numbers() -> None:
    found = follows([r >= 1], r * r >= r, r * r >= 2 * r)()
    assert found.technique is Technique.REALS
    assert re.fullmatch(r"z3 [\d.]+, cvc5 [\d.]+", found.tool)
    assert found.given == "r >= 1 ⊢ r*r >= r"


def test_a_bound_is_above_all_values_and_near_one() -> None:
    bound = least_upper_bound(lambda x: x * (1 - x), [(0.0, 1.0)], 1e-6)
    assert 0.25 <= bound <= 0.25 + 1e-6


def test_boxes_are_cut_where_it_helps() -> None:
    """Cuts of y, on which the function hardly depends, would never end."""
    bound = least_upper_bound(lambda x, y: x * (1 - x) + y * 1e-3, [(0.0, 1.0), (0.0, 1.0)], 1e-6)
    assert 0.251 <= bound <= 0.251 + 1e-6


def test_a_ball_that_is_not_finite_bounds_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where 1/x is not finite the search goes on, and gives up."""
    monkeypatch.setattr(enclosures, "LARGEST", 500)
    with pytest.raises(ArithmeticError, match="no bound within"):
        least_upper_bound(lambda x: 1 / x, [(-1.0, 1.0)])


@pytest.mark.parametrize(("tried_on", "verdict"), [("", Verdict.PROVED), ("two numbers", Verdict.PROVED_INSTANCE)])
def test_the_verdict_of_a_proof(tried_on: str, verdict: Verdict) -> None:
    made = claim("my.binomial", "The square of a sum", recorded=verdict, tried_on=tried_on)(lambda: proved(binomial()))
    assert made.verdict(made.decide({})) is verdict


def test_a_correction_is_proved_and_its_printed_form_refuted() -> None:
    found = put_right(binomial())
    assert found.verdict is Verdict.CORRECTED
    assert found.measured.startswith("Refuted as printed, −2ab. Proved: (a + b)²")
    assert [each.true for each in found.printed] == [False]
    assert re.fullmatch(r"−2ab: refuted by computer algebra \(sympy [^)]*\)", str(found.printed[0]))


def test_measured_numbers_beside_a_proof_are_no_proof() -> None:
    assert Evidence("both", (binomial(), at_most("one", 1, 2))).verdict is Verdict.HOLDS


def test_an_entry_is_a_claim_with_its_wrong_variant() -> None:
    about: dict[str, Any] = {"right": (x + y) ** 2 - x**2 - 2 * x * y - y**2, "wrong": (x + y) ** 2 - x**2 - y**2}
    read = Correction("2xy is missing", Effect.NUMBER, "nothing")
    square = identity("my.square", "(1)", "(x + y)² = x² + y²", "A square", correction=read, **about)
    assert square.recorded is square.verdict(square.decide({})) is Verdict.CORRECTED
    assert square.decide({}).measured == "Refuted as printed, (x + y)² = x² + y². Proved: 2xy is missing."
    assert square.module == __name__
    grows = {"given": [r >= 0, r < s], "then": r * r < s * s, "wrong": ([r < s], r * r < s * s)}
    larger = implication("my.grows", "(2)", "r < s gives r² < s²", "Squares grow", **grows)
    assert larger.recorded is larger.verdict(larger.decide({})) is Verdict.PROVED
    both = argument("my.both", "(3)", "", "Both", vanishes(x - x, x), squares(x**2, -(x**2), [(1, x)]), tried_on="two")
    assert both.recorded is both.verdict(both.decide({})) is Verdict.PROVED_INSTANCE
    with pytest.raises(UnsoundProof, match="its wrong variant"):
        identity("my.same", "(4)", "", "The same", right=x - x, wrong=y - y).decide({})


def test_a_missing_library_leaves_a_claim_open(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "sympy", None)
    monkeypatch.setattr("dincl.extras.find_spec", lambda _: None)
    made = claim("my.binomial", "The square of a sum", recorded=Verdict.PROVED)(lambda: proved(binomial()))
    found = made.decide({})
    assert found.verdict is Verdict.OPEN
    assert "pip install '.[proofs]'" in found.measured
