"""The folder of the page: no name leads out of it, nothing is overwritten, no code comes from elsewhere."""

import json
import os
import sys
from pathlib import Path

import pytest

import tissue
from dincl.errors import InvalidProblem
from tests.full_disk import full_disk
from tissue.study.plan import load_study
from tissue.study.store import opened
from verification.explore.common.folder import Folder, NeedsPython


@pytest.fixture
def outside(tmp_path):
    """A file of parameters and one of Python outside of the folder."""
    (tmp_path / "other.toml").write_text('base = "thesis"\n')
    (tmp_path / "code.py").write_text("raise SystemExit('this must never run')\n")
    return tmp_path


@pytest.fixture
def folder(outside):
    (outside / "mine").mkdir()
    return Folder(outside / "mine")


@pytest.mark.parametrize(
    "name", ["../other.toml", "/etc/passwd", "", ".", "..", ".hidden", "a/b", "a\\b", "a\0b", None, 3]
)
def test_only_plain_names_are_taken(folder, name):
    with pytest.raises(InvalidProblem, match="without a folder"):
        folder.path(name)


def test_a_link_out_of_the_folder_is_no_file_of_it(folder, outside):
    (folder.root / "link.toml").symlink_to(outside / "other.toml")
    with pytest.raises(InvalidProblem):
        folder.parameters("link.toml")
    assert folder.parameter_files() == []


@pytest.mark.parametrize("name", ["pipe.toml", "loop.toml", "folder.toml", "missing.toml", "to_pipe.toml"])
def test_what_is_no_file_is_refused_at_once(folder, name):
    """To open a pipe would wait, and all visitors with it; a link to itself has no end."""
    os.mkfifo(folder.root / "pipe.toml")
    (folder.root / "loop.toml").symlink_to("loop.toml")
    (folder.root / "to_pipe.toml").symlink_to("pipe.toml")
    (folder.root / "folder.toml").mkdir()
    (folder.root / "above.toml").write_text(f'base = "{name}"\n')
    (folder.root / "results" / "a").mkdir(parents=True)
    os.mkfifo(folder.root / "results" / "a" / "study.json")
    (folder.root / "b").mkdir()
    (folder.root / "b" / "study.json").symlink_to("study.json")
    for asked in (name, "above.toml"):
        with pytest.raises(InvalidProblem, match="must be a file in mine"):
            folder.parameters(asked)
    assert folder.parameter_files() == ["above.toml"]
    for study in folder.studies():
        with pytest.raises(InvalidProblem, match="must be the record of a study"):
            folder.results(study)


@pytest.mark.parametrize(
    "text",
    [
        'base = "../other.toml"',
        'base = "thesis"\n[own]\nmodules = ["../code.py"]',
        'base = "near.toml"',
    ],
)
def test_a_file_that_names_others_outside_is_refused(folder, outside, text):
    (folder.root / "near.toml").write_text(f'base = "thesis"\n[own]\nmodules = ["{outside / "code.py"}"]')
    (folder.root / "mine.toml").write_text(text)
    with pytest.raises(InvalidProblem, match="without a folder"):
        folder.parameters("mine.toml")


def test_files_of_the_folder_may_name_each_other(folder):
    (folder.root / "near.toml").write_text('base = "thesis"\n[tissue]\ncells = 30')
    (folder.root / "mine.toml").write_text('base = "near.toml"\n[own]\nmodules = ["nothing_at_all.py"]')
    with pytest.raises(InvalidProblem, match="must be a file of Python"):
        folder.parameters("mine.toml", agreed=True)
    assert folder.parameters("near.toml").tissue.cells == 30
    assert folder.parameters("chick") == tissue.preset("chick")


def write_plugin(folder, name, text):
    """A file that needs one of Python through its base, which notes that it is run."""
    (folder.root / f"{name}.py").write_text(
        f"with open({str(folder.root / name)!r}, 'a') as file:\n    file.write('x')\n{text}\n"
    )
    (folder.root / f"{name}.toml").write_text(f'base = "thesis"\n[own]\nmodules = ["{name}.py"]')
    (folder.root / "above.toml").write_text(f'base = "{name}.toml"')


def test_code_is_imported_once_someone_has_agreed(folder):
    write_plugin(folder, "agreed_plugin", "")
    with pytest.raises(NeedsPython, match=r"above\.toml: needs agreed_plugin\.py: files of Python"):
        folder.parameters("above.toml")
    assert not (folder.root / "agreed_plugin").exists()
    folder.parameters("above.toml", agreed=True)
    folder.parameters("above.toml")
    assert (folder.root / "agreed_plugin").read_text() == "x"


@pytest.mark.parametrize("text", ["raise SystemExit(3)", "import sys; sys.exit('bye')", "1 / 0"])
def test_code_that_ends_the_program_ends_nothing_and_is_no_module(text, folder):
    write_plugin(folder, "ending_plugin", text)
    for times in (1, 2):
        with pytest.raises(InvalidProblem, match=r"ending_plugin\.py: cannot be imported: "):
            folder.parameters("above.toml", agreed=True)
        assert "ending_plugin" not in sys.modules
        assert (folder.root / "ending_plugin").read_text() == times * "x"
    with pytest.raises(NeedsPython):  # to agree to what failed is to agree once
        folder.parameters("above.toml")


@pytest.mark.parametrize("names", [["one"], ["one", "two", "three"]])
def test_a_base_that_names_itself_is_refused(names, folder):
    for name, base in zip(names, [*names[1:], names[0]], strict=True):
        (folder.root / f"{name}.toml").write_text(f'base = "{base}.toml"')
    with pytest.raises(InvalidProblem, match="must not be based on this file"):
        folder.parameters("one.toml")


def test_a_full_disk_leaves_no_file(folder):
    with full_disk(), pytest.raises(InvalidProblem, match=r"new\.toml: cannot be written: File too large"):
        folder.save("new", "x" * 1000)
    assert list(folder.root.iterdir()) == []


def test_nothing_is_overwritten(folder):
    path = folder.save("new", "first = 1")
    assert path == folder.root / "new.toml"
    with pytest.raises(InvalidProblem, match="new name"):
        folder.save("new.toml", "second = 2")
    assert path.read_text() == "first = 1"
    with pytest.raises(InvalidProblem, match="without a folder"):
        folder.save("../new", "")


def test_a_study_may_not_bring_code_from_elsewhere(folder, outside):
    kept, text = (
        folder.root / "results" / "study",
        'title = "a"\nbase = "thesis"\nreplicates = 1\nseed = 1\n[scenarios.A]\n',
    )
    (outside / "study.toml").write_text(text)
    with opened(load_study(outside / "study.toml"), kept):
        record = json.loads((kept / "study.json").read_text())
    record["parameters"]["A"]["own"] = {"modules": [str(outside / "code.py")]}
    (kept / "study.json").write_text(json.dumps(record))
    assert folder.studies() == ["results/study"]
    with pytest.raises(InvalidProblem, match="without a folder"):
        folder.results("results/study")
    with pytest.raises(InvalidProblem, match="must be a study in"):
        folder.results("../mine/results/study")


def test_a_folder_that_is_none_is_refused(tmp_path):
    with pytest.raises(InvalidProblem, match="must be a folder"):
        Folder(Path(tmp_path / "nothing"))
