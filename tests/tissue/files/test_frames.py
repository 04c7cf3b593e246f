"""A state on disk has the bits of the one in memory; a file that is damaged, or is none, is refused with a message."""

import io

import numpy as np
import pytest

from dincl.errors import InvalidProblem
from tests.tissue.bits import arrays, same
from tests.tissue.space.in_space import of_surface
from tissue.files.parameters import preset
from tissue.frames.frame import Frame
from tissue.runs.simulate import simulate

pytestmark = pytest.mark.filterwarnings("ignore:.* never begins")
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


@pytest.mark.parametrize("surface", ["plane", "open"])
def test_the_same_bits_in_space(surface, tmp_path):
    """An open sheet has a ghost beyond its edge."""
    frame = simulate(of_surface(surface, numerics__t_end="0.1 h")).final
    frame.save(tmp_path / "state")
    assert (frame.sheets.apical.corner.min() < 0) == (surface == "open")
    assert same(Frame.load(tmp_path / "state"), frame)


def test_the_same_bytes_for_the_same_state(frame, file, tmp_path):
    Frame.load(file).save(tmp_path / "again")
    assert (tmp_path / "again").read_bytes() == file.read_bytes()


@pytest.mark.slow
def test_no_damage_goes_unseen(frame, file, tmp_path):
    """A bit is turned in every ninth byte, and the file cut off: refused, or it was in no number."""
    raw, bad = file.read_bytes(), tmp_path / "bad"
    damaged = [raw[:k] + bytes([raw[k] ^ 1 << k % 8]) + raw[k + 1 :] for k in range(0, len(raw), 9)]
    refused = 0
    for content in (*damaged, *(raw[:k] for k in range(0, len(raw), 211))):
        bad.write_bytes(content)
        try:
            unseen = same(Frame.load(bad), frame)
        except InvalidProblem:
            refused, unseen = refused + 1, True
        assert unseen
    assert refused > 0.5 * len(damaged)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"format": "tissue frame 7"}, 'its format is "tissue frame 7" in place of'),
        ({"cells.x": None}, r"its arrays differ in cells\.x"),
        ({"more": np.zeros(2)}, "its arrays differ in more"),
        ({"cells.y": np.zeros(4)}, r"cells\.y is of kind float64 and shape \(4,\)"),
        ({"cells.id": np.zeros(5)}, r"cells\.id is of kind float64"),
        ({"cells.id": np.zeros(5, np.int64)}, r"cells\.id = \[0 0 0 0 0\] is not possible"),
        ({"cells.rest_ax": np.full(5, np.nan)}, r"cells\.rest_ax is not finite"),
        ({"cells.emt": np.array([-1, 7, -1, -1, -1])}, r"cells\.emt"),
        ({"cells.events": np.full(5, 3)}, r"cells\.events"),
        ({"layers.basal": np.array([0, 9])}, r"layers\.basal = \[0 9\] is not possible"),
        ({"layers.apical": np.array([2, 1])}, r"layers\.apical"),
        ({"emt.at": np.full((5, 2), np.nan)}, r"emt\.at is not a number"),
        ({"events": "a, b"}, "its events are a, b, in place of those that are registered, a, b, s, p, ac"),
        ({"next_id": np.int64(3)}, "next_id = 3 is not possible"),
        ({"seed": "-4"}, 'seed = "-4"'),
        ({"t": np.float64(-1.0)}, "t = -1.0 is not possible"),
        ({"generators": np.zeros(3, np.uint64)}, "generators is of kind"),
    ],
)
def test_contents_that_no_run_has_made(file, changes, message):
    with pytest.raises(InvalidProblem, match=message):
        Frame.load(changed(file, **changes))


def test_files_that_are_no_states(tmp_path):
    objects = io.BytesIO()
    np.save(objects, np.array([{}]), allow_pickle=True)
    archive = io.BytesIO()
    np.savez(archive, format=np.array([{}]))
    for content in (b"", b"text", objects.getvalue(), archive.getvalue()):
        (tmp_path / "other").write_bytes(content)
        with pytest.raises(InvalidProblem, match=r"other: must be a readable file that Frame\.save wrote") as caught:
            Frame.load(tmp_path / "other")
        assert "pickle" not in str(caught.value)
    with pytest.raises(InvalidProblem, match=r"missing: must be a readable file"):
        Frame.load(tmp_path / "missing")


def test_a_place_where_nothing_can_be_written(frame, tmp_path):
    with pytest.raises(InvalidProblem, match="cannot be written"):
        frame.save(tmp_path / "no folder" / "state.npz")
