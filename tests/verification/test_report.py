"""The pages have every section, open offline, and are written from tables without running anything again."""

import re
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from matplotlib.figure import Figure
from typer.testing import CliRunner

from dincl import study
from dincl.study import Study
from dincl.study.table import run_names
from tests.executors import Here
from tests.verification.in_browser import PagesInABrowser
from tests.verification.page import Page
from tests.verification.thesis.shortened import few_claims, shorten
from verification import cli
from verification.claims import Effect
from verification.claims.decide import differing
from verification.site import context
from verification.site.agreement import Agreement
from verification.site.context import Context
from verification.site.formulas import typeset
from verification.site.report import write_report
from verification.site.store import DATA
from verification.thesis import chapters
from verification.thesis.chapters import CHAPTERS
from verification.thesis.page import corrections
from verification.thesis.shipped_studies import STUDIES

pytestmark = pytest.mark.slow

LARGEST = 3e6  # bytes of a page, the script of its charts included


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Context]:
    """From the complete studies that ship, of which nothing is made again; with few claims."""
    out = tmp_path_factory.mktemp("report")
    shipped = Context(out, False, Here(), STUDIES, complete=DATA)
    with pytest.MonkeyPatch.context() as patch:
        shorten(patch)
        patch.setattr(Study, "_make", _only_claims)
        patch.setattr(Context, "_repeat", _said_to_agree)
        patch.setattr(Figure, "savefig", _saved_with_legends_inside)
        path = write_report(CHAPTERS, shipped)
    return path, shipped


MAKE = Study._make


SAVE = Figure.savefig


def _saved_with_legends_inside(figure: Figure, path: Path, **options: Any) -> None:
    SAVE(figure, path, **options)
    for legend in figure.legends:
        box = legend.get_window_extent()
        assert 0 <= box.x0 < box.x1 <= figure.bbox.x1, f"the legend of {path} is wider than the figure"


def _only_claims(study: Study, *given: Any) -> None:
    assert study.name.startswith("claims"), f"{study.name} was run, which ships"
    MAKE(study, *given)


def _said_to_agree(made: Context, study: Study, *_: object) -> None:
    made.agreements[study.name] = Agreement(study.title, 1, len(study.runs), 1, 0)


class TestPagesInABrowser(PagesInABrowser):
    """In this file, so that the report is made once: the tests of one file run in one process."""


def pages(made: tuple[Path, Context]) -> dict[str, Page]:
    """All pages of the report, by file."""
    names = ["index.html", *(chapter.file for chapter in CHAPTERS)]
    return {name: Page((made[0].parent / name).read_text("utf-8")) for name in names}


def test_every_section_is_in_the_contents_of_its_chapter(made: tuple[Path, Context]) -> None:
    found = pages(made)
    assert all(page.open == [] for page in found.values())
    assert all(found[chapter.file].headings for chapter in CHAPTERS)
    for page in found.values():
        assert len(set(page.ids)) == len(page.ids)
        assert {chapter.file for chapter in CHAPTERS} <= set(page.links)
        assert {f"#{name}" for name in page.ids if name.startswith("section-")} <= set(page.links)


def test_the_first_page_says_what_was_found_and_where_it_is_shown(made: tuple[Path, Context]) -> None:
    text = made[0].read_text("utf-8")
    linked = [link for link in Page(text).links if "#section-" in link]
    assert len(CHAPTERS) <= len(linked) <= 15
    assert {link.partition("#")[0] for link in linked} == {chapter.file for chapter in CHAPTERS}
    assert "refresh" not in text
    for chapter in CHAPTERS:
        assert chapter.asked in text
        own = (made[0].parent / chapter.file).read_text("utf-8")
        for found in chapter.findings(made[1]):
            shown = found.card.html if found.card else found.html
            assert typeset(shown) in text
            assert typeset(found.html) in own
            assert re.search(r"\d", shown)


