"""Kernels are compiled again if code or constants that they can reach have changed.

Each case runs in processes of its own, on a package of a user whose kernel calls one of another file.
"""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from llvmlite.binding import get_host_cpu_features

from dincl.compiled.cache import FEATURES, PROCESSORS

FILES = {
    "__init__": "",
    "caller": '"""Calls."""\nfrom called.inner import factor\nfrom called.more.constants import SHIFT\n'
    "from dincl.compiled import kernel\n\n\n@kernel\ndef scaled(x):\n    return factor() * x + SHIFT\n",
    "inner": "from dincl.compiled import inner\n\n\n@inner\ndef factor():\n    return 2.0\n",
    "more/__init__": "",
    "more/constants": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from called.other import X\n"
    "try:\n    from ..shift import SHIFT\nexcept ImportError:\n    SHIFT = 0.0\n",
    "shift": "import os\nSHIFT = float(os.environ.get('SHIFT', '1.0'))\n",
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


def start(folder: Path, *values: str, program: str = PROGRAM, **env: str) -> subprocess.Popen[str]:
    paths = os.pathsep.join([str(folder), *sys.path])
    env = os.environ | {"PYTHONPATH": paths, "NUMBA_CACHE_DIR": str(folder / "cache")} | env
    command = [sys.executable, "-c", program, *values]
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
    copy = folder / "elsewhere"
    shutil.copytree(folder / "called", copy / "called", copy_function=shutil.copyfile)
    # Errors of functions of a user name their file: a copy has machine code of its own, unlike one of these packages.
    assert called(copy, NUMBA_CACHE_DIR=str(folder / "cache")) == [21.0, 1]
    change(folder, "inner", "2.0", "3.0")
    assert called(folder) == [31.0, 1]
    assert called(folder, SHIFT="2.0") == [32.0, 1]
    change(folder, "shift", "1.0", "5.0")
    assert called(folder) == [35.0, 1]
    change(folder, "caller", "* x", "* -x")
    assert called(folder) == [-25.0, 1]
    assert called(folder) == [-25.0, 0]


@pytest.mark.slow
@pytest.mark.parametrize(
    "damage",
    [lambda data: b"", lambda data: data[: len(data) // 2], lambda data: data[:-999] + b"\0" + data[-998:]],
    ids=["empty", "cut", "one byte"],
)
def test_damaged_files_are_compiled_again(damage: Callable[[bytes], bytes], folder: Path) -> None:
    assert called(folder) == [21.0, 1]
    (path,) = (folder / "cache").rglob("*.code")
    path.write_bytes(damage(path.read_bytes()))
    assert called(folder) == [21.0, 1]
    assert called(folder) == [21.0, 0]


@pytest.mark.slow
def test_a_file_of_other_types_under_the_same_name_is_not_taken(folder: Path) -> None:
    assert called(folder, "10.0", "10") == [21.0, 21.0, 2]
    one, other = sorted((folder / "cache").rglob("*.code"))
    one.write_bytes(other.read_bytes())
    assert called(folder, "10.0", "10", "7.0", "7") == [21.0, 21.0, 15.0, 15.0, 1]


@pytest.mark.slow
def test_of_processes_that_start_at_once_one_compiles_and_a_folder_need_not_be_writable(folder: Path) -> None:
    runs = [start(folder, x) for x in ("10.0", "10", "10.0", "10")]
    found = [[float(number) for number in run.communicate()[0].split()] for run in runs]
    assert [value for value, _ in found] == [21.0] * 4
    assert sum(compiled for _, compiled in found) == 2
    (folder / "file").touch()
    assert called(folder, NUMBA_CACHE_DIR=str(folder / "file")) == [21.0, 1]


@pytest.mark.slow
def test_a_kernel_that_is_not_compiled_holds_up_nobody(folder: Path) -> None:
    """The system frees the lock of a process that ends; this one goes on."""
    free = """
import fcntl, os, pathlib
from called.caller import scaled
try:
    scaled("text")
except Exception as error:
    (path,) = pathlib.Path(os.environ["NUMBA_CACHE_DIR"]).rglob("*.lock")
    fcntl.flock(path.open(), fcntl.LOCK_EX | fcntl.LOCK_NB)
    print(0)
"""
    assert called(folder, program=free) == [0]


@pytest.mark.slow
def test_a_processor_takes_the_code_that_a_wheel_brings_unless_it_lacks_what_the_code_needs(folder: Path) -> None:
    """As ``make dist`` makes it."""
    made = {"NUMBA_CPU_NAME": PROCESSORS[0], "NUMBA_CPU_FEATURES": PROCESSORS[1]}
    assert called(folder, NUMBA_CACHE_DIR=str(folder / "shipped"), **made) == [21.0, 1]
    shipped = f"import dincl.compiled.cache as of\nof.SHIPPED = of.Path({str(folder / 'shipped')!r})\n"
    expected = 0 if all(get_host_cpu_features().get(name) for name in FEATURES) else 1
    assert called(folder, program=shipped + PROGRAM) == [21.0, expected]
    # Nothing can be written beneath a file.
    assert called(folder, program=shipped + PROGRAM, NUMBA_CACHE_DIR=str(folder / "called" / "shift.py")) == [
        21.0,
        expected,
    ]
    lacking = shipped + "of.FEATURES = ('none such',)\n"
    assert called(folder, program=lacking + PROGRAM) == [21.0, 1]


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


@pytest.mark.slow
def test_two_functions_of_one_name_that_two_processes_compiled_stay_apart(folder: Path) -> None:
    """They are long enough to be called, not inlined."""
    many = "\n".join(f"            x = np.sin(step(x) + {k}.0) / (1.0 + np.exp(x))" for k in range(40))
    text = (
        "import numpy as np\nfrom dincl.compiled import inner, kernel\n\n\n"
        f"def repeated(step):\n    @inner\n    def run(x, n):\n        for _ in range(n):\n{many}\n        return x\n\n"
        "    return run\n\n\n@inner\ndef grow(x):\n    return x + 1.0\n\n\n"
        "@inner\ndef fall(x):\n    return x - 2.0\n\n\n"
        "growing, falling = repeated(grow), repeated(fall)\n\n\n"
        "@kernel\ndef up(x):\n    return growing(x, 2) + growing(x, 3)\n\n\n"
        "@kernel\ndef down(x):\n    return falling(x, 2) + falling(x, 3)\n"
    )
    (folder / "called" / "twice.py").write_text(text)
    both = "from called.twice import up, down\nprint(*({}))"
    results = []
    for names in ("up(0.1),", "down(0.1),", "up(0.1), down(0.1)"):
        out, problems = start(folder, program=both.format(names)).communicate()
        assert out, problems
        results.append(out.split())
    assert results[2] == results[0] + results[1]


@pytest.mark.slow
def test_functions_that_one_function_makes_of_others_have_machine_code_of_their_own(folder: Path) -> None:
    """They differ by what they call, by code alone, and by a default that is computed."""
    text = (
        "from dincl.compiled import inner, kernel\n\n\n"
        "@inner\ndef grow(x):\n    return x + 1.0\n\n\n@inner\ndef fall(x):\n    return x - 2.0\n\n\n"
        "def calling(step):\n    @kernel\n    def run(x):\n        return step(x)\n\n    return run\n\n\n"
        "def adding(more):\n    def add(x, y=more):\n        return x + y\n\n    return inner(add)\n\n\n"
        "steps = grow, fall, inner(lambda x: 2.0 * x), inner(lambda x: 3.0 * x), adding(4.0), adding(5.0)\n"
    )
    (folder / "called" / "made.py").write_text(text)
    program = "from called.made import *\nprint(*(calling(step)(10.0) for step in steps))"
    for _ in range(2):
        assert called(folder, program=program) == [11.0, 8.0, 20.0, 30.0, 14.0, 15.0]


@pytest.mark.slow
def test_modules_may_import_each_other(folder: Path) -> None:
    one = "import called.{}\nfrom dincl.compiled import inner\n\n\n@inner\ndef double(x):\n    return 2.0 * x\n"
    for name, other in (("east", "west"), ("west", "east")):
        (folder / "called" / f"{name}.py").write_text(one.format(other))
    text = "import called.east\nimport called.west\nfrom dincl.compiled import kernel\n\n\n"
    text += "@kernel\ndef both(x):\n    return called.east.double(x) + called.west.double(x)\n"
    (folder / "called" / "both.py").write_text(text)
    assert called(folder, program="from called.both import both\nprint(both(10.0))") == [40.0]
