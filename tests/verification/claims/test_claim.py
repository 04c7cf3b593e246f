"""A claim is a check with its statement above it; it is checked at construction and travels by its name."""

import pickle
from types import ModuleType
from typing import Any

import pandas as pd
import pytest

from dincl import InvalidProblem
from verification.claims import Claim, Correction, Effect, Evidence, Verdict, claim, equal, stated_in
from verification.thesis.register import register

ORDERS = {"orders": pd.DataFrame({"order": [1.0]})}
READ = Correction("two", Effect.NUMBER, "nothing")


def unity() -> Evidence:
    return Evidence("one is one", (equal("one", 1, 1),))


def order(tables: Any) -> Evidence:
    return Evidence("from a table", (equal("order", tables["orders"]["order"].iloc[0], 1),))


def test_a_decorated_check_is_a_claim_that_decides() -> None:
    made = claim("my.unity", "One is one")(unity)
    assert isinstance(made, Claim)
    assert (made.id, made.statement, made.source) == ("my.unity", "One is one", "")
    assert made.decide({}).verdict is Verdict.HOLDS


def test_examples_that_agree_do_not_show_that_a_general_statement_holds() -> None:
    made = claim("my.all", "All numbers are one", recorded=Verdict.NOT_REFUTED, tried_on="one")(unity)
    assert made.verdict(unity()) is Verdict.NOT_REFUTED
    assert made.verdict(Evidence("two is not", (equal("two", 2, 1),))) is Verdict.REFUTED
    assert made.verdict(Evidence("none", ())) is Verdict.OPEN


def test_a_claim_about_tables_waits_for_them() -> None:
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
def test_what_is_not_a_claim_is_refused(given: dict[str, Any], check: Any, message: str) -> None:
    with pytest.raises(InvalidProblem, match=message):
        claim(**{"id": "my.unity", "statement": "One is one"} | given)(check)


def test_the_claims_of_a_module_are_its_own_in_order_of_definition() -> None:
    here, other = ModuleType("here"), ModuleType("other")
    first, second, third = (Claim(name, "One", _check_of("here")) for name in ("b", "a", "c"))
    foreign = Claim("z", "One", _check_of("other"))
    vars(here).update(second=second, foreign=foreign, several=(third, first), again=second, number=3)
    vars(other).update(foreign=foreign)
    assert stated_in(here) == (second, third, first)
    assert stated_in(other) == (foreign,)


def _check_of(module: str) -> Any:
    def check() -> Evidence:
        return unity()

    check.__module__ = module
    return check


def test_claims_travel_to_other_processes() -> None:
    for made in register():
        assert pickle.loads(pickle.dumps(made)) is made
