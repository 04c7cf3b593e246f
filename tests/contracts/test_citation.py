"""CITATION.cff and SOURCE.md: what they say of the software is what pyproject.toml says; both name the source."""

import re
import tomllib

import pytest
import yaml  # comes with bokeh

from tests.pages import ROOT, blocks
from verification.thesis.register import chapter_of, modules, register

CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text("utf-8"))
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
SOURCE = (ROOT / "SOURCE.md").read_text("utf-8")
(THESIS,) = CITATION["references"]
# What the Citation File Format asks for.
NEEDED = {"cff-version", "message", "title", "authors"}


def test_the_citation_has_what_its_format_asks_for():
    assert set(CITATION) >= NEEDED
    assert CITATION["cff-version"] == "1.2.0"
    assert CITATION["type"] == "software"
    assert all("name" in author or "family-names" in author for author in CITATION["authors"] + THESIS["authors"])
    assert {"type", "title", "authors"} <= set(THESIS)


def test_it_cites_this_project():
    said = (CITATION["title"], str(CITATION["version"]), CITATION["license"], CITATION["abstract"])
    assert said == (PROJECT["name"], PROJECT["version"], PROJECT["license"], PROJECT["description"])
    assert [author["name"] for author in CITATION["authors"]] == [author["name"] for author in PROJECT["authors"]]


def test_its_version_and_date_head_the_changelog():
    (first, *_) = re.findall(r"^## (.*)$", (ROOT / "CHANGELOG.md").read_text("utf-8"), re.MULTILINE)
    assert first == f"{CITATION['version']} — {CITATION['date-released']}"


def test_both_name_the_same_source():
    (author,) = THESIS["authors"]
    flat = " ".join(SOURCE.replace("\n>", " ").split())
    for words in (f"{author['given-names']} {author['family-names']}", THESIS["title"], THESIS["institution"]["name"]):
        assert words in flat


def test_the_examples_of_the_source_page_are_so():
    ids = {claim.id for claim in register()}
    names = {name.split(".", 2)[2] for name in modules()}
    assert re.findall(r"`(c\d\.\w+)`", SOURCE) == ["c3.box"]
    assert "c3.box" in ids
    assert "chapter3.claims.s2_2_6_energies" in names
    assert {chapter_of(claim) for claim in register()} == set(range(7))
    (command,) = blocks(SOURCE, "sh")
    assert command.strip().startswith(".venv/bin/verification claims")


# A citation of a part that every chapter numbers anew; its chapter, or the year of another work, stands beside it.
PART = re.compile(r"\b(?:[Ss]ections?|Tables?|Figures?|Algorithms?) \d+(?:\.\d+)*")
CHAPTER = re.compile(r"chapter \d|appendix|\(\d{4}\)")
BESIDE = 90


@pytest.mark.parametrize("package", ["dincl", "meanfield", "tissue"])
def test_sections_are_cited_with_their_chapter(package):
    """As in "section 2.2.5 of chapter 3"."""
    texts = {file.relative_to(ROOT): file.read_text("utf-8") for file in (ROOT / package).rglob("*.py")}
    cited = [(name, text, found) for name, text in texts.items() for found in PART.finditer(text)]
    beside = [text[max(0, found.start() - BESIDE) : found.end() + BESIDE] for _, text, found in cited]
    assert cited
    assert [
        f"{name}: {found[0]}"
        for (name, _, found), words in zip(cited, beside, strict=True)
        if not CHAPTER.search(words)
    ] == []
