"""Functions of users are compiled again if code that they can reach has changed, in whichever file, and only then."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

CALLER = '''"""Calls."""
from dincl.compiled import kernel
from called.inner import factor
from called.constants import SHIFT


@kernel
def scaled(x: float) -> float:
    """Doc."""
    return factor() * x + SHIFT
'''
INNER = "from dincl.compiled import kernel\n\n\n@kernel\ndef factor() -> float:\n    return 2.0\n"
KINDS = """
from typing import NamedTuple


class Pair(NamedTuple):
    x: float


def made(x: float) -> Pair:
    return Pair(x)
"""
TAKES_A_PAIR = """
from dincl.compiled import kernel
from called.kinds import made


@kernel
def first(pair):
    return pair.x


def scaled(x):
    return first(made(x))


scaled.stats = first.stats
"""
PROGRAM = """
from called.caller import scaled
value = scaled(10.0)
print(value, sum(scaled.stats.cache_misses.values()))
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A package with a kernel that calls one of another file."""
    package = tmp_path / "called"
    package.mkdir()
    texts = {"__init__": "", "caller": CALLER, "inner": INNER, "constants": "SHIFT = 1.0\n", "other": "X = 1\n"}
    for name, text in texts.items():
        (package / f"{name}.py").write_text(text)
    return tmp_path


def called(folder: Path) -> tuple[float, int]:
    """The value in a new process, and how often the kernel was compiled for it."""
    env = os.environ | {"PYTHONPATH": os.pathsep.join([str(folder), *sys.path]), "PYTHONDONTWRITEBYTECODE": "1"}
    run = subprocess.run([sys.executable, "-c", PROGRAM], env=env, capture_output=True, text=True, check=True)
    value, compiled = run.stdout.split()
    return float(value), int(compiled)


def replace(folder: Path, name: str, old: str, new: str) -> None:
    """Change the text of a file."""
    path = folder / "called" / f"{name}.py"
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))


@pytest.mark.slow
def test_change_of_what_a_kernel_calls_gives_the_new_result(folder: Path) -> None:
    assert called(folder) == (21.0, 1)
    assert called(folder) == (21.0, 0)
    replace(folder, "inner", "2.0", "3.0")
    assert called(folder) == (31.0, 1)
    replace(folder, "constants", "1.0", "5.0")
    assert called(folder) == (35.0, 1)
    assert called(folder) == (35.0, 0)


@pytest.mark.slow
def test_nothing_else_is_compiled_again(folder: Path) -> None:
    assert called(folder) == (21.0, 1)
    replace(folder, "caller", '"""Doc."""', '"""Another text\n\n    of more lines.\n    """')
    replace(folder, "caller", '"""Calls."""', '"""Calls.\n\nAnd so on."""\n# remark')
    replace(folder, "other", "1", "2")
    os.utime(folder / "called" / "inner.py", (2e9, 2e9))
    assert called(folder) == (21.0, 0)


@pytest.mark.slow
def test_functions_of_one_name_are_told_apart(folder: Path) -> None:
    text = "@kernel\ndef same() -> float:\n    return {}\n\n\nfirst = same()\n"
    both = "from dincl.compiled import kernel\n\n\n" + text.format(1.0) + text.format(2.0).replace("first", "second")
    (folder / "called" / "caller.py").write_text(both + "def scaled(x):\n    return first + 10 * second\n")
    program = "from called.caller import scaled; print(scaled(0))"
    env = os.environ | {"PYTHONPATH": os.pathsep.join([str(folder), *sys.path])}
    for _ in range(2):
        run = subprocess.run([sys.executable, "-c", program], env=env, capture_output=True, text=True, check=True)
        assert float(run.stdout) == 21.0


@pytest.mark.slow
def test_cached_code_of_a_type_that_was_renamed_is_not_read(folder: Path) -> None:
    """The files of numba hold the types of arguments, which it cannot make of a class that was renamed.

    What was made of the old code is written over.
    """
    (folder / "called" / "kinds.py").write_text(KINDS)
    (folder / "called" / "caller.py").write_text(TAKES_A_PAIR)
    assert called(folder) == (10.0, 1)
    replace(folder, "kinds", "Pair", "Renamed")
    assert called(folder) == (10.0, 1)
    assert len(list(folder.rglob("*.nb*"))) == 2
