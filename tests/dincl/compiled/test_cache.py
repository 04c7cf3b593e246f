"""Damaged machine code in the cache is compiled again, whichever file and however; tried in a process of its own."""

import errno
import os
import subprocess
import sys
import time
from pathlib import Path

import numba
import pytest

from dincl.compiled import cache
from dincl.compiled.cache import CheckedFiles, CodeCache
from dincl.compiled.folders import stamp
from dincl.neighbours.grid import sort_by_cell

PLAIN = "def scaled(x):\n    return 2 * x + 1\n\n\ndef called(x):\n    return 3.0 * x + 1.0\n"
PROGRAM = """
import random
from pathlib import Path
from numba import types
from called.plain import called, scaled
from dincl.compiled import c_function, kernel

def run():
    # As another process would: nothing is known but the files.
    made = kernel(scaled)
    values = made(10.0), made(10)
    address = c_function(types.double(types.double), called)
    misses = sum(made.stats.cache_misses.values())
    return [*map(repr, values), repr(address.ctypes(2.0))], misses, address.cache_hits

def flipped(data):
    bit, data = rng.randrange(8 * len(data)), bytearray(data)
    data[bit // 8] ^= 1 << bit % 8
    return bytes(data)

rng, right = random.Random(5), ["21.0", "21", "7.0"]
ways = [lambda _: b"", lambda data: data[: len(data) // 2], lambda data: data + b"0", *[flipped] * 5]
assert run() == (right, 2, 0)
assert run() == (right, 0, 1)
files = [path for path in Path(folder).rglob("*") if path.suffix in (".nbi", ".nbc")]
assert len(files) == 2 + 3, files
again = 0
for path in files:
    whole = path.read_bytes()
    for way in ways:
        path.write_bytes(way(whole))
        values, misses, hits = run()
        assert values == right, (path, values)
        assert misses + 1 - hits > 0, path
        assert run() == (right, 0, 1), path
        again += 1
# Files under the name of another one: of the index, of other code.
for path in files:
    whole = path.read_bytes()
    for other in files:
        if other != path:
            path.write_bytes(other.read_bytes())
            values, misses, hits = run()
            assert values == right, (path, other, values)
            assert run() == (right, 0, 1), (path, other)
    path.write_bytes(whole)
# Two processes that chose one name at once.
one, two = (path for path in files if path.suffix == ".nbc" and "scaled" in path.name)
one.write_bytes(two.read_bytes())
values, misses, hits = run()
assert (values, misses, hits) == (right, 1, 1)
print(again)
"""


@pytest.mark.slow
def test_damaged_machine_code_is_made_again(tmp_path: Path) -> None:
    (tmp_path / "called").mkdir()
    (tmp_path / "called" / "plain.py").write_text(PLAIN)
    (tmp_path / "called" / "__init__.py").touch()
    program = f"folder = {str(tmp_path / 'called')!r}\n{PROGRAM}"
    env = os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])}
    env.pop("NUMBA_CACHE_DIR", None)
    run = subprocess.run([sys.executable, "-c", program], env=env, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert run.stdout.split() == ["40"]


def files(folder: Path, stamp: str = "of this code") -> CheckedFiles:
    return CheckedFiles(str(folder), "function", stamp)


def test_saved_code_is_loaded(tmp_path: Path) -> None:
    files(tmp_path).save("double", [1])
    files(tmp_path).save("int", [2])
    files(tmp_path).save("int", [3])
    assert [files(tmp_path).load(key) for key in ("double", "int", "other")] == [[1], [3], None]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["function.1.nbc", "function.2.nbc", "function.nbi"]
    assert files(tmp_path, "of other code").load("double") is None
    files(tmp_path).flush()
    assert files(tmp_path).load("double") is None


def test_a_file_under_another_name_is_not_read(tmp_path: Path) -> None:
    files(tmp_path).save("double", [1])
    files(tmp_path).save("int", [2])
    names = ("function.nbi", "function.1.nbc", "function.2.nbc")
    whole = {name: (tmp_path / name).read_bytes() for name in names}
    for name in names:
        for other in names:
            (tmp_path / name).write_bytes(whole[other])
            found = [files(tmp_path).load("double"), files(tmp_path).load("int")]
            assert all(one in (None, right) for one, right in zip(found, ([1], [2]), strict=True))
            assert (found == [[1], [2]]) == (name == other)
        (tmp_path / name).write_bytes(whole[name])


def test_of_another_version_of_numba_nothing_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    files(tmp_path).save("double", [1])
    monkeypatch.setattr("numba.__version__", "0.1")
    assert files(tmp_path).load("double") is None


def test_a_full_disk_costs_no_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    files(tmp_path).save("double", [1])

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr("os.replace", full)
        files(tmp_path).save("int", [2])
    assert [files(tmp_path).load(key) for key in ("double", "int")] == [[1], None]
    assert not list(tmp_path.glob("*.tmp.*"))


def test_clones_share_the_machine_code_of_our_functions_for_a_month(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    cache._shared_folder.cache_clear()
    root = tmp_path / "dincl-testbed"
    for name, age in (("last week", 7), ("last year", 365)):
        (root / name).mkdir(parents=True)
        os.utime(root / name, (then := time.time() - 24 * 3600 * age, then))
    function = sort_by_cell.py_func
    ours = CodeCache(function)
    assert Path(str(ours.cache_path)) == root / stamp(function) / "dincl.neighbours.grid"
    assert {path.name for path in root.iterdir()} == {"last week", stamp(function)}
    place, chosen = Path(str(CodeCache(files).cache_path)), numba.config.CACHE_DIR  # as it was at the import of numba
    assert place.parent == Path(chosen) if chosen else place == Path(__file__).parent / "__pycache__"
    cache._shared_folder.cache_clear()
