"""Kernels are compiled again if code that they can reach has changed, in whichever file; damaged files cost no run.

Each case runs in processes of its own, on a package of a user whose kernel calls one of another file.
"""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

FILES = {
    "__init__": "",
    "caller": '"""Calls."""\nfrom called.inner import factor\nfrom called.more.constants import SHIFT\n'
    "from dincl.compiled import kernel\n\n\n@kernel\ndef scaled(x):\n    return factor() * x + SHIFT\n",
    "inner": "from dincl.compiled import inner\n\n\n@inner\ndef factor():\n    return 2.0\n",
    "more/__init__": "",
    "more/constants": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from called.other import X\n"
    "try:\n    from ..shift import SHIFT\nexcept ImportError:\n    SHIFT = 0.0\n",
    "shift": "SHIFT = 1.0\n",
    "other": "X = 1\n",
}
PROGRAM = """
import sys
from called.caller import scaled
print(*(scaled(eval(x)) for x in sys.argv[1:]), sum(scaled.stats.cache_misses.values()))
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        path = tmp_path / "called" / f"{name}.py"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path


def start(folder: Path, *values: str, **env: str) -> subprocess.Popen[str]:
    paths = os.pathsep.join([str(folder), *sys.path])
    env = os.environ | {"PYTHONPATH": paths, "NUMBA_CACHE_DIR": str(folder / "cache")} | env
    command = [sys.executable, "-c", PROGRAM, *values]
    return subprocess.Popen(command, env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def called(folder: Path, *values: str, **env: str) -> list[float]:
    """Return the values in a new process, then how often the kernel was compiled for them."""
    run = start(folder, *(values or ("10.0",)), **env)
    out, problems = run.communicate()
    assert run.returncode == 0, problems
    return [float(number) for number in out.split()]


def change(folder: Path, name: str, old: str, new: str) -> None:
    path = folder / "called" / f"{name}.py"
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))


@pytest.mark.slow
def test_a_change_beneath_a_kernel_gives_the_new_result_and_nothing_else_compiles(folder: Path) -> None:
    assert called(folder) == [21.0, 1]
    change(folder, "other", "1", "2")
    os.utime(folder / "called" / "inner.py", (2e9, 2e9))
    assert called(folder) == [21.0, 0]
    change(folder, "inner", "2.0", "3.0")
    assert called(folder) == [31.0, 1]
    change(folder, "shift", "1.0", "5.0")
    assert called(folder) == [35.0, 1]
    change(folder, "caller", "* x", "* -x")
    assert called(folder) == [-25.0, 1]
    assert called(folder) == [-25.0, 0]


@pytest.mark.slow
@pytest.mark.parametrize("damage", [lambda data: b"", lambda data: data[: len(data) // 2]], ids=["empty", "cut"])
@pytest.mark.parametrize("ending", [".nbi", ".nbc"])
def test_damaged_files_are_compiled_again(ending: str, damage: Callable[[bytes], bytes], folder: Path) -> None:
    assert called(folder) == [21.0, 1]
    (path,) = (folder / "cache").rglob(f"*{ending}")
    path.write_bytes(damage(path.read_bytes()))
    assert called(folder) == [21.0, 1]
    assert called(folder) == [21.0, 0]


@pytest.mark.slow
def test_a_file_of_other_types_under_the_same_name_is_not_taken(folder: Path) -> None:
    """Two processes that compile for two types at once may choose one name."""
    assert called(folder, "10.0", "10") == [21.0, 21.0, 2]
    one, other = sorted((folder / "cache").rglob("*.nbc"))
    one.write_bytes(other.read_bytes())
    assert called(folder, "10.0", "10", "7.0", "7") == [21.0, 21.0, 15.0, 15.0, 1]


@pytest.mark.slow
def test_processes_at_once_and_a_folder_that_cannot_be_written(folder: Path) -> None:
    runs = [start(folder, x) for x in ("10.0", "10", "10.0", "10")]
    assert [float(run.communicate()[0].split()[0]) for run in runs] == [21.0] * 4
    assert called(folder, "10.0", "10")[:2] == [21.0, 21.0]
    (folder / "file").touch()
    assert called(folder, NUMBA_CACHE_DIR=str(folder / "file")) == [21.0, 1]


@pytest.mark.slow
def test_folders_unused_for_a_month_go(folder: Path) -> None:
    for name, age in (("last_week", 7), ("last_year", 365)):
        (folder / "home" / "dincl-testbed" / name).mkdir(parents=True)
        then = (folder / "called").stat().st_mtime - 24 * 3600 * age
        os.utime(folder / "home" / "dincl-testbed" / name, (then, then))
    assert called(folder, NUMBA_CACHE_DIR="", XDG_CACHE_HOME=str(folder / "home")) == [21.0, 1]
    names = {path.name for path in (folder / "home" / "dincl-testbed").iterdir()}
    assert "last_week" in names
    assert "last_year" not in names
    assert len(names) == 2
    assert not list((folder / "called").rglob("*.nb?"))
