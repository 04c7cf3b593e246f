"""The register: every claim says what it states, how it came out and why; its tables exist."""

from pathlib import Path

import pytest

from tests import (
    test_claims_chapter1,
    test_claims_chapter2,
    test_claims_chapter3_methods,
    test_claims_chapter3_model,
    test_claims_chapter4,
    test_claims_chapter5,
)
from verification import register
from verification.chapters import CHAPTERS
from verification.claim import Claim, Effect
from verification.claims import chapter1_newton
from verification.evidence import Kind

CLAIMS = {claim.id: claim for claim in register.register()}


def test_every_file_with_claims_is_in_the_register() -> None:
    folder = Path(chapter1_newton.__file__).parent
    files = {file.stem for file in folder.glob("*.py") if "\nCLAIMS" in file.read_text("utf-8")}
    assert files == set(register.FILES)


def test_of_every_claim_something_is_made_wrong() -> None:
    files = (
        test_claims_chapter1,
        test_claims_chapter2,
        test_claims_chapter3_methods,
        test_claims_chapter3_model,
        test_claims_chapter4,
        test_claims_chapter5,
    )
    assert {name for file in files for name in file.CHANGES} == CLAIMS.keys()


def test_an_id_given_twice_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(chapter1_newton, "CLAIMS", chapter1_newton.CLAIMS * 2)
    with pytest.raises(ValueError, match=r"claim ids .*c1\..* are given twice"):
        register.register()


def test_register_is_in_the_order_of_the_chapters_and_not_small() -> None:
    chapters = [claim.chapter for claim in CLAIMS.values()]
    assert chapters == sorted(chapters)
    serious = [one for one in CLAIMS.values() if one.correction and one.correction.effect is not Effect.NOTATION]
    assert len(CLAIMS) >= 150
    assert len(serious) >= 60


@pytest.mark.parametrize("claim", CLAIMS.values(), ids=CLAIMS)
def test_claim_is_complete(claim: Claim) -> None:
    texts = [claim.source, claim.quote, claim.statement]
    if claim.correction:
        texts += [claim.correction.text, claim.correction.depends]
    assert all(text and text == text.strip() and "\n" not in text for text in texts)
    assert claim.statement != claim.quote
    assert claim.recorded is Kind.CORRECTED or claim.correction is None or claim.recorded is Kind.FAILS
    assert claim.recorded is not Kind.CORRECTED or claim.correction is not None


@pytest.mark.parametrize("claim", [one for one in CLAIMS.values() if one.needs], ids=lambda one: one.id)
def test_claim_waits_for_its_tables_which_one_chapter_makes(claim: Claim) -> None:
    evidence = claim.decide({})
    assert evidence.kind is Kind.OPEN
    for name in claim.needs:
        assert name in evidence.measured
        assert len([chapter for chapter in CHAPTERS if name.startswith(chapter.tables)]) == 1
