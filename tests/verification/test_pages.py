"""What pages are made of, and how a report fills; without any study."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from dincl.study import write
from tests.executors import Here, Nowhere
from verification.claims import Verdict
from verification.methods import page as experiments
from verification.site import parts
from verification.site.context import Context
from verification.site.parts import Grid, Section, Text, cell, number
from verification.site.prose import duration
from verification.site.report import Card, Chapter, Finding, write_report


def test_the_first_page_fills_as_chapters_become_ready(tmp_path: Path) -> None:
    seen = []

    def chapter(number: int) -> Chapter:
        def run(context: Context) -> None:
            seen.append((context.out / "index.html").read_text("utf-8"))

        def findings(context: Context) -> list[Finding]:
            return [Finding(f"found {number}", "Only")]

        def sections(context: Context) -> list[Section]:
            return [Section("Only", [Text("said")])]

        return Chapter(f"c{number}", f"Chapter {number}", f"asked {number}", run, sections, findings)

    last = write_report([chapter(1), chapter(2)], Context(tmp_path, False, Here())).read_text("utf-8")
    before, between = seen
    assert "refresh" in before
    assert "found" not in before.replace("What was found", "")
    assert "found 1" in between
    assert 'href="c1.html#section-1"' in between
    assert 'Chapter 2 <span class="made">(is being computed)</span>' in between
    assert 'Chapter 2 <span class="made">(to come)</span>' in before
    assert "c2.html" not in between
    assert "refresh" not in last
    assert "found 2" in last


def test_cards_stand_in_their_order_with_a_sentence_each(tmp_path: Path) -> None:
    def chapter(number: int, card: Card) -> Chapter:
        found = [Finding(f"found {number}", "Only", card)]
        sections = [Section("Only", [Text("said")])]
        name = f"c{number}"
        return Chapter(name, name, "asked", lambda _: None, lambda _: sections, lambda _: found)

    cards = [Card(tmp_path / "grows.webp", "last", 3), Card(tmp_path / "b.png", "second", 2)]
    cards.append(Card(tmp_path / "a.png", "first", 1))
    chapters = [chapter(number, card) for number, card in enumerate(cards)]
    text = write_report(chapters, Context(tmp_path, False, Here())).read_text("utf-8")
    places = [text.index(f"<span>{word}</span>") for word in ("first", "second", "last")]
    assert places == sorted(places)
    assert text.count('class="card moving"') == 1
    assert "found 1" not in text
    assert "found 1" in (tmp_path / "c1.html").read_text("utf-8")


def test_a_finding_has_the_numbers_of_its_tables(tmp_path: Path) -> None:
    """Of the finest step that both methods have, and not of the last time, where catch-up has come to rest."""
    context = Context(tmp_path, False, Nowhere())
    methods = {experiments.PBD.label: 6.0, experiments.CATCH_UP.label: 2.0}
    rows = [
        {"problem": experiments.CROWD, "method": method, "setting": dt}
        | {f"t = {t:g}": error * dt * (1 + t * (error > 5)) for t in (0.5, 1.0, 2.0)}
        for method, error in methods.items()
        for dt in (0.1, 0.05)
    ]
    rows.append({"problem": experiments.CROWD, "method": experiments.PBD.label, "setting": 0.01, "t = 0.5": 1.0})
    fits = {"method": [experiments.PBD.label] * 2 + ["other"], "low": [0.9, 0.95, 0.1], "high": [1.0, 1.1, 9.0]}
    context.tables |= {"orders": pd.DataFrame(rows), "order_fits": pd.DataFrame(fits).assign(error="t = 1")}
    (found,) = experiments.findings(context)
    assert "[0.9, 1.1] over the ranges" in found.html
    assert "4.5 to 6 times the error of catch-up" in found.html


def test_what_is_empty_is_not_printed() -> None:
    rows = pd.DataFrame({"a": [1.0, np.nan], "none": [np.nan, np.nan], "text": ["x", ""], "blank": ["", ""]})
    grid = Grid(rows, "", "few")
    assert list(grid.shown) == ["a", "text"]
    assert [[text for text, _ in row] for row in grid.cells] == [["1", "x"]]


def test_kept_table_is_written(tmp_path: Path) -> None:
    context = Context(tmp_path, True, Nowhere())
    context.keep("few", pd.DataFrame({"a": [1, 2]}))
    assert pd.read_csv(tmp_path / "tables" / "few.csv")["a"].tolist() == [1, 2]
    write(context.tables["few"].head(1), tmp_path / "tables" / "few.parquet")
    assert pd.read_parquet(tmp_path / "tables" / "few.parquet")["a"].tolist() == [1]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (0.1234, "0.123"),
        (12.0, "12"),
        (1234.4, "1234"),
        (1.5e-7, "1.5·10⁻⁷"),
        (1e-3, "10⁻³"),
        (-2e5, "-2.0·10⁵"),
        (np.nan, "—"),
    ],
)
def test_numbers(value: float, text: str) -> None:
    assert number(value) == text
    assert cell(value) == (text, "number")


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.0034, "3.4 ms"), (0.12, "0.12 s"), (99.96, "100 s"), (2.14e-6, "2.1 µs"), (0.09996, "100 ms"), (1e-3, "1 ms")],
)
def test_durations(seconds: float, text: str) -> None:
    assert duration(seconds) == text


def test_cells() -> None:
    assert cell(True) == ("yes", "")
    assert cell(np.False_) == ("no", "")
    assert cell(3) == ("3", "number")
    assert cell("refuted") == ("refuted", "refuted")
    assert cell("refuted, holds when corrected") == ("refuted, holds when corrected", "corrected")
    assert cell("PBD") == ("PBD", "")
    assert parts.VERDICTS.keys() == {verdict.value for verdict in Verdict}
