"""How EMT cells and cells of named types look."""

import pytest
from matplotlib.colors import to_hex

from tests.tissue.states import layers
from tests.tissue.stills import THESIS, trio
from tissue.events.known import EVENTS
from tissue.files.cell_types import MOST_TYPES
from tissue.frames.observables import PHASES
from tissue.pictures.emt import EMT_COLOURS, OTHER_COLOURS, look_of
from tissue.pictures.picture import picture
from tissue.pictures.sheet import APICAL, BASAL, COLOURS, TYPE_COLOURS


@pytest.mark.parametrize("events", EMT_COLOURS)
def test_an_emt_cell_has_the_colour_of_its_events_and_a_dark_edge(figures, events):
    picture([trio(events)], THESIS, "x.png")
    soft, _, _, hard = figures[0].axes[0].collections
    wanted = [COLOURS["G1/S"], EMT_COLOURS[events], COLOURS["G1/S"]]
    assert [to_hex(colour) for colour in hard.get_facecolors()] == wanted
    assert [to_hex(colour) for colour in soft.get_facecolors()] == wanted
    assert [to_hex(colour) for colour in hard.get_edgecolors()] == ["#ffffff", "#000000", "#ffffff"]


def test_every_set_of_events_of_the_thesis_that_can_be_has_a_colour_of_its_own():
    """And constricted cells, which may have lost their adhesions."""
    possible = {name for name in map(EVENTS.__getitem__, range(16)) if "P" not in name or "B" in name}
    assert set(EMT_COLOURS) == possible | {f"{lost}AC" for lost in ("", "A", "B", "AB")}
    assert len({*EMT_COLOURS.values(), *OTHER_COLOURS, *COLOURS.values()}) == (
        len(EMT_COLOURS) + len(OTHER_COLOURS) + len(PHASES)
    )


def test_other_sets_of_events_have_colours_of_their_own_too():
    others = [EVENTS[k] for k in range(16, 32) if EVENTS[k] not in EMT_COLOURS][: len(OTHER_COLOURS)]
    found = look_of([trio(name) for name in ("A", *others)]).colours
    assert found["A"] == EMT_COLOURS["A"]
    assert {found[name] for name in others} == set(OTHER_COLOURS)


def test_cells_that_constrict_together_are_joined(figures):
    frame = trio("AC")
    frame.cells.emt[:2], frame.cells.chain[:2], frame.cells.events[:2] = (0, 1), 1, EVENTS.index("AC")
    picture([frame._replace(layers=layers(3, apical=[2]))], THESIS, "x.png")
    *_, chain = figures[0].axes[0].collections
    assert [path.vertices.tolist() for path in chain.get_paths()] == [[[0.0, 40.0], [30.0, 40.0]]]
    names = [text.get_text() for text in figures[0].legends[1].get_texts()]
    assert names == ["EMT cell: [AC]", "free apical point", "joined apart from the layer"]


def test_a_long_legend_has_lines_within_the_picture(figures):
    picture([trio(name) for name in EMT_COLOURS], THESIS, "x.png")
    *_, last, middle, first = figures[0].legends
    assert [len(legend.get_texts()) for legend in (first, middle, last)] == [7, 7, 4]
    for legend in figures[0].legends:
        assert legend.get_window_extent().x1 < figures[0].bbox.x1
    assert first.get_window_extent().y0 > middle.get_window_extent().y1


@pytest.mark.parametrize(
    ("events", "apical", "basal"), [("", 0, 0), ("A", 1, 0), ("B", 0, 1), ("AB", 1, 1), ("S", 0, 0)]
)
def test_crosses_mark_the_points_that_left_their_layers(figures, events, apical, basal):
    picture([trio(events)], THESIS, "x.png")
    lines = figures[0].axes[0].lines
    crosses = [(line.get_color(), line.get_xydata().tolist()) for line in lines if line.get_marker() == "x"]
    assert crosses == [(APICAL, [[30.0, 40.0]])] * apical + [(BASAL, [[30.0, 0.0]])] * basal
    (dots,) = (line for line in lines if line.get_linestyle() == "None" and line.get_marker() == "o")
    assert len(dots.get_xydata()) == 3 - basal


def test_the_legend_names_the_events_that_are_there(figures):
    picture([trio("B"), trio(""), trio("BP")], THESIS, "x.png")
    control, emt = ([text.get_text() for text in legend.get_texts()] for legend in figures[0].legends)
    assert control == [*PHASES, "soft, hard disc", "springs", "apical layer", "basal layer"]
    assert emt == ["EMT cell: before any event", "[B]", "[BP]", "free basal point"]
    picture([trio("A")], THESIS, "x.png")
    names = [text.get_text() for text in figures[1].legends[1].get_texts()]
    assert names == ["EMT cell: [A]", "free apical point"]


def test_a_named_type_has_an_edge_of_its_own(figures):
    given = THESIS.changed({"types.soft.cells": 1, "types.hard.cells": 1, "types.hard.place": 0})
    frame = trio()
    frame.cells.kind[:] = [3, 1, 0]
    picture([frame], given, "x.png")
    hard = figures[0].axes[0].collections[3]
    assert [to_hex(colour) for colour in hard.get_edgecolors()] == [TYPE_COLOURS[1], "#000000", "#ffffff"]
    assert hard.get_linewidths()[0] > 2 * hard.get_linewidths()[1]
    entries = [text.get_text() for text in figures[0].legends[1].get_texts()]
    assert entries == ["EMT cell: [A]", "free apical point", "type hard"]
    assert len(TYPE_COLOURS) == MOST_TYPES
