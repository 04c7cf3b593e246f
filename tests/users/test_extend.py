"""The pages about extensions: their Python runs, what they mention exists, and no page is left out."""

import re

import pytest

from tests.pages import ROOT, links, resolves, run

GUIDE = ROOT / "CONTRIBUTING.md"
FOLDER = ROOT / "docs" / "extend"
PAGES = sorted(FOLDER.glob("*.md"))
PACKAGES = {"dincl", "meanfield", "tissue", "verification"}
RUNNING = [page for page in PAGES if "```python" in page.read_text("utf-8")]


def test_the_guide_leads_to_every_page():
    assert {path for path in links(GUIDE) if path.parent == FOLDER} == set(PAGES)
    assert all(path.exists() for path in links(GUIDE))


@pytest.mark.slow_with("drift", "scheme")
@pytest.mark.parametrize("page", RUNNING, ids=lambda page: page.stem)
def test_examples_run(page, capsys):
    run(page)
    assert capsys.readouterr().out.strip()


@pytest.mark.parametrize("page", [GUIDE, ROOT / "ARCHITECTURE.md", *PAGES], ids=lambda page: page.stem)
def test_files_and_names_exist(page):
    text = re.sub(r"^```.*?^```", "", page.read_text("utf-8"), flags=re.MULTILINE | re.DOTALL)
    named = re.findall(r"`([^`\n]+)`", text)
    files = [words for words in named if re.fullmatch(r"[\w./]+", words) and ("/" in words or words.endswith(".toml"))]
    names = [words for words in named if re.fullmatch(r"\w+(\.\w+)+", words) and words.split(".")[0] in PACKAGES]
    assert [words for words in files if not (ROOT / words).exists() and not words.startswith("report/")] == []
    assert [words for words in names if not resolves(words)] == []
