"""Claims: comparisons and verdicts, what is no claim, which rests on which, and techniques of proof."""
# ruff: noqa: RUF001 - formulas are written with the minus sign of mathematics

import math
import pickle
import re
import sys
from types import ModuleType

import pandas as pd
import pytest

from dincl import InvalidProblem
from verification.claims import (
    Claim,
    Correction,
    Effect,
    Evidence,
    Technique,
    Verdict,
    at_least,
    at_most,
    claim,
    equal,
    proved,
    put_right,
    stated_in,
)
from verification.claims.formal import UnsoundProof
from verification.claims.formal.algebra import library, matrices, squares, vanishes
from verification.claims.formal.reals import follows, reals
from verification.claims.formal.stated import argument, identity, implication
from verification.claims.graph import corrected_below, ordered
from verification.thesis.register import register

# Evidence

TRUE, FALSE, UNKNOWN = equal("x", 1.0, 1.0), equal("x", 2.0, 1.0), equal("x", math.nan, 1.0)


@pytest.mark.parametrize(
    ("comparison", "truth"),
    [
        (equal("x", 1.05, 1.0, 0.1), True),
        (equal("x", 1.15, 1.0, 0.1), False),
        (equal("x", 1.05, 1.0, 0.1, (0.95, 1.08)), True),
        (equal("x", 1.05, 1.0, 0.1, (0.95, 1.12)), None),
        (equal("x", 1.2, 1.0, 0.1, (1.15, 1.3)), False),
        (equal("x", 1.0, 1.0, 0.1, (math.nan, 1.0)), None),
        (UNKNOWN, None),
        (at_most("x", 3, 3), True),
        (at_most("x", 3.1, 3), False),
        (at_most("x", 3.1, 3, 0.2), True),
        (at_least("x", 3, 3), True),
        (at_least("x", 2.9, 3), False),
        (at_least("x", 2.9, 3, 0.2), True),
        (at_least("x", math.inf, 3), True),
    ],
)
def test_a_number_is_in_its_range_or_not_or_nobody_knows(comparison, truth):
    assert comparison.true is truth


@pytest.mark.parametrize(
    ("printed", "corrected", "verdict"),
    [
        ((TRUE,), (), Verdict.HOLDS),
        ((TRUE,), (FALSE,), Verdict.HOLDS),
        ((TRUE, FALSE), (), Verdict.REFUTED),
        ((FALSE,), (TRUE, TRUE), Verdict.CORRECTED),
        ((FALSE,), (TRUE, FALSE), Verdict.REFUTED),
        ((FALSE,), (TRUE, UNKNOWN), Verdict.OPEN),
        ((TRUE, UNKNOWN), (), Verdict.OPEN),
        ((FALSE, UNKNOWN), (TRUE,), Verdict.CORRECTED),
        ((), (), Verdict.OPEN),
    ],
)
def test_verdict(printed, corrected, verdict):
    assert Evidence("measured", printed, corrected).verdict is verdict


# Claims

ORDERS = {"orders": pd.DataFrame({"order": [1.0]})}
READ = Correction("two", Effect.NUMBER, "nothing")


def unity():
    return Evidence("one is one", (equal("one", 1, 1),))


def order(tables):
    return Evidence("from a table", (equal("order", tables["orders"]["order"].iloc[0], 1),))


def test_a_decorated_check_is_a_claim_that_decides():
    made = claim("my.unity", "One is one")(unity)
    assert isinstance(made, Claim)
    assert (made.id, made.statement, made.source) == ("my.unity", "One is one", "")
    assert made.decide({}).verdict is Verdict.HOLDS


def test_examples_that_agree_do_not_show_that_a_general_statement_holds():
    made = claim("my.all", "All numbers are one", recorded=Verdict.NOT_REFUTED, tried_on="one")(unity)
    assert made.verdict(unity()) is Verdict.NOT_REFUTED
    assert made.verdict(Evidence("two is not", (equal("two", 2, 1),))) is Verdict.REFUTED
    assert made.verdict(Evidence("none", ())) is Verdict.OPEN


def test_a_claim_about_tables_waits_for_them():
    made = claim("my.order", "The order is one", needs=("orders",))(order)
    assert made.decide(ORDERS).verdict is Verdict.HOLDS
    assert made.missing({}) == ["orders"]
    assert made.decide({}).verdict is Verdict.OPEN


@pytest.mark.parametrize(
    ("given", "check", "message"),
    [
        ({"id": "my claim"}, unity, r"id = 'my claim': must be a short name without spaces"),
        ({"id": ""}, unity, "id = ''"),
        ({"id": 3}, unity, "id = 3"),
        ({"statement": " "}, unity, r"claim my\.unity: statement = ' ': must be a sentence"),
        ({"quote": None}, unity, "quote = None: must be text"),
        ({"needs": "orders"}, order, "needs = 'orders': must be a tuple of names of tables"),
        ({"needs": ("",)}, order, "must be a tuple of names of tables"),
        ({"recorded": "holds"}, unity, "recorded = 'holds': must be one of Verdict.PROVED"),
        ({"correction": "two"}, unity, "correction = 'two': must be a Correction or None"),
        (
            {"tried_on": "one", "recorded": Verdict.HOLDS},
            unity,
            "must be one of Verdict.PROVED_INSTANCE, Verdict.NOT_REFUTED, .* a correction of examples",
        ),
        ({"recorded": Verdict.NOT_REFUTED}, unity, "must be one of Verdict.PROVED, Verdict.HOLDS"),
        ({"recorded": Verdict.CORRECTED}, unity, "must be one of .* without a correction"),
        ({"correction": READ, "recorded": Verdict.HOLDS}, unity, "must be one of Verdict.CORRECTED, Verdict.REFUTED"),
        ({}, order, "must be a function without arguments, as it needs no table"),
        ({"needs": ("orders",)}, unity, "must be a function of the tables"),
        ({}, None, "check = None"),
    ],
)
def test_what_is_not_a_claim_is_refused(given, check, message):
    with pytest.raises(InvalidProblem, match=message):
        claim(**{"id": "my.unity", "statement": "One is one"} | given)(check)


