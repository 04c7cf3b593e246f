"""The tutorials that come from one package each: their Python runs, their commands and their study do what they say."""

import shlex
from pathlib import Path

import pytest
from typer.testing import CliRunner

from tests.pages import ROOT, blocks, links, run
from tests.verification.thesis.shortened import shorten
from tissue import cli
from tissue.study.plan import load_study

PAGES = ROOT / "docs" / "tutorials"
TISSUE = (PAGES / "tissue.md").read_text("utf-8")
PRINTED = {
    "solve.md": ("SUCCESS", "LinearisedCatchUp", "contact, particle", "smaller dt"),
    "tissue.md": ("SUCCESS", "height_um"),
    "meanfield.md": ("g is affine in X", "Work("),
}


@pytest.mark.parametrize("page", PRINTED)
def test_python_runs_from_top_to_bottom(page, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # where it may write
    run(PAGES / page)
    printed = capsys.readouterr().out
    assert [words for words in PRINTED[page] if words not in printed] == []


@pytest.mark.parametrize("lines", blocks(TISSUE, "sh"), ids=lambda text: text.split(" --")[0])
def test_commands_of_the_tissue_run_in_their_order(lines, tmp_path, monkeypatch):
    """With the studies shortened."""
    shorten(monkeypatch)
    monkeypatch.chdir(tmp_path)
    for command in lines.splitlines():
        program, *arguments = shlex.split(command)
        assert Path(program).name == "tissue"
        done = CliRunner().invoke(cli.app, arguments)
        assert done.exit_code == 0, done.output
    assert any((tmp_path / "results").iterdir())


def test_the_study_of_the_text_is_one(tmp_path):
    (text,) = blocks(TISSUE, "toml")
    file = tmp_path / "study.toml"
    file.write_text(text, "utf-8")
    found = load_study(file)
    assert {name: parameters.emt.cells for name, parameters in found.scenarios.items()} == {"alone": 1, "group": 10}
    assert found.runs == 800


@pytest.mark.parametrize("page", sorted((ROOT / "docs").rglob("*.md")), ids=lambda path: path.name)
def test_links_are_there(page):
    assert [path for path in links(page) if not path.exists()] == []
