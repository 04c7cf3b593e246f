"""A state on disk has the bits of the one in memory; a file that is damaged, or is none, is refused with a message."""

import io
import os
import tomllib
import tracemalloc
import zipfile

import numpy as np
import pytest

from dincl.errors import InvalidProblem
from tests.full_disk import full_disk
from tests.tissue.bits import arrays, same
from tissue.files.parameters import preset
from tissue.frames.frame import Frame
from tissue.runs.simulate import simulate

pytestmark = pytest.mark.filterwarnings("ignore:.* never begins")
UNREADABLE = r"must be a file that Frame\.save wrote"
SMALL = {
    "tissue.cells": 5,
    "tissue.width": "15 um",
    "numerics.t_end": "0.1 h",
    "emt.cells": 2,
    "emt.p": "1 h",
    "emt.b": "1 h",
}


@pytest.fixture(scope="module")
def frame():
    return simulate(preset("thesis").changed(SMALL), 2**100).final


@pytest.fixture
def file(frame, tmp_path):
    frame.save(tmp_path / "state")
    return tmp_path / "state"


def changed(file, **changes):
    """The file with other arrays; those that are None are left out."""
    with np.load(file) as held:
        found = {name: held[name] for name in held.files} | changes
    with file.open("wb") as opened:
        np.savez(opened, **{name: array for name, array in found.items() if array is not None})
    return file


def test_the_same_bits(frame, file):
    again = Frame.load(file)
    assert same(again, frame)
    assert all(a.dtype == b.dtype for a, b in zip(arrays(again), arrays(frame), strict=True))


def test_the_same_bytes_for_the_same_state(frame, file, tmp_path):
    Frame.load(file).save(tmp_path / "again")
    assert (tmp_path / "again").read_bytes() == file.read_bytes()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"version": "tissue frame 6"}, "its version is 'tissue frame 6', here it is 'tissue frame 7, a b s p ac'"),
        ({"cells.x": None}, r"cells\.x is missing"),
        ({"more": np.zeros(2)}, "more is unknown"),
        ({"cells.y": np.zeros(4)}, r"the shape \(4,\) of cells\.y is not possible"),
        ({"cells.id": np.zeros(5)}, r"cells\.id is of kind float64"),
        ({"cells.id": np.zeros(5, np.int64)}, r"cells\.id is not possible"),
        ({"cells.rest_ax": np.full(5, np.nan)}, r"cells\.rest_ax, which is not finite"),
        ({"cells.emt": np.array([-1, 7, -1, -1, -1])}, r"cells\.emt"),
        ({"layers.basal": np.array([0, 9])}, r"layers\.basal is not possible"),
        ({"checkpoint.emt.at": np.full((5, 2), np.nan)}, r"emt\.at is not possible"),
        ({"checkpoint.seed": np.array(b"four")}, "invalid literal for int"),
        ({"checkpoint.generators": np.zeros(3, np.uint64)}, r"the shape \(3,\) of generators"),
        ({"t": np.float64(-1.0)}, "t is not possible"),
    ],
)
def test_contents_that_no_run_has_made(file, changes, message):
    with pytest.raises(InvalidProblem, match=message):
        Frame.load(changed(file, **changes))


def test_parameters_are_in_the_file_and_no_module_of_theirs_is_imported(frame, file, tmp_path):
    assert tomllib.loads(Frame.load(file).past.parameters) == preset("thesis").changed(SMALL).as_dict()
    module = tmp_path / "never_imported.py"
    text = frame.past.parameters.replace("modules = []", f'modules = ["{module}"]')
    assert str(module) in text
    module.write_text("1 / 0")
    assert Frame.load(changed(file, **{"checkpoint.parameters": np.array(text.encode())})).past.types == ()


def test_files_that_are_no_states(tmp_path):
    objects = io.BytesIO()
    np.save(objects, np.array([{}]), allow_pickle=True)
    archive = io.BytesIO()
    np.savez(archive, format=np.array([{}]))
    for content in (b"", b"text", objects.getvalue(), archive.getvalue()):
        (tmp_path / "other").write_bytes(content)
        with pytest.raises(InvalidProblem, match=rf"other: {UNREADABLE}") as caught:
            Frame.load(tmp_path / "other")
        assert "pickle" not in str(caught.value)
    with pytest.raises(InvalidProblem, match=rf"missing: {UNREADABLE}"):
        Frame.load(tmp_path / "missing")


