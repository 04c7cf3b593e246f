"""The pages have every section, open offline, and are written from tables without running anything again."""

import re
from pathlib import Path

import pandas as pd
import pytest
from typer.testing import CliRunner

from dincl import study
from tests.verification.in_browser import PagesInABrowser
from tests.verification.page import Page
from tests.verification.thesis.shortened import FORMS, Here, Nowhere, few_claims, shorten
from tests.verification.thesis.shortened_emt import SECTIONS as EMT_SECTIONS
from tests.verification.thesis.shortened_meanfield import PICTURES as MEANFIELD_PICTURES
from tests.verification.thesis.shortened_meanfield import SECTIONS as MEANFIELD_SECTIONS
from tests.verification.thesis.shortened_meanfield import TABLES as MEANFIELD_TABLES
from verification import cli
from verification.claims import Effect
from verification.decide import differing
from verification.page.report import Context, write_report
from verification.thesis import chapters
from verification.thesis.chapter4 import kept
from verification.thesis.chapters import CHAPTERS
from verification.thesis.page import TITLES, corrections

SECTIONS = [
    "Two scenes in time",
    "The reference",
    "Convergence: four discs drawn to one point",
    "Convergence: ten discs falling into a corner",
    "Infeasibility: PBD against the penalty method with its best strength",
    "Large steps",
    "Who is cheapest",
    "How far the event-driven scheme pays",
    "Speed against accuracy: a disc slides over a fixed disc",
    "Speed against accuracy: a row of intervals pressed against a wall",
    "Failures that theory predicts",
    "Map: the stiffness of the drift",
    "Map: the strength of a penalty",
    "Map: the prox-regularity radius",
    "Six decades of dt",
    "The Pacman set",
    "How far from convex: the constant of prox-regularity",
    "Consistency of PBD",
    "Substeps: how exact, how fast",
    "PBD against catch-up on a frozen tissue",
    "How long nuclei can be foretold",
    "Growth of the height",
    "Where substeps become unstable",
    "DAHA against PBD",
    "How far from a minimum a step ends",
    "The kernel",
    *EMT_SECTIONS,
    "Does curvature matter?",
    "Does it matter that a tube is closed?",
    "A large circle becomes the line",
    *MEANFIELD_SECTIONS,
    "How the statements came out",
    "Corrections that change results",
    "Errata of notation",
    "All statements, to be searched",
    *TITLES.values(),
]
TABLES = {
    "references",
    "catch_up",
    "exactness",
    "convergence",
    "orders",
    "penalty_scan",
    "penalty_best",
    "infeasibility",
    "large_steps",
    "work_references",
    "work_precision",
    "work_times",
    "work_reach",
    "work_winners",
    "stability_penalty",
    "stability_radius",
    "stability_drift",
    "stability_decades",
    "stability_cases",
    "stability_verdicts",
    "stability_outcomes",
    "stability_pacman",
    "prox_constants",
    "prox_arrangements",
    "consistency_steps",
    "consistency_settling",
    "consistency",
    "claims",
    "claims_decided",
    "claims_errata",
    "tissue_catch_up",
    "tissue_catch_up_errors",
    "tissue_catch_up_orders",
    "tissue_daha",
    "tissue_daha_descent",
    "tissue_daha_distances",
    "tissue_daha_failures",
    "tissue_daha_fits",
    "tissue_daha_held",
    "tissue_daha_iterations",
    "tissue_daha_multipliers",
    "tissue_daha_speed",
    "tissue_distances",
    "tissue_disturbed",
    "tissue_doubling",
    "tissue_enough",
    "tissue_errors",
    "tissue_foretold",
    "tissue_growth",
    "tissue_heights",
    "tissue_jitter",
    "tissue_judged",
    "tissue_judged_steps",
    "tissue_kernel",
    "tissue_kernel_growth",
    "tissue_limits",
    "tissue_limits_found",
    "tissue_map_bending",
    "tissue_map_damping",
    "tissue_map_springs",
    "tissue_map_steps",
    "tissue_orders",
    "tissue_rates",
    "tissue_ratios",
    "tissue_substeps",
    "tissue_swing",
    "tissue_thrown",
    "curved_limit",
    "curved_lumen",
    "curved_tubes",
    "curved_ways_out",
    *(f"emt_{name}" for name in kept.TABLES),
    *(f"emt_complete_{name}" for name in kept.COMPLETE),
    *MEANFIELD_TABLES,
}
IMAGES = 42 + MEANFIELD_PICTURES
LARGEST = 3e6  # bytes of a page, the script of its charts included


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Context]:
    out = tmp_path_factory.mktemp("report")
    context = Context(out, False, Here(), FORMS)
    with pytest.MonkeyPatch.context() as patch:
        shorten(patch)
        path = write_report(CHAPTERS, context)
    return path, context


class TestPagesInABrowser(PagesInABrowser):
    """In this file, so that the report is made once: the tests of one file run in one process."""


def pages(made: tuple[Path, Context]) -> dict[str, Page]:
    """All pages of the report, by file."""
    names = ["index.html", *(chapter.file for chapter in CHAPTERS)]
    return {name: Page((made[0].parent / name).read_text("utf-8")) for name in names}