def test_pages_open_offline_and_link_what_is_there(made: tuple[Path, Context]) -> None:
    folder, found = made[0].parent, pages(made)
    texts = [re.sub(r"<script>.*?</script>", "", path.read_text("utf-8"), flags=re.S) for path in folder.glob("*.html")]
    assert not any("://" in text for text in texts)
    images = [image for page in found.values() for image in page.images]
    assert len(images) == len(set(images)) > len(CHAPTERS)
    assert all((folder / image).is_file() for image in images)
    for name, page in found.items():
        for link in page.links:
            file, _, place = link.partition("#")
            assert (folder / (file or name)).is_file(), link
            target = found.get(file or name) or Page((folder / file).read_text("utf-8") if place else "")
            assert not place or place in target.ids, link


def test_no_formula_is_left_as_it_is_typed(made: tuple[Path, Context]) -> None:
    for path in made[0].parent.glob("*.html"):
        shown = re.sub(r"<(script|style)\b.*?</\1>|<[^>]*>", "", path.read_text("utf-8"), flags=re.S)
        assert not re.findall(r".*(?:\$|[_^]\{).*", shown), path.name


def test_tables_and_figures_lie_beside_the_page(made: tuple[Path, Context]) -> None:
    folder = made[0].parent
    kept, plain = ({path.stem for path in (folder / "tables").glob(f"*.{kind}")} for kind in ("parquet", "csv"))
    assert kept == plain >= made[1].studies.keys()
    assert made[1].studies.keys() <= {path.stem for path in DATA.glob("*.parquet")}
    assert list(folder.rglob(".*.new")) == []
    assert all(page.stat().st_size < LARGEST for page in folder.glob("*.html"))


def test_page_states_machine_versions_orders_and_verdicts(made: tuple[Path, Context]) -> None:
    tables = made[1].tables
    for word in ("cores", "numpy", "casadi", "those that ship", f"Parts of {len(made[1].agreements)} complete studies"):
        assert word in made[0].read_text("utf-8")
    text = (made[0].parent / "experiments.html").read_text("utf-8")
    for order in tables["order_fits"]["order"]:
        assert order in text
    for sentence in tables["order_fits"]["verdict"]:
        assert sentence in text


def test_page_has_every_claim_and_the_most_serious_corrections_first(made: tuple[Path, Context]) -> None:
    text, table = (made[0].parent / "statements.html").read_text("utf-8"), made[1].tables["claims"]
    assert table["id"].tolist() == [claim.id for claim in few_claims()]
    stated = [name for claim in few_claims() for name in (claim.id, *claim.also)]
    assert [name for name in Page(text).ids if re.match(r"c\d\.", name)] == stated
    assert not table["measured"].str.contains("is not there").any()  # what is open is so by its numbers
    for kind, count in table["verdict"].value_counts().items():
        assert text.count(f'data-verdict="{kind}"') == count
    wrong = corrections(table, made[1].tables["claims_errata"])
    order = {effect.value: number for number, effect in enumerate(Effect)}
    assert wrong["effect"].map(order).is_monotonic_increasing
    assert Effect.NOTATION.value not in set(wrong["effect"])
    for word in ('id="words"', "hidden"):
        assert word in text


def test_each_chapter_fills_tables_of_its_own_names(made: tuple[Path, Context]) -> None:
    beginnings = [chapter.tables or ("claims",) for chapter in CHAPTERS]
    for name in made[1].tables.keys() - {f"made_again_{chapter.name}" for chapter in CHAPTERS}:
        assert sum(name.startswith(own) for own in beginnings) == 1, name


def test_all_runs_of_the_complete_studies_ship(made: tuple[Path, Context]) -> None:
    for name, complete in made[1].studies.items():
        shipped = pd.read_parquet(DATA / f"{name}.parquet")
        assert set(run_names(shipped, complete.key)) == set(map(complete.name_of, complete.runs)), name


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


def test_command_report(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shorten(monkeypatch)
    monkeypatch.setattr(study, "workers", Here)
    monkeypatch.setattr(chapters, "CHAPTERS", CHAPTERS[-1:])
    said = CliRunner().invoke(cli.app, ["report", "--full", "--out", str(tmp_path)])
    assert said.exit_code == 0, said.output
    assert "made here" in (tmp_path / "index.html").read_text("utf-8")
    assert "is not there" in (tmp_path / "statements.html").read_text("utf-8")  # no study was run
