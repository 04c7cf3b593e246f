"""The register: each claim is complete, has the recorded verdict, and another one with other tables."""

import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import numpy as np
import pandas as pd
import pytest

import verification.thesis
from dincl import InvalidProblem
from tests.verification.thesis.tables import CLAIMS, shipped_tables
from verification.claims import Claim, Table, Verdict
from verification.claims.claim import MissingRow
from verification.thesis import register
from verification.thesis.chapter1.claims import s1_model

SLOW = ("c3.part-way", "c3.accumulation", "c4.pulled-back", "c5.independent")
# Of c3.every-fourth other shares are decided below.
OF_TABLES = [name for name, claim in CLAIMS.items() if claim.needs and name != "c3.every-fourth"]


@pytest.mark.slow_with(*SLOW)
@pytest.mark.parametrize("name", CLAIMS)
def test_the_verdict_is_the_recorded_one(name: str) -> None:
    claim = CLAIMS[name]
    found = claim.decide(shipped_tables())
    assert claim.verdict(found) is claim.recorded, found.measured
    assert found.measured


def numbers(table: pd.DataFrame) -> list[str]:
    """The columns that were measured."""
    given = {"dt", "mu", "t", "eps", "low_edge", "high_edge", "time_h", "a_h", "strength"}
    return [name for name in table if table[name].dtype == float and name not in given]


def shared(table: pd.DataFrame, share: Any) -> pd.DataFrame:
    """As if this share of the cells of each row had been hits, of many more cells."""
    more = {name: 1000 * table[name] for name in ("of", "effective") if name in table}
    return table.assign(**more, count=(1000 * share * table["of"]).astype(int))


def turned(table: pd.DataFrame) -> pd.DataFrame:
    """As if the numbers had stood in the opposite order."""
    names = [*numbers(table), *(name for name in ("count", "of") if name in table)]
    return table.assign(**{name: table[name].to_numpy()[::-1] for name in names})


def tilted(table: pd.DataFrame) -> pd.DataFrame:
    """As if the numbers had been the larger the farther down they stand."""
    weight = np.linspace(0.1, 3.0, len(table))
    if "count" in table:
        return shared(table, weight / 3)
    return table.assign(**{name: table[name] * weight for name in numbers(table)})


def flipped(table: pd.DataFrame) -> pd.DataFrame:
    """As if what happened had not, and the other way round."""
    given = {"of", "count", "runs", "substeps", "exponent", "cells", "seed"}
    yes = {name: ~table[name] for name in table if table[name].dtype == bool}
    counted = [name for name in table if table[name].dtype.kind == "i" and name not in given]
    return table.assign(**yes, **{name: table[name].max() - table[name] for name in counted})


def halved(table: pd.DataFrame) -> pd.DataFrame:
    return shared(table, 0.5) if "count" in table else table


def changed(name: str, **columns: Any) -> dict[str, pd.DataFrame]:
    return shipped_tables() | {name: shipped_tables()[name].assign(**columns)}


def otherwise(name: str) -> Iterator[dict[str, pd.DataFrame]]:
    """Ways in which the tables could have come out, one of which changes the verdict."""
    if name == "c2.coincides":
        yield changed("references", linearised=1e-3)
    if name == "c2.a-priori":
        yield changed("penalty_best", strength=1.0)
    if name == "c2.margin":
        yield changed("penalty_best", largest=1e-3, mean=1e-3)
    if name == "c4.q2-inm":
        yield changed("emt_groups", kind=lambda rows: rows["kind"].replace({"[A]": "[B]", "[B]": "[A]"}))
    if name == "c4.q3":
        early = lambda rows: rows["given"].str.startswith("t_") & (rows["high_edge"] <= 12)  # noqa: E731
        yield changed("emt_groups", count=lambda rows: rows["count"].where(~early(rows), 0))
    for way in (turned, halved, tilted, flipped):
        yield {one: way(table) if one in CLAIMS[name].needs else table for one, table in shipped_tables().items()}


@pytest.mark.parametrize("name", OF_TABLES)
def test_other_tables_change_the_verdict(name: str) -> None:
    claim, verdicts = CLAIMS[name], []
    for tables in otherwise(name):
        with suppress(InvalidProblem, MissingRow):  # that such tables cannot be
            verdicts.append(claim.verdict(claim.decide(tables)))
        if set(verdicts) - {claim.recorded}:
            return
    pytest.fail(f"{name} is {verdicts} whatever the tables say")


def test_every_file_with_claims_is_in_the_register() -> None:
    folder = Path(verification.thesis.__file__).parent
    stated = re.compile(r"^(@claim\w*|\w+ = (identity|implication|argument))\(", re.MULTILINE)
    files = {file for file in folder.rglob("*.py") if stated.search(file.read_text("utf-8"))}
    assert files == {Path(str(import_module(name).__file__)) for name in register.modules()}


def test_an_id_given_twice_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    register.register.cache_clear()
    monkeypatch.setattr(s1_model, "again", replace(s1_model._velocity), raising=False)
    with pytest.raises(InvalidProblem, match=r"claim ids .*c1\..* are given twice"):
        register.register()


def test_register_is_in_the_order_of_the_chapters_and_not_small() -> None:
    chapters = [register.chapter_of(claim) for claim in CLAIMS.values()]
    assert chapters == sorted(chapters)
    assert len(CLAIMS) >= 145
    assert sum(one.correction is not None for one in CLAIMS.values()) >= 50


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


def test_the_reading_nearest_to_one_in_four_decides() -> None:
    table = shipped_tables()["tissue_daha_shares"]
    for printed, floored, verdict in ((0.25, 0.0, "HOLDS"), (1.0, 0.33, "OPEN"), (0.5, 0.05, "REFUTED")):
        share = table["case"].map({"as printed": printed}).fillna(floored)
        given = table.assign(share=share, low=(share - 0.05).clip(0), high=share + 0.05)
        assert CLAIMS["c3.every-fourth"].decide({"tissue_daha_shares": given}).verdict.name == verdict


@pytest.mark.parametrize(
    "name", ["c3.passive-springs", "c3.optimal", "c3.six-per-cent", "c3.macroscopic", "c3.similar"]
)
def test_comparisons_hold_as_printed_once_runs_of_daha_end_as_printed(name: str) -> None:
    tables = changed("tissue_daha_shares", share=0.0, low=0.0, high=0.05)
    assert CLAIMS[name].decide(tables).verdict is Verdict.HOLDS


def test_a_study_that_is_too_short_to_see_a_doubling_says_so() -> None:
    found = CLAIMS["c3.doubling"].decide(changed("tissue_doubling", mu=np.nan, low=np.nan, high=np.nan))
    assert found.verdict is Verdict.OPEN
    assert "nan" not in found.measured