def test_the_claims_of_a_module_are_its_own_in_order_of_definition():
    here, other = ModuleType("here"), ModuleType("other")
    first, second, third = (Claim(name, "One", _check_of("here")) for name in ("b", "a", "c"))
    foreign = Claim("z", "One", _check_of("other"))
    vars(here).update(second=second, foreign=foreign, several=(third, first), again=second, number=3)
    vars(other).update(foreign=foreign)
    assert stated_in(here) == (second, third, first)
    assert stated_in(other) == (foreign,)
    for made in register():  # claims travel to other processes
        assert pickle.loads(pickle.dumps(made)) is made


def _check_of(module):
    def check():
        return unity()

    check.__module__ = module
    return check


# Claims rest on claims


def state(name, *rests_on, wrong=False):
    correction = Correction("two", Effect.NUMBER, "all") if wrong else None
    recorded = Verdict.CORRECTED if wrong else Verdict.HOLDS
    found = Evidence(printed=(equal("one", 1, 1),))
    return Claim(name, "One.", lambda: found, rests_on=rests_on, correction=correction, recorded=recorded)


CLAIMS = [state("c", "a", "b"), state("b", "a", wrong=True), state("a", wrong=True), state("d", "c"), state("e")]


def test_claims_come_after_those_they_rest_on():
    order = ordered(CLAIMS)
    assert set(order) == set("abcde")
    assert [name for name in order if name in "abcd"] == list("abcd")


def test_corrections_mark_all_that_rests_on_them():
    below = corrected_below(CLAIMS)
    assert below == {"a": (), "e": (), "b": ("a",), "c": ("a", "b"), "d": ("a", "b")}


def test_unknown_names_and_circles_are_refused():
    with pytest.raises(InvalidProblem, match="claim c: rests_on names x, and there is no claim of this id"):
        ordered([state("c", "x")])
    with pytest.raises(InvalidProblem, match="claims rest on each other in a circle: "):
        ordered([state("a", "b"), state("b", "a")])
    with pytest.raises(InvalidProblem, match=r"claim a: rests_on = \('a',\): must be a tuple of ids of other claims"):
        state("a", "a")


# Proofs

a, b, x, y = library().symbols("a b x y", real=True)
r, s = reals("r s")
A, B = matrices("A B")
f, g = (library().Function(name)(x) for name in "fg")


def binomial():
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
def test_what_is_true_is_proved_and_what_is_false_is_refuted(step, true):
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
def test_a_proof_that_says_nothing_is_refused(step, message):
    with pytest.raises(UnsoundProof, match=message):
        step("said", "the same")


def test_two_programs_decide_implications_of_real_numbers():
    found = follows([r >= 1], r * r >= r, r * r >= 2 * r)()
    assert found.technique is Technique.REALS
    assert re.fullmatch(r"z3 [\d.]+, cvc5 [\d.]+", found.tool)
    assert found.given == "r >= 1 ⊢ r*r >= r"


@pytest.mark.parametrize(("tried_on", "verdict"), [("", Verdict.PROVED), ("two numbers", Verdict.PROVED_INSTANCE)])
def test_the_verdict_of_a_proof(tried_on, verdict):
    made = claim("my.binomial", "The square of a sum", recorded=verdict, tried_on=tried_on)(lambda: proved(binomial()))
    assert made.verdict(made.decide({})) is verdict


def test_a_correction_is_proved_and_its_printed_form_refuted():
    found = put_right(binomial())
    assert found.verdict is Verdict.CORRECTED
    assert found.measured.startswith("Refuted as printed, −2ab. Proved: (a + b)²")
    assert [each.true for each in found.printed] == [False]
    assert re.fullmatch(r"−2ab: refuted by computer algebra \(sympy [^)]*\)", str(found.printed[0]))


def test_measured_numbers_beside_a_proof_are_no_proof():
    assert Evidence("both", (binomial(), at_most("one", 1, 2))).verdict is Verdict.HOLDS


def test_an_entry_is_a_claim_with_its_wrong_variant():
    about = {"right": (x + y) ** 2 - x**2 - 2 * x * y - y**2, "wrong": (x + y) ** 2 - x**2 - y**2}
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


def test_a_missing_library_leaves_a_claim_open(monkeypatch):
    monkeypatch.setitem(sys.modules, "sympy", None)
    monkeypatch.setattr("dincl.extras.find_spec", lambda _: None)
    made = claim("my.binomial", "The square of a sum", recorded=Verdict.PROVED)(lambda: proved(binomial()))
    found = made.decide({})
    assert found.verdict is Verdict.OPEN
    assert "pip install '.[proofs]'" in found.measured
