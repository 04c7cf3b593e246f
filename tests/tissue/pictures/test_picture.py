"""Pictures and movies: to scale, with the colours of the phases, one scale for all states, files as asked for."""

from itertools import pairwise

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.colors import to_rgb

from dincl.errors import InvalidProblem
from tests.tissue.space.in_space import of_surface
from tests.tissue.states import layers
from tests.tissue.stills import THESIS, UM, coloured, drawn, pair, trio, two_hours
from tissue.frames.observables import PHASES, height
from tissue.frames.section import section
from tissue.pictures import picture as drawing
from tissue.pictures.picture import picture, stills
from tissue.pictures.sheet import COLOURS
from tissue.runs.simulate import simulate


def luminance(colour):
    """Relative luminance of sRGB, from 0 to 1."""
    channels = np.array(to_rgb(colour))
    linear = np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
    return float(linear @ (0.2126, 0.7152, 0.0722))


@pytest.fixture(scope="module")
def run():
    return two_hours()


@pytest.mark.parametrize("radius", [1 / 3, 0.7])
def test_hard_discs_are_to_scale(radius):
    """From the distance of the two discs in pixels follows how large they must be."""
    rows, columns = coloured(drawn(pair(radius=radius)), COLOURS["mitosis"])
    right = columns > columns.mean()
    pixels = (columns[right].mean() - columns[~right].mean()) / 12.0  # of R_soft
    for side in (right, ~right):
        for places in (rows[side], columns[side]):
            assert np.ptp(places) + 1 == pytest.approx(2 * radius * pixels, abs=3)  # the white edge
        assert side.sum() > 0.8 * np.pi * (radius * pixels - 1.5) ** 2  # springs end in the centre, below the disc


def test_the_axes_say_where_things_are_in_um(figures):
    picture([pair()], THESIS, "x.png")
    (panel,) = figures[0].axes
    (left, right), (low, high) = panel.get_xlim(), panel.get_ylim()
    assert (left, right) == (UM * -1.0 - 2.0, UM * 13.0 + 2.0)
    assert (low, high) == (-2.0, UM * 8.0 + 2.0)
    place, (wide, tall) = panel.get_position(), figures[0].get_size_inches()
    assert place.width * wide / (right - left) == pytest.approx(place.height * tall / (high - low))
    assert place.x1 * wide == pytest.approx(9.2 - 0.12)  # the panel takes the whole width
    assert panel.get_xlabel() == "x [µm]"
    assert panel.get_ylabel() == "y [µm]"


def test_soft_discs_springs_and_layers_are_where_the_cells_are(figures, run):
    frame = run.final
    picture([frame], run.parameters, "x.png")
    (panel,) = figures[0].axes
    cells = frame.cells
    soft, edges, springs, hard = panel.collections
    nuclei = UM * np.column_stack((cells.x, cells.y))
    for discs in (soft, edges, hard):
        assert (np.array(discs.get_offsets()) == nuclei).all()
    assert (soft.get_widths() == 2 * UM).all()
    assert (edges.get_widths() == 2 * UM).all()
    assert hard.get_widths() == pytest.approx(2 * UM * cells.radius)
    for i, path in enumerate(springs.get_paths()):
        ends = [(cells.ax[i], cells.ay[i]), (cells.x[i], cells.y[i]), (cells.bx[i], cells.by[i])]
        assert path.vertices == pytest.approx(UM * np.array(ends))
    lines = [line.get_xydata() for line in panel.lines if len(line.get_xydata()) == len(cells.x)]
    assert lines[0] == pytest.approx(UM * np.column_stack((cells.ax, cells.ay)))
    assert lines[1] == pytest.approx(UM * np.column_stack((cells.bx, cells.by)))


def test_the_apical_layer_joins_the_cells_that_are_in_it(figures):
    frame = pair()
    picture([frame._replace(layers=layers(2, apical=[1]))], THESIS, "x.png")
    assert [len(line.get_xydata()) for line in figures[0].axes[0].lines] == [2, 1, 2]  # basal line, layer, basal points


@pytest.mark.parametrize("phase", PHASES)
def test_a_phase_has_its_colour(phase):
    still = drawn(pair(phase))
    rows, _ = coloured(still, COLOURS[phase])
    assert len(rows) > 300
    for other in set(PHASES) - {phase}:
        assert len(coloured(still, COLOURS[other])[0]) < 10


def test_colours_differ_in_lightness():
    """So that they are told apart without any colour: contrasts as those of screens."""
    shades = sorted(luminance(colour) + 0.05 for colour in COLOURS.values())
    assert all(lighter / darker > 1.8 for darker, lighter in pairwise(shades))


def test_the_legend_names_what_is_drawn(figures, run):
    picture([run.final], run.parameters, "x.png")
    names = [text.get_text() for text in figures[0].legends[0].get_texts()]
    assert names == [*PHASES, "soft, hard disc", "springs", "apical layer", "basal layer"]


def test_a_picture_is_no_wider_than_what_it_shows(figures):
    """Panels and their titles; entries of the legend that have no place in a line go to the next one."""
    frame = pair(distance=3.0)
    frame.cells.ay[:] = 16.0
    picture([frame], THESIS, "x.png")
    (panel,), wide = figures[0].axes, figures[0].get_size_inches()[0]
    assert wide == pytest.approx(0.7 + 3.2 + 0.12, abs=0.02)
    figures[0].draw_without_rendering()
    assert panel.texts[0].get_window_extent().x1 < wide * figures[0].dpi
    assert len(figures[0].legends) == 4
    assert all(one.get_window_extent().x1 < wide * figures[0].dpi for one in figures[0].legends)


