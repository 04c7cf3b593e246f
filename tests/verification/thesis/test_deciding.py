"""Claims are chosen by chapter and name, decided in parallel and resumed; another verdict fails the command."""

from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest
from typer.testing import CliRunner

from dincl import study
from tests.executors import Here
from verification import cli
from verification.claims import Claim, Correction, Effect, Evidence, Table, Tables, Verdict, decide, equal
from verification.site.context import Context
from verification.thesis import register


def right() -> Evidence:
    return Evidence("one is one", (equal("one", 1, 1),), seed=3)


def wrong() -> Evidence:
    return Evidence("one is not two", (equal("one", 1, 2),), (equal("one", 1, 1),))


def from_table(tables: Tables) -> Evidence:
    return Evidence("from a table", (equal("value", tables["orders"]["order"].iloc[0], 1),), runs_needed=40)


def unsolved() -> Evidence:
    raise RuntimeError("no projection after 100 iterations")


ONE = Correction("one", Effect.NUMBER, "all that follows")
CLAIMS = (
    Claim("c1.right", "Unity.", right, source="(1.1)", quote="1 = 1", also=("c1.same",)),
    Claim("c1.wrong", "Duality.", wrong, source="(1.2)", quote="1 = 2", recorded=Verdict.CORRECTED, correction=ONE),
    Claim("c2.table", "The order.", from_table, source="(2.1)", needs=("orders",)),
)


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(register, "register", lambda: CLAIMS)
    monkeypatch.setattr(study, "workers", Here)


@pytest.mark.parametrize(
    ("chapters", "names", "ids"),
    [
        ((), (), ["c1.right", "c1.wrong", "c2.table"]),
        ((1,), (), ["c1.right", "c1.wrong"]),
        ((), ("c1.w*", "c2.table"), ["c1.wrong", "c2.table"]),
        ((2,), ("c1.*",), []),
        ((), ("c1.same",), ["c1.right"]),
    ],
)
def test_selection(chapters: tuple[int, ...], names: tuple[str, ...], ids: list[str]) -> None:
    assert [claim.id for claim in register.select_claims(CLAIMS, chapters, names)] == ids


def test_a_name_or_chapter_without_claims_is_refused() -> None:
    with pytest.raises(ValueError, match=r"no claim is named c1\.rihgt; the nearest are c1\.right"):
        register.select_claims(CLAIMS, names=("c1.rihgt",))
    with pytest.raises(ValueError, match="chapter 7 has no claims: those that have are 1, 2"):
        register.select_claims(CLAIMS, chapters=(7,))


@pytest.mark.usefixtures("few")
def test_rows_say_what_was_found() -> None:
    table = decide.decide_all(CLAIMS, {"orders": pd.DataFrame({"order": [1.0]})}, Here())
    again = decide.decide_all(CLAIMS, {"orders": pd.DataFrame({"order": [2.0]})}, Here())
    assert table["id"].tolist() == ["c1.right", "c1.wrong", "c2.table"]
    assert table["verdict"].tolist() == ["holds", "refuted, holds when corrected", "holds"]
    assert table["printed"].tolist() == ["one: 1 (required 1)", "one: 1 (required 2)", "value: 1 (required 1)"]
    assert table["corrected"].tolist() == ["", "one: 1 (required 1)", ""]
    assert table["seed"].tolist() == ["3", "", ""]
    assert table["runs_needed"].tolist() == ["", "", "40"]
    assert again["verdict"].tolist() == ["holds", "refuted, holds when corrected", "refuted"]
    assert decide.differing(again)["id"].tolist() == ["c2.table"]


def test_each_reading_has_a_column() -> None:
    def in_two_ways() -> Evidence:
        return replace(right(), readings={"one way": right(), "other way": wrong()})

    claims = (CLAIMS[0], Claim("c1.ways", "Unity.", in_two_ways))
    table = pd.DataFrame([decide.evidence_row(claim, {}) for claim in claims]).fillna("")
    assert decide.readings(table) == ["reading: one way", "reading: other way"]
    assert table["reading: other way"].tolist() == ["", "refuted, holds when corrected"]


def test_a_solver_that_fails_decides_nothing() -> None:
    row = decide.evidence_row(Claim("c1.unsolved", "Nothing.", unsolved), {})
    assert row["verdict"] == Verdict.OPEN.value
    assert "RuntimeError: no projection after 100 iterations" in row["measured"]


@pytest.mark.usefixtures("few")
@pytest.mark.parametrize(("options", "code"), [(["--chapter", "1"], 0), (["--chapter", "2"], 1)])
def test_command_fails_if_a_verdict_differs(
    options: list[str], code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(register, "tables_for", lambda *_: {"orders": pd.DataFrame({"order": [0.5]})})
    done = CliRunner().invoke(cli.app, ["claims", *options, "--out", str(tmp_path)])
    assert done.exit_code == code, done.output
    assert ("c2.table: refuted, recorded is holds" in done.output) is bool(code)


def test_command_names_what_it_does_not_know() -> None:
    done = CliRunner().invoke(cli.app, ["claims", "--id", "c9.none"])
    assert done.exit_code == 2
    assert "c9.none" in done.output


def make_orders(context: Context) -> None:
    context.tables["orders"] = pd.DataFrame({"order": [float(len(context.tables))]})


def test_only_what_the_claims_read_is_made_and_only_once(tmp_path: Path) -> None:
    orders, other = Table("orders", f"{__name__}:make_orders"), Table("other", "no.module:at_all")
    claims = [replace(CLAIMS[2], needs=(orders,)), replace(CLAIMS[2], id="c2.again", needs=(orders,))]
    unread = replace(CLAIMS[2], id="c2.unread", needs=(other,))
    context = Context(tmp_path, False, Here())
    for chosen in (claims, claims[:1]):
        assert register.tables_for(chosen, context)["orders"]["order"].tolist() == [0.0]
    with pytest.raises(ModuleNotFoundError, match="no"):
        register.tables_for([unread], context)
