"""Techniques of proof: they prove what is true, refute what is false, refuse wrong variants that stand."""
# ruff: noqa: RUF001 - formulas are written with the minus sign of mathematics

import re
import sys

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
from verification.formal import UnsoundProof, enclosures
from verification.formal.algebra import identity as old_identity
from verification.formal.algebra import library, matrices, squares, sum_of_squares, vanishes
from verification.formal.cases import all_cases, in_all
from verification.formal.enclosures import least_upper_bound, not_negative, positive
from verification.formal.reals import implication as old_implication
from verification.formal.reals import reals
from verification.formal.stated import argument, identity, implication


def binomial() -> FormalProof:
    return old_identity("(a + b)² = a² + 2ab + b²", lambda s, a, b: (a + b) ** 2 - a**2 - s * 2 * a * b - b**2, "−2ab")


@pytest.mark.slow
def test_an_identity_is_proved_for_all_values() -> None:
    found = binomial()
    assert found.true is True
    assert found.technique is Technique.IDENTITY
    assert "sympy" in found.tool
    assert str(found).endswith("−2ab: refuted")


def test_an_identity_that_does_not_hold_is_refuted() -> None:
    found = old_identity("(a + b)² = a² + b²", lambda s, a, b: (a + b) ** 2 - a**2 - s * b**2, "−b²")
    assert found.true is False
    assert proved(found).verdict is Verdict.REFUTED
    assert proved(found).measured.startswith("Not proved: ")


def test_a_wrong_variant_that_holds_is_refused() -> None:
    with pytest.raises(UnsoundProof, match="the same both ways"):
        old_identity("a² = a²", lambda s, a: (s * a) ** 2 - a**2, "the same both ways")
    with pytest.raises(UnsoundProof, match="is not refuted"):
        old_implication("x² ≥ 0", lambda s, x: ([], s * s * x * x >= 0), "the same")
    with pytest.raises(UnsoundProof, match="is not refuted"):
        not_negative("x² ≥ 0", lambda s, x: s * s * x * x + 1, [(-1.0, 1.0)], "the same")
    with pytest.raises(UnsoundProof, match="is not refuted"):
        all_cases("0 ≤ n", lambda s, n: s * s * n >= 0, range(3), "the same")


def test_assumptions_that_contradict_each_other_prove_nothing() -> None:
    with pytest.raises(UnsoundProof, match="contradict"):
        old_implication("anything", lambda s, x: ([x > 0, x < 0], x == s), "anything else")


def test_what_is_assumed_is_not_proved() -> None:
    with pytest.raises(UnsoundProof, match="nothing follows"):
        old_implication("x ≥ 1 gives x ≥ 1", lambda s, x: ([x >= 1], x >= s), "x ≥ 2", 2)


def test_matrices_do_not_commute() -> None:
    A, B = matrices("A B")
    assert old_identity("(AB)⁻¹ = B⁻¹A⁻¹", lambda s: (A * B) * B**-s * A**-1 - 1, "BA⁻¹").true
    assert old_identity("AB = BA", lambda s: A * B - s * B * A, "−BA").true is False


def test_functions_are_arbitrary() -> None:
    sp = library()
    x = sp.Symbol("x")
    f, g = (sp.Function(name)(x) for name in "fg")
    assert old_identity("(fg)′ = f′g + fg′", lambda s: (f * g).diff(x) - f.diff(x) * g - s * f * g.diff(x), "−fg′").true
    assert old_identity("(fg)′ = f′g′", lambda s: (f * g).diff(x) - s * f.diff(x) * g.diff(x), "−f′g′").true is False


def test_squares_are_checked_exactly() -> None:
    x, y = library().symbols("x y", real=True)
    right = sum_of_squares("x² − 2xy + y² ≥ 0", lambda s: x**2 - s * 2 * x * y + y**2, [(1, x - y)], "−4xy", 2)
    assert right.true is True
    assert "(x - y)**2" in right.certificate
    assert sum_of_squares("wrong squares", lambda s: x**2 - s * 2 * x * y + y**2, [(1, x + y)], "−4xy", 2).true is False
    assert sum_of_squares("a minus", lambda s: -s * x**2, [(-1, x)], "−2x²", 2).true is False


@pytest.mark.slow
def test_two_programs_decide_implications_of_real_numbers() -> None:
    found = old_implication("x ≥ 1 gives x² ≥ x", lambda s, x: ([x >= 1], x * x >= s * x), "x² ≥ 2x", 2)
    assert found.true is True
    assert "z3" in found.tool
    assert "cvc5" in found.tool
    assert found.given == "x >= 1 ⊢ x*x >= x"
    false = old_implication("x ≥ 0 gives x² ≥ x", lambda s, x: ([x >= 0], x * x >= s * x), "x² ≥ 2x", 2)
    assert false.true is False


def test_a_function_is_enclosed_on_a_box() -> None:
    def slack(s: float, x: float, y: float) -> float:
        return (1 + x * x) * (1 + y * y) - s * (x + y) * (x + y) / 2

    box = [(-2.0, 2.0), (-2.0, 2.0)]
    assert not_negative("(x + y)²/2 ≤ (1 + x²)(1 + y²)", slack, box, "(x + y)²", 2.5).true is True
    below = not_negative("x ≥ 0.1", lambda s, x: x - 0.1 * s, [(0.0, 1.0)], "x ≥ 0.2", 2.0)
    assert below.true is False


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
    assert not_negative("1/x² ≥ 0", lambda s, x: 1 / (x * x) - 2 * (1 - s), [(-1.0, 2.0)], "1/x² ≥ 2", 0).true is None


def test_no_cases_prove_nothing() -> None:
    assert all_cases("n < 5", lambda s, n: n < 5 * s, range(5), "n < −5").true is True
    with pytest.raises(UnsoundProof):
        all_cases("of none", lambda s, n: s > 0, [], "of none")


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
    assert put_right(old_identity("a = b", lambda s, a, b: a - s * b, "a = −b")).verdict is Verdict.REFUTED


def test_measured_numbers_beside_a_proof_are_no_proof() -> None:
    assert Evidence("both", (binomial(), at_most("one", 1, 2))).verdict is Verdict.HOLDS


def test_an_entry_is_a_claim_with_its_wrong_variant() -> None:
    x, y = library().symbols("x y")
    square = identity(
        "my.square",
        "(1)",
        "(x + y)² = x² + y²",
        "A square",
        right=(x + y) ** 2 - x**2 - 2 * x * y - y**2,
        wrong=(x + y) ** 2 - x**2 - y**2,
        correction=Correction("2xy is missing", Effect.NUMBER, "nothing"),
    )
    assert square.recorded is square.verdict(square.decide({})) is Verdict.CORRECTED
    assert square.decide({}).measured == "Refuted as printed, (x + y)² = x² + y². Proved: 2xy is missing."
    assert square.module == __name__
    r, s = reals("r s")
    grows = implication(
        "my.grows",
        "(2)",
        "r < s gives r² < s²",
        "Squares grow",
        given=[r >= 0, r < s],
        then=r * r < s * s,
        wrong=([r < s], r * r < s * s),
    )
    assert grows.recorded is grows.verdict(grows.decide({})) is Verdict.PROVED
    both = argument(
        "my.both",
        "(3)",
        "",
        "Both",
        vanishes(x - x, x),
        in_all(range(3), lambda k: k < 3, lambda k: k < 2),
        squares(x**2, -(x**2), [(1, x)]),
        positive(lambda z: 1 + z, lambda z: z - 1, [(-0.5, 0.5)]),
        tried_on="two",
    )
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