def test_the_title_of_a_section_counts_all_cells(figures):
    run = simulate(of_surface("plane", numerics__t_end="0.1 h"), 1)
    picture([run.final], run.parameters, "x.png")
    title = figures[0].axes[0].texts[0].get_text()
    n, shown = len(run.final.cells.x), len(section(run.final).cells.x)
    assert 0 < shown < n
    assert f" · {shown} of {n} cells · " in title
    assert title.endswith(f"height {UM * height(run.final):.3g} µm")


def test_labels_of_the_axes_are_within_the_picture(figures):
    """Numbers have three digits and a sign where a tube hangs below the x axis."""
    frame = pair()
    frame.cells.by[0] = -40.0
    picture([frame], THESIS, "x.png")
    figures[0].draw_without_rendering()
    assert figures[0].axes[0].get_tightbbox().x0 > 0


def test_room_for_a_caption_is_left_below_the_legend(figures):
    plain, roomy = (drawing.drawing([trio()], THESIS, room=room) for room in (0.0, 0.5))
    assert roomy.get_size_inches()[1] == pytest.approx(plain.get_size_inches()[1] + 0.5)
    lows = [legend.get_window_extent().y0 / figure.dpi for figure in (plain, roomy) for legend in figure.legends]
    assert min(lows[2:]) == pytest.approx(min(lows[:2]) + 0.5)


@pytest.mark.parametrize(
    ("count", "rows", "columns"), [(1, 1, 1), (2, 1, 2), (3, 1, 3), (4, 2, 2), (5, 2, 3), (7, 3, 3)]
)
def test_several_states_have_one_scale(figures, run, count, rows, columns):
    frames = [run.frames[0], *[run.final] * (count - 1)]
    picture(frames, run.parameters, "x.png")
    panels = figures[0].axes
    assert len({(panel.get_xlim(), panel.get_ylim()) for panel in panels}) == 1
    places = [panel.get_position() for panel in panels]
    assert len({(round(place.width, 9), round(place.height, 9)) for place in places}) == 1
    assert len({round(place.y0, 9) for place in places}) == rows
    assert len({round(place.x0, 9) for place in places}) == columns
    assert all(place.x0 >= 0 and place.x1 <= 1 and place.y0 > 0 and place.y1 < 1 for place in places)


def test_titles_say_what_it_is(figures):
    picture([pair(t=1.5), pair(t=12.0)], THESIS, "x.png")
    titles = [panel.texts[0].get_text() for panel in figures[0].axes]
    assert titles == ["t = 1.5 h  ·  2 cells  ·  height 40 µm", "t = 12.0 h  ·  2 cells  ·  height 40 µm"]


@pytest.mark.slow_with("png", "pdf")
@pytest.mark.parametrize(("ending", "begins"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_the_ending_says_what_is_written_and_the_bytes_are_the_same_again(run, tmp_path, ending, begins):
    files = [tmp_path / f"{name}.{ending}" for name in ("one", "two")]
    for file in files:
        picture(run.frames[:1], run.parameters, file)
    assert files[0].read_bytes().startswith(begins)
    assert files[0].read_bytes() == files[1].read_bytes()
    assert b"CreationDate" not in files[0].read_bytes()
    assert b"dc:date" not in files[0].read_bytes()


def test_what_can_not_be_drawn_is_refused(tmp_path, run):
    with pytest.raises(InvalidProblem, match=r"x\.jpg.*must end in \.png, \.svg, \.pdf"):
        picture([pair()], THESIS, tmp_path / "x.jpg")
    with pytest.raises(InvalidProblem, match="frames is empty"):
        picture([], THESIS, tmp_path / "x.png")
    lost = pair(t=3.0)
    lost.cells.y[1] = np.nan
    with pytest.raises(InvalidProblem, match="t = 3 h: must have finite coordinates"):
        picture([pair(), lost], THESIS, tmp_path / "x.png")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_stills_have_one_size_and_leave_no_trace_of_the_last_one(run):
    together = list(stills(run.frames, run.parameters))
    assert {still.shape for still in together} == {together[0].shape}
    assert (together[0] != together[1]).any()
    again = list(stills((*run.frames[:-1], run.frames[0], run.final), run.parameters))
    assert (again[-2] == again[0]).all()
    assert (again[-1] == together[-1]).all()


def test_all_stills_are_in_one_scale():
    """The box is that of all states: the left cell is in one place, also where the right one is far."""
    near, far = stills([pair(distance=3.0), pair(distance=12.0)], THESIS)
    edges = [coloured(still, COLOURS["mitosis"])[1] for still in (near, far)]
    assert edges[0].min() == edges[1].min()
    assert edges[0].max() < edges[1].max() < far.shape[1] - 20


def test_stills_do_not_pile_up_in_the_panel(monkeypatch, run):
    panels, sheet = [], drawing._sheet

    def noted(*args):
        figure, found = sheet(*args)
        panels.extend((found[0], len(found[0].get_children())))
        return figure, found

    monkeypatch.setattr(drawing, "_sheet", noted)
    list(stills(run.frames, run.parameters))
    panel, children = panels
    assert len(panel.get_children()) == children


def test_the_style_of_others_is_left_alone(run):
    with mpl.rc_context({"font.size": 3.0, "axes.spines.top": True}):
        for _ in stills(run.frames[:2], run.parameters):
            assert mpl.rcParams["font.size"] == 3.0
            assert mpl.rcParams["axes.spines.top"]