def test_every_section_is_in_the_contents_of_its_chapter(made: tuple[Path, Context]) -> None:
    found = pages(made)
    assert all(page.open == [] for page in found.values())
    assert [title for chapter in CHAPTERS for title in found[chapter.file].headings] == SECTIONS
    for page in found.values():
        assert len(set(page.ids)) == len(page.ids)
        assert {chapter.file for chapter in CHAPTERS} <= set(page.links)
        assert {f"#{name}" for name in page.ids if name.startswith("section-")} <= set(page.links)


def test_the_first_page_says_what_was_found_and_where_it_is_shown(made: tuple[Path, Context]) -> None:
    text = made[0].read_text("utf-8")
    linked = [link for link in Page(text).links if "#section-" in link]
    assert len(CHAPTERS) <= len(linked) <= 10
    assert {link.partition("#")[0] for link in linked} == {chapter.file for chapter in CHAPTERS}
    assert "refresh" not in text
    for chapter in CHAPTERS:
        assert chapter.asked in text
        own = (made[0].parent / chapter.file).read_text("utf-8")
        for found in chapter.findings(made[1]):
            assert found.html in text
            assert found.html in own
            assert re.search(r"\d", found.html)


def test_pages_open_offline_and_link_what_is_there(made: tuple[Path, Context]) -> None:
    folder, found = made[0].parent, pages(made)
    texts = [re.sub(r"<script>.*?</script>", "", path.read_text("utf-8"), flags=re.S) for path in folder.glob("*.html")]
    assert not any("://" in text for text in texts)
    images = [image for page in found.values() for image in page.images]
    assert len(images) == len(set(images)) == IMAGES
    assert all((folder / image).is_file() for image in images)
    for name, page in found.items():
        for link in page.links:
            file, _, place = link.partition("#")
            assert (folder / (file or name)).is_file()
            assert not place or place in found[file or name].ids, link


def test_tables_and_figures_lie_beside_the_page(made: tuple[Path, Context]) -> None:
    folder = made[0].parent
    assert {path.stem for path in (folder / "tables").glob("*.parquet")} == TABLES | {"reference"}
    assert {path.stem for path in (folder / "tables").glob("*.csv")} == TABLES | {"reference"}
    assert len(list((folder / "figures").glob("*.png"))) == IMAGES
    assert list(folder.rglob(".*.new")) == []
    assert all(page.stat().st_size < LARGEST for page in folder.glob("*.html"))


def test_page_states_machine_versions_orders_and_verdicts(made: tuple[Path, Context]) -> None:
    tables = made[1].tables
    for word in ("cores", "numpy", "casadi", "short: fewer and coarser steps"):
        assert word in made[0].read_text("utf-8")
    text = (made[0].parent / "experiments.html").read_text("utf-8")
    for order in tables["orders"]["order"]:
        assert order in text
    for sentence in tables["orders"]["verdict"]:
        assert sentence in text


def test_page_has_every_claim_and_the_most_serious_corrections_first(made: tuple[Path, Context]) -> None:
    text, table = (made[0].parent / "statements.html").read_text("utf-8"), made[1].tables["claims"]
    assert table["id"].tolist() == [claim.id for claim in few_claims()]
    assert [name for name in Page(text).ids if re.match(r"c\d\.", name)] == table["id"].tolist()
    assert not table["measured"].str.contains("is not there").any()  # what is open is so by its numbers
    for kind, count in table["verdict"].value_counts().items():
        assert text.count(f'data-verdict="{kind}"') == count
    wrong = corrections(table)
    order = {effect.value: number for number, effect in enumerate(Effect)}
    assert wrong["effect"].map(order).is_monotonic_increasing
    assert Effect.NOTATION.value in set(table["effect"]) - set(wrong["effect"])
    for word in ('id="words"', "hidden"):
        assert word in text


def test_second_report_runs_nothing(made: tuple[Path, Context], monkeypatch: pytest.MonkeyPatch) -> None:
    shorten(monkeypatch)
    before = made[1].tables
    again = Context(made[1].out, False, Nowhere(), FORMS)
    for chapter in CHAPTERS:
        known = set(again.tables)
        chapter.run(again)
        assert all(name.startswith(chapter.tables or "claims") for name in again.tables.keys() - known), chapter.title
    for name, table in again.tables.items():
        kept_columns = [column for column in table if (name, column) != ("claims", "seconds")]  # some are decided anew
        pd.testing.assert_frame_equal(table[kept_columns], before[name][kept_columns])


def test_independent_references_agree(made: tuple[Path, Context]) -> None:
    references = made[1].tables["references"]
    assert len(references) == 5
    assert (references["error"] <= 1e-12).all()
    exact = made[1].tables["exactness"]
    assert len(exact) == 5
    assert (exact["true"] <= exact["stated"]).all()
    assert (exact["stated"] <= 1e-12).all()
    assert (references["catch_up"] <= references["error"] + references["catch_up_error"]).all()
    assert (references["daqp"] < 1e-8).all()
    assert (references["linearised"] <= references["catch_up_error"] + references["linearised_error"]).all()


def test_command_claims_runs_only_what_is_missing(made: tuple[Path, Context], monkeypatch: pytest.MonkeyPatch) -> None:
    shorten(monkeypatch)
    monkeypatch.setattr(study, "workers", Nowhere)
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
    assert "complete" in (tmp_path / "index.html").read_text("utf-8")
    assert "is not there" in (tmp_path / "statements.html").read_text("utf-8")  # no study was run
