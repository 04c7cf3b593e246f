"""Streams of pictures: the cells are those of the run, at more times; a failure is told, and who leaves ends it."""

import json

import numpy as np
import pytest

import tissue
from dincl.errors import InvalidProblem
from dincl.status import Status
from tests.verification.explore.small import SMALL
from tissue.events.known import EVENTS
from tissue.frames.observables import ab_positions, height
from tissue.pictures.emt import EMT_COLOURS
from verification.explore.common.streams import SIZES, told
from verification.explore.tissues import frames
from verification.explore.tissues.frames import finely_kept, stream

PARAMETERS = tissue.preset("thesis").changed(SMALL)
LENGTHS = ("x", "y", "ax", "ay", "bx", "by", "radius")


def parsed(pieces):
    """Headers with their payloads."""
    data, found = b"".join(pieces), []
    while data:
        head, load = SIZES.unpack_from(data)
        begin = SIZES.size + head
        found.append((json.loads(data[SIZES.size : begin]), data[begin : begin + load]))
        data = data[begin + load :]
    return found


def columns_of(header, payload):
    """The columns of a frame, and the members of the layer."""
    n = header["cells"]
    table = np.frombuffer(payload[: 4 * 13 * n], "<f4").reshape(13, n)
    rest = np.frombuffer(payload[4 * 13 * n :], "<i4")
    return table, table.view("<i4"), rest


@pytest.fixture(scope="module")
def film():
    return parsed(stream(PARAMETERS, 3))


@pytest.fixture(scope="module")
def run():
    return tissue.simulate(finely_kept(PARAMETERS), 3)


def test_the_cells_are_those_of_the_run(film, run):
    shown = [(header, payload) for header, payload in film if header["kind"] == "frame"]
    assert len(shown) == len(run.frames) > 30
    um = PARAMETERS.cell.soft_radius.value
    for (header, payload), frame in zip(shown, run.frames, strict=True):
        table, whole, rest = columns_of(header, payload)
        assert header["t"] == pytest.approx(frame.t, abs=1e-12)
        assert (whole[0] == frame.cells.id).all()
        for row, name in zip(table[1:8], LENGTHS, strict=True):
            assert row == pytest.approx(um * getattr(frame.cells, name), rel=1e-6, abs=1e-5)
        assert header["height"] == pytest.approx(um * height(frame), rel=1e-12)
        assert table[12] == pytest.approx(ab_positions(frame), abs=1e-5)
        assert (rest[: header["layer"]] == frame.layers.apical).all()


def test_looks_are_those_of_the_events_that_have_begun(film, run):
    looks = film[0][0]["looks"]
    assert all(one["colour"] == EMT_COLOURS[one["name"]] for one in looks)
    for (header, payload), frame in zip((one for one in film if one[0]["kind"] == "frame"), run.frames, strict=True):
        shown = columns_of(header, payload)[1][10]
        names = [looks[k]["name"] if k >= 0 else None for k in shown]
        assert names == [
            EVENTS[e] if k >= 0 else None for e, k in zip(frame.cells.events, frame.cells.emt, strict=True)
        ]


def test_the_end_says_how_it_went(film):
    assert film[-1][0] == {"kind": "end", "status": "SUCCESS", "detail": ""}
    assert film[0][0]["painter"] == "tissue"
    assert film[0][0]["end"] == 4.0


def test_a_run_that_fails_ends_with_its_status():
    wild = PARAMETERS.changed({"tissue.diffusion": "1e12 um^2/h"})
    run = tissue.simulate(finely_kept(wild), 0, throw=False)
    film = parsed(stream(wild, 0))
    assert film[-1][0]["status"] == run.status.name
    assert film[-1][0]["detail"] == run.detail
    assert run.status is not Status.SUCCESS


def test_who_leaves_ends_the_work(film):
    seen = []
    pieces = stream(PARAMETERS, 3, lambda: len(seen) >= 1)
    seen.extend(iter(lambda: next(pieces, b""), b""))
    shown = parsed(seen)
    assert shown[-1][0]["kind"] == "frame"
    assert len(shown) < len(film)


def test_who_leaves_ends_work_without_an_end():
    """There, an output time is 62,500 h after the other."""
    endless = PARAMETERS.changed({"numerics.t_end": "1e7 h", "numerics.keep": "1e7 h"})
    asked = iter([False] * 10 + [True])
    assert len(list(stream(endless, 0, lambda: next(asked)))) == 1  # the start


@pytest.mark.parametrize(
    "changes",
    [{"numerics.t_end": "48 h"}, {"numerics.keep": ["1 h", "2 h"]}, {"numerics.dt": "1 h", "numerics.substeps": 120}],
)
def test_pictures_are_kept_often_but_no_more_than_a_screen_shows(changes):
    fine = finely_kept(PARAMETERS.changed(changes))
    steps = fine.numerics.keep.value / fine.numerics.dt.value
    assert steps == pytest.approx(round(steps))
    assert 4 <= fine.t_end / fine.numerics.keep.value <= frames.MOST


@pytest.mark.parametrize("shape", ["circle", "ellipse"])
def test_a_curved_layer_is_drawn_where_it_is(shape):
    round_ = tissue.preset("thesis").changed(SMALL | {"layer.shape": shape, "layer.closed": False})
    head = parsed(stream(round_, 0))[0][0]
    points = np.array(head["layer"])
    lengths = np.hypot(*np.diff(points, axis=0).T)
    assert lengths.sum() == pytest.approx(300, rel=1e-3)
    assert head["closed"]
    assert head["inside"]
    assert parsed(stream(PARAMETERS, 0))[0][0]["layer"] == []


def test_what_cannot_begin_is_told():
    def refused():
        yield from ()
        raise InvalidProblem("no room")

    ((header, _),) = parsed(told(refused()))
    assert header == {"kind": "end", "status": "INVALID", "detail": "no room"}
