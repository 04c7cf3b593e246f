"""The register: each claim is complete, has the recorded verdict, and another one with other tables."""

import re
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from pkgutil import resolve_name

import pytest

import verification.thesis
from dincl import InvalidProblem
from tests.verification.thesis.chapter2.test_claims import CHANGES as CHANGES2
from tests.verification.thesis.chapter2.test_claims import RIGHT
from tests.verification.thesis.chapter3.test_claims import CHANGES as CHANGES3
from tests.verification.thesis.chapter3.test_claims import FOUND
from tests.verification.thesis.chapter4.test_claims import CHANGES as CHANGES4
from tests.verification.thesis.claims import CLAIMS
from tests.verification.thesis.emt_tables import KEPT
from verification.claims import Claim, Effect, Table, Verdict
from verification.thesis import register
from verification.thesis.chapter1.claims import s1_1_newton

CHANGES = CHANGES2 | CHANGES3 | CHANGES4
SLOW = ("c3.slice", "c3.inm", "c3.part-way", "c3.accumulation", "c4.pulled-back", "c5.independent")


@pytest.mark.slow_with(*SLOW)
@pytest.mark.parametrize("name", CLAIMS)
def test_the_verdict_is_the_recorded_one(name: str) -> None:
    claim = CLAIMS[name]
    found = claim.decide(RIGHT.get(name) or (FOUND if name.startswith("c3.") else KEPT))
    assert claim.verdict(found) is claim.recorded, found.measured
    assert found.measured


@pytest.mark.parametrize("name", CHANGES)
def test_other_tables_change_the_verdict(name: str) -> None:
    found = CLAIMS[name].decide(CHANGES[name].tables)
    assert found.verdict is CHANGES[name].verdict is not CLAIMS[name].recorded, found.measured


def test_every_file_with_claims_is_in_the_register() -> None:
    folder = Path(verification.thesis.__file__).parent
    stated = re.compile(r"^(@claim|\w+ = (identity|implication|argument))\(", re.MULTILINE)
    files = {file for file in folder.rglob("*.py") if stated.search(file.read_text("utf-8"))}
    assert files == {Path(str(import_module(name).__file__)) for name in register.modules()}


def test_an_id_given_twice_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    register.register.cache_clear()
    monkeypatch.setattr(s1_1_newton, "again", replace(s1_1_newton._impact), raising=False)
    with pytest.raises(InvalidProblem, match=r"claim ids .*c1\..* are given twice"):
        register.register()


def test_register_is_in_the_order_of_the_chapters_and_not_small() -> None:
    chapters = [register.chapter_of(claim) for claim in CLAIMS.values()]
    assert chapters == sorted(chapters)
    serious = [one for one in CLAIMS.values() if one.correction and one.correction.effect is not Effect.NOTATION]
    assert len(CLAIMS) >= 150
    assert len(serious) >= 60


@pytest.mark.parametrize("claim", CLAIMS.values(), ids=CLAIMS)
def test_claim_is_complete(claim: Claim) -> None:
    texts = [claim.source, claim.quote, claim.statement]
    if claim.correction:
        texts += [claim.correction.text, claim.correction.depends, claim.correction.why]
        assert claim.correction.place > 0
    assert all(text and text == text.strip() and "\n" not in text for text in texts)
    assert claim.statement != claim.quote
    assert claim.recorded is Verdict.CORRECTED or claim.correction is None or claim.recorded is Verdict.REFUTED
    assert claim.recorded is not Verdict.CORRECTED or claim.correction is not None


@pytest.mark.parametrize("claim", [one for one in CLAIMS.values() if one.needs], ids=lambda one: one.id)
def test_claim_waits_for_its_tables(claim: Claim) -> None:
    evidence = claim.decide({})
    assert evidence.verdict is Verdict.OPEN
    for name in claim.needs:
        assert name in evidence.measured
        assert isinstance(name, Table)
        assert callable(resolve_name(name.made_by))