def header(shape, kind="<f8"):
    """The beginning of an array in a file."""
    stream = io.BytesIO()
    np.lib.format.write_array_header_1_0(stream, {"descr": kind, "fortran_order": False, "shape": shape})
    return stream.getvalue()


def archive_of(path, method, **members):
    """A file of these members, each (beginning, zeros behind it)."""
    with zipfile.ZipFile(path, "w", method) as archive:
        for name, (begin, zeros) in members.items():
            with archive.open(f"{name}.npy", "w") as member:
                member.write(begin)
                for _ in range(zeros >> 20):
                    member.write(bytes(1 << 20))
    return path


@pytest.mark.parametrize("name", ["version", "cells.x", "no_name_of_ours"])
def test_a_file_takes_no_more_memory_than_it_has_bytes(name, tmp_path):
    """64 MB of zeros in 64 kB; and arrays that say that they are larger than the file."""
    tracemalloc.start()
    squeezed = archive_of(tmp_path / "a", zipfile.ZIP_DEFLATED, **{name: (header((1 << 23,)), 1 << 26)})
    for shape, why in (((1 << 40,), "states"), ((1 << 20, 1 << 20, 1 << 20), "states"), ((0,), "states")):
        stated = archive_of(tmp_path / "b", zipfile.ZIP_STORED, **{name: (header(shape), 1 << 20)})
        with pytest.raises(InvalidProblem, match=rf"{UNREADABLE}.* {why} "):
            Frame.load(stated)
    tracemalloc.reset_peak()
    with pytest.raises(InvalidProblem, match=rf"{UNREADABLE}.* is compressed"):
        Frame.load(squeezed)
    assert tracemalloc.get_traced_memory()[1] < 8e6
    tracemalloc.stop()


def test_members_that_share_their_bytes(file, tmp_path):
    """Many names of an archive may lead to the same bytes."""
    raw = archive_of(tmp_path / "one", zipfile.ZIP_STORED, a=(header((1 << 17,)), 1 << 20)).read_bytes()
    end = raw.index(b"PK\x05\x06")
    begin = raw.index(b"PK\x01\x02")
    entry, names = raw[begin:end], 40
    tail = bytearray(raw[end:])
    tail[8:10] = tail[10:12] = names.to_bytes(2, "little")
    tail[12:16] = (names * len(entry)).to_bytes(4, "little")
    (tmp_path / "many").write_bytes(raw[:begin] + names * entry + tail)
    with pytest.raises(InvalidProblem, match=UNREADABLE):
        Frame.load(tmp_path / "many")


@pytest.mark.parametrize("seed", range(12))
def test_made_up_files_are_refused_and_take_no_memory(file, seed, tmp_path):
    """Names, kinds, shapes and methods of members drawn at random, one or several at once."""
    rng = np.random.default_rng(seed)
    with np.load(file) as held:
        found = {name: held[name] for name in held.files}
    with zipfile.ZipFile(tmp_path / "made", "w") as archive:
        for name, array in found.items():
            stream = io.BytesIO()
            np.save(stream, array)
            data = stream.getvalue()
            if rng.random() < 0.2:
                kind = rng.choice(["<f8", "<i8", "|b1", "<U9", "<c16", "|O", "<f4"])
                shape = tuple(int(2 ** rng.uniform(0, 30)) for _ in range(rng.integers(1, 3)))
                data = header(shape, str(kind)) + data[128:]
            method = zipfile.ZIP_DEFLATED if rng.random() < 0.1 else zipfile.ZIP_STORED
            archive.writestr(f"{name if rng.random() < 0.95 else name[::-1]}.npy", data, method)
    tracemalloc.start()
    with pytest.raises(InvalidProblem, match="must be a"):
        Frame.load(tmp_path / "made")
    assert tracemalloc.get_traced_memory()[1] < 4e6
    tracemalloc.stop()


def test_a_pipe_is_no_state(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "loop").symlink_to("loop")
    for name in ("pipe", "loop", "."):
        with pytest.raises(InvalidProblem, match=UNREADABLE):
            Frame.load(tmp_path / name)


def test_a_state_that_could_not_be_written_leaves_the_one_before(frame, tmp_path):
    path = tmp_path / "final.npz"
    frame.save(path)
    before = path.read_bytes()
    with full_disk(100), pytest.raises(InvalidProblem, match=r"final\.npz: cannot be written"):
        frame.save(path)
    assert path.read_bytes() == before
    assert [one.name for one in tmp_path.iterdir()] == ["final.npz"]
