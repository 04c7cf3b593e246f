"""CITATION.cff says of the software what pyproject.toml says, and cites the thesis of SOURCE.md."""

import re
import tomllib

import yaml  # comes with bokeh

from tests.pages import ROOT

CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text("utf-8"))
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]


def test_it_cites_this_project_in_its_version():
    assert set(CITATION) >= {"cff-version", "message", "title", "authors"}
    said = (CITATION["title"], str(CITATION["version"]), CITATION["license"])
    assert said == (PROJECT["name"], PROJECT["version"], PROJECT["license"])
    (first, *_) = re.findall(r"^## (.*)$", (ROOT / "CHANGELOG.md").read_text("utf-8"), re.MULTILINE)
    assert first == f"{CITATION['version']} — {CITATION['date-released']}"


def test_it_cites_the_thesis():
    (thesis,) = CITATION["references"]
    (author,) = thesis["authors"]
    flat = " ".join((ROOT / "SOURCE.md").read_text("utf-8").replace("\n>", " ").split())
    for words in (f"{author['given-names']} {author['family-names']}", thesis["title"], thesis["institution"]["name"]):
        assert words in flat
