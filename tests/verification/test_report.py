"""The site: written without warnings from tables that ship, with nothing run again; its links lead somewhere."""

import re
from collections.abc import Iterator
from functools import cache
from html import unescape
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pandas as pd
import pytest
from typer.testing import CliRunner

from dincl import study
from dincl.study import Study
from tests.executors import Here
from tests.optional import need_module
from tests.verification.in_browser import PagesInABrowser
from tests.verification.thesis.shortened import few_claims, shorten
from verification import audit, cli
from verification.audit import PAGES, STUDIES
from verification.claims.decide import differing
from verification.site import context, report
from verification.site.agreement import Agreement
from verification.site.context import Context
from verification.site.report import write_report
from verification.site.store import DATA

pytestmark = pytest.mark.slow

LARGEST = 3e6  # bytes of a page
MAKE = Study._make


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Context]:
    """From the complete studies that ship, of which nothing is made again; with few claims."""
    for name in ("furo", "myst_parser", "sphinx", "sphinx_design"):
        need_module(name)
    out = tmp_path_factory.mktemp("report")
    shipped = Context(out, False, Here(), STUDIES, complete=DATA)
    with pytest.MonkeyPatch.context() as patch:
        shorten(patch)
        patch.setattr(Study, "_make", _only_claims)
        patch.setattr(Context, "_repeat", _said_to_agree)
        write_report(PAGES, shipped, strict=True)
    return out, shipped


def _only_claims(study: Study, *given: Any) -> None:
    assert study.name.startswith("claims"), f"{study.name} was run, which ships"
    MAKE(study, *given)


def _said_to_agree(made: Context, study: Study, *_: object) -> None:
    made.agreements[study.name] = Agreement(study.title, 1, len(study.runs), 1, 0)


class TestPagesInABrowser(PagesInABrowser):
    """In this file, so that the report is made once: the tests of one file run in one process."""


def pages(out: Path) -> Iterator[tuple[Path, str]]:
    """All pages, without scripts."""
    for path in out.rglob("*.html"):
        yield path, re.sub(r"<script\b.*?</script>", "", path.read_text("utf-8"), flags=re.S)


@cache
def places(path: Path) -> set[str]:
    """The places of a page that a link can name."""
    return {unescape(name) for name in re.findall(r'\bid="([^"]*)"', path.read_text("utf-8"))}


def test_links_lead_to_files_and_places_that_are_there(made: tuple[Path, Context]) -> None:
    lost = []
    for path, text in pages(made[0]):
        for link in re.findall(r'\b(?:href|src)="([^"]*)"', text):
            file, _, place = unquote(unescape(link)).partition("#")
            if re.match(r"\w+:", link) or place.startswith("scene="):
                continue
            target = (path.parent / file.partition("?")[0]).resolve() if file else path
            if not target.is_file() or (place and place not in places(target)):
                lost.append(f"{path.relative_to(made[0])}: {link}")
    assert lost == []


def test_pages_need_no_network(made: tuple[Path, Context]) -> None:
    for path, text in pages(made[0]):
        assert not re.search(r'<(?:img|link|script|source|iframe)\b[^>]*(?:src|href)="\w+://', text), path
        assert path.stat().st_size < LARGEST, path


def test_all_that_was_given_is_shown(made: tuple[Path, Context]) -> None:
    text = "".join(one for _, one in pages(made[0]))
    for name in made[1].grids:
        assert f'id="table-{name.replace("_", "-")}"' in text, name
    for figure in (made[0] / "figures").iterdir():
        assert f"figures/{figure.name}" in text, figure.name


def test_first_page_has_cards_with_numbers_and_says_what_was_made_again(made: tuple[Path, Context]) -> None:
    text = (made[0] / "docs" / "index.html").read_text("utf-8")
    assert "docs/index.html" in (made[0] / "index.html").read_text("utf-8")
    assert len(made[1].numbers) == 6
    assert all(f"<strong>{number}</strong>" in text for number in made[1].numbers.values())
    for word in ("cores", "numpy", "casadi", "those that ship", f"Parts of {len(made[1].agreements)} complete studies"):
        assert word in text


def test_every_claim_is_in_the_register_and_on_the_page_of_its_chapter(made: tuple[Path, Context]) -> None:
    folder, table = made[0] / "docs" / "results" / "claims", made[1].tables["claims"]
    register = (folder / "index.html").read_text("utf-8")
    assert not table["measured"].str.contains("is not there").any()  # what is open is so by its numbers
    for kind, count in table["verdict"].value_counts().items():
        assert register.count(f'data-verdict="{kind}"') == count
    for claim in few_claims():
        assert {claim.id, *claim.also} <= places(folder / f"chapter{claim.id[1]}.html")
        assert f'href="chapter{claim.id[1]}.html#{claim.id}"' in register
        assert claim.module in (made[0] / "code" / f"{claim.module.split('.')[2]}.html").read_text("utf-8")


def test_independent_references_agree(made: tuple[Path, Context]) -> None:
    references = made[1].tables["references"]
    assert (references["error"] <= 1e-12).all()
    assert (references["catch_up"] <= references["error"] + references["catch_up_error"]).all()
    assert (references["linearised"] <= references["catch_up_error"] + references["linearised_error"]).all()


def test_command_claims_lists_every_claim(made: tuple[Path, Context], monkeypatch: pytest.MonkeyPatch) -> None:
    shorten(monkeypatch)
    monkeypatch.setattr(context, "Context", Context)  # with what ships
    monkeypatch.setattr(study, "workers", Here)
    said = CliRunner().invoke(cli.app, ["claims", "--out", str(made[1].out)], env={"COLUMNS": "160"})
    other = differing(made[1].tables["claims"])
    assert said.exit_code == (0 if other.empty else 1), said.output
    for name in made[1].tables["claims"]["id"]:
        assert name in said.output


def test_command_report_makes_what_pages_show(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shorten(monkeypatch)
    monkeypatch.setattr(study, "workers", Here)
    monkeypatch.setattr(audit, "PAGES", PAGES[-1:])
    monkeypatch.setattr(report, "build", lambda *_: None)
    said = CliRunner().invoke(cli.app, ["report", "--full", "--out", str(tmp_path)])
    assert said.exit_code == 0, said.output
    assert "made here" in (tmp_path / "tables" / context.SHOWN).read_text("utf-8")
    found = pd.read_parquet(tmp_path / "tables" / "claims.parquet")
    assert found["measured"].str.contains("is not there").any()  # no study was run
