"""The key of cached machine code: the code of the folders that hold kernels; of other files also their imports."""

import math
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from dincl.compiled import folders
from dincl.compiled.folders import stamp

TEXT = '"""Text."""\n\nX = {}\n\n\ndef f():\n    """Doc."""\n    return X  # remark\n'
FILES = {
    "dincl/kernels/one.py": TEXT.format(1),
    "dincl/constants.py": "LARGEST = 1.0\n",
    "dincl/messages.py": "MESSAGE = 1\n",
    "dincl/kernels/drawn.py": "MAKES_NO_NUMBERS = True\nX = 1\n",
    "tissue/kernels/deep/two.py": TEXT.format(2),
}


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A house with three folders."""
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.setattr(folders, "_ROOT", tmp_path)
    monkeypatch.setattr(folders, "FOLDERS", ("dincl.constants", "dincl.kernels", "tissue.kernels"))
    monkeypatch.setattr(folders, "LOADED", math.inf)  # each look is that of a process that begins now
    return tmp_path


def function(module: str) -> Callable[..., None]:
    def made() -> None: ...

    made.__module__ = module
    return made


def stamps() -> tuple[str, str, str]:
    """Of a kernel of dincl, of one of tissue, of this test: as a new process would have them."""
    folders._CODE.clear()
    folders._folders.cache_clear()
    return stamp(function("dincl.kernels.one")), stamp(function("tissue.kernels.deep.two")), stamp(function(__name__))


@pytest.fixture(autouse=True)
def _forget() -> object:
    """Other tests ask for the folders that there are."""
    yield
    folders._CODE.clear()
    folders._folders.cache_clear()


@pytest.mark.parametrize(
    ("name", "old", "new", "changed"),
    [
        ("dincl/kernels/one.py", "X = 1", "X = 3", (True, True, True)),
        ("dincl/constants.py", "1.0", "2.0", (True, True, True)),
        ("tissue/kernels/deep/two.py", "X = 2", "X = 3", (False, True, True)),
        ("dincl/kernels/one.py", '"""Doc."""', '"""Another\n\n    docstring."""', (False, False, False)),
        ("dincl/kernels/one.py", "X = 1", "# A remark.\nX = 1", (False, False, False)),
        ("dincl/messages.py", "1", "2", (False, False, False)),
        ("dincl/kernels/drawn.py", "X = 1", "X = 2", (False, False, False)),
    ],
)
def test_what_a_change_makes_stale(name: str, old: str, new: str, changed: tuple[bool, bool, bool], tree: Path) -> None:
    before = stamps()
    text = (tree / name).read_text()
    assert old in text
    (tree / name).write_text(text.replace(old, new))
    assert tuple(one != other for one, other in zip(before, stamps(), strict=True)) == changed


def test_a_new_file_counts(tree: Path) -> None:
    before = stamps()
    (tree / "dincl/kernels/more.py").write_text("X = 1\n")
    assert all(one != other for one, other in zip(before, stamps(), strict=True))


@pytest.mark.parametrize("library", ["numba", "llvmlite", "numpy"])
def test_versions_count(library: str, monkeypatch: pytest.MonkeyPatch) -> None:
    before = stamps()
    folders.versions.cache_clear()
    monkeypatch.setattr(folders, "version", lambda name: "0.1" if name == library else "1.0")
    after = stamps()
    folders.versions.cache_clear()
    assert all(one != other for one, other in zip(before, after, strict=True))


def test_a_file_that_changes_while_a_process_runs_is_its_own(tree: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Modules that were loaded before make machine code that fits no file: no other process may take it."""
    new = stamps()
    monkeypatch.setattr(folders, "LOADED", (tree / "tissue/kernels/deep/two.py").stat().st_mtime - 1.0)
    mixed = stamps()
    assert [one == other for one, other in zip(new, mixed, strict=True)] == [False, False, False]
    for name in FILES:
        if name.startswith("dincl"):
            os.utime(tree / name, (0.0, 0.0))
    assert stamps()[0] == new[0]
