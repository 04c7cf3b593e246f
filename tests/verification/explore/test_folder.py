"""The folder of the page: no name leads out of it, nothing is overwritten, no code comes from elsewhere."""

import os
import sys

import pytest

import tissue
from dincl.errors import InvalidProblem
from tests.full_disk import full_disk
from verification.explore.folder import Folder


@pytest.fixture
def folder(tmp_path):
    """A folder beside a file of parameters and one of Python."""
    (tmp_path / "other.toml").write_text('base = "thesis"\n')
    (tmp_path / "code.py").write_text("raise SystemExit('this must never run')\n")
    (tmp_path / "mine").mkdir()
    return Folder(tmp_path / "mine")


@pytest.mark.parametrize(
    "name", ["../other.toml", "/etc/passwd", "", ".", "..", ".hidden", "a/b", "a\\b", "a\0b", None, 3]
)
def test_only_plain_names_are_taken(folder, name):
    with pytest.raises(InvalidProblem, match="without a folder"):
        folder.path(name)


@pytest.mark.parametrize("name", ["pipe.toml", "loop.toml", "folder.toml", "missing.toml", "to_pipe.toml"])
def test_what_is_no_file_is_refused_at_once(folder, name):
    """To open a pipe would wait, and all visitors with it; a link to itself has no end, another leads outside."""
    os.mkfifo(folder.root / "pipe.toml")
    (folder.root / "loop.toml").symlink_to("loop.toml")
    (folder.root / "to_pipe.toml").symlink_to("pipe.toml")
    (folder.root / "link.toml").symlink_to(folder.root.parent / "other.toml")
    (folder.root / "folder.toml").mkdir()
    (folder.root / "above.toml").write_text(f'base = "{name}"\n')
    for asked in (name, "above.toml"):
        with pytest.raises(InvalidProblem, match="must be a file in mine"):
            folder.parameters(asked)
    with pytest.raises(InvalidProblem, match="without a folder"):
        folder.parameters("link.toml")
    assert folder.parameter_files() == ["above.toml"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('base = "../other.toml"', "without a folder"),
        ('base = "thesis"\n[own]\nmodules = ["../code.py"]', "without a folder"),
        ('base = "near.toml"', "without a folder"),
        ('base = "plain.toml"\n[own]\nmodules = ["nothing_at_all.py"]', "must be a file of Python"),
        ('base = "mine.toml"', "must not be based on this file"),
        ('base = "circle.toml"', "must not be based on this file"),
    ],
)
def test_files_may_name_each_other_but_none_outside_and_not_themselves(folder, text, message):
    outside = folder.root.parent / "code.py"
    (folder.root / "near.toml").write_text(f'base = "thesis"\n[own]\nmodules = ["{outside}"]')
    (folder.root / "plain.toml").write_text('base = "thesis"\n[tissue]\ncells = 30')
    (folder.root / "circle.toml").write_text('base = "mine.toml"')
    (folder.root / "mine.toml").write_text(text)
    with pytest.raises(InvalidProblem, match=message):
        folder.parameters("mine.toml")
    assert folder.parameters("plain.toml").tissue.cells == 30
    assert folder.parameters("chick") == tissue.preset("chick")


def write_plugin(folder, name, text):
    """A file that needs one of Python through its base, which notes that it is run."""
    (folder.root / f"{name}.py").write_text(
        f"with open({str(folder.root / name)!r}, 'a') as file:\n    file.write('x')\n{text}\n"
    )
    (folder.root / f"{name}.toml").write_text(f'base = "thesis"\n[own]\nmodules = ["{name}.py"]')
    (folder.root / "above.toml").write_text(f'base = "{name}.toml"')


def test_code_is_imported_once_someone_chose_its_file(folder):
    write_plugin(folder, "chosen_plugin", "")
    with pytest.raises(InvalidProblem, match=r"above\.toml: needs chosen_plugin\.py: an address imports no files"):
        folder.parameters("above.toml", chosen=False)
    assert not (folder.root / "chosen_plugin").exists()
    folder.parameters("above.toml")
    folder.parameters("above.toml", chosen=False)
    assert (folder.root / "chosen_plugin").read_text() == "x"


@pytest.mark.parametrize("text", ["raise SystemExit(3)", "import sys; sys.exit('bye')", "1 / 0"])
def test_code_that_ends_the_program_ends_nothing_and_is_no_module(text, folder):
    write_plugin(folder, "ending_plugin", text)
    for times in (1, 2):
        with pytest.raises(InvalidProblem, match=r"ending_plugin\.py: cannot be imported: "):
            folder.parameters("above.toml")
        assert "ending_plugin" not in sys.modules
        assert (folder.root / "ending_plugin").read_text() == times * "x"
    with pytest.raises(InvalidProblem, match="an address imports no files"):
        folder.parameters("above.toml", chosen=False)


def test_nothing_is_overwritten_and_a_full_disk_leaves_no_file(folder):
    path = folder.save("new", "first = 1")
    assert path == folder.root / "new.toml"
    with pytest.raises(InvalidProblem, match="new name"):
        folder.save("new.toml", "second = 2")
    assert path.read_text() == "first = 1"
    with full_disk(), pytest.raises(InvalidProblem, match=r"more\.toml: cannot be written: File too large"):
        folder.save("more", "x" * 1000)
    assert list(folder.root.iterdir()) == [path]
    with pytest.raises(InvalidProblem, match="must be a folder"):
        Folder(folder.root / "nothing")
