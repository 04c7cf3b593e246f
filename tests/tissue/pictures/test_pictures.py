"""Pictures, movies and views: to scale, with the colours of phases, events and types, in one scale for all states."""

import sys
from functools import cache

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.colors import to_hex, to_rgb
from PIL import Image

import tissue
from dincl.errors import InvalidProblem
from dincl.extras import MissingLibrary
from tests.optional import need_rendering
from tests.tissue.space.in_space import SURFACES, of_surface
from tests.tissue.states import layers
from tests.tissue.states import tissue as tissue_of
from tissue.events.known import EVENTS
from tissue.files.parameters import preset
from tissue.frames.frame import Frame
from tissue.frames.observables import PHASES, height
from tissue.frames.section import section
from tissue.pictures import movie as film
from tissue.pictures import space
from tissue.pictures.emt import EMT_COLOURS
from tissue.pictures.picture import drawing, stills
from tissue.pictures.sheet import APICAL, BASAL, COLOURS, write
from tissue.runs.simulate import simulate

THESIS = preset("thesis")
UM = 5.0
AGES = {"G1/S": 3.0, "G2": 14.2, "mitosis": 14.7}


def pair(phase="mitosis", distance=12.0, radius=0.7, t=0.0):
    """Two cells that stand upright, of one phase, this far apart."""
    x, a, b = ([[0.0, y], [distance, y]] for y in (4.0, 8.0, 0.0))
    state = tissue_of(x, a, b, radius=radius, birth=t - AGES[phase], cycle=15.0)
    return Frame(t, state, layers(2))


def drawn(frame):
    return next(iter(stills([frame], THESIS)))


def coloured(still, colour, tolerance=3):
    """Where the picture has this colour: rows and columns of the panel, without the legend below."""
    found = np.abs(still.astype(int) - np.round(255 * np.array(to_rgb(colour)))).max(axis=2) <= tolerance
    return np.nonzero(found[:-90])


@cache
def two_hours():
    """A run, a state every half hour."""
    return simulate(THESIS.changed({"numerics.t_end": "2 h", "numerics.keep": "0.5 h"}), 1)


def trio(events="A"):
    """Two control cells and one EMT cell with these events in the middle."""
    x, a, b = ([[0.0, y], [6.0, y], [12.0, y]] for y in (4.0, 8.0, 0.0))
    state = tissue_of(x, a, b, cycle=15.0, emt=[-1, 0, -1], events=[0, EVENTS.index(events), 0])
    kept = {"apical": [0, 2] if "A" in events else None, "basal": [0, 2] if "B" in events else None}
    return Frame(0.0, state, layers(3, **kept))


def names(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


@pytest.fixture(scope="module")
def run():
    return two_hours()


# A state


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


def test_soft_discs_springs_and_layers_are_where_the_cells_are(run):
    frame, cells = run.final, run.final.cells
    (panel,) = drawing(frame, run.parameters).axes
    soft, edges, springs, hard = panel.collections
    for discs in (soft, edges, hard):
        assert (np.array(discs.get_offsets()) == UM * np.column_stack((cells.x, cells.y))).all()
    assert (soft.get_widths() == 2 * UM).all()
    assert hard.get_widths() == pytest.approx(2 * UM * cells.radius)
    for i, path in enumerate(springs.get_paths()):
        ends = [(cells.ax[i], cells.ay[i]), (cells.x[i], cells.y[i]), (cells.bx[i], cells.by[i])]
        assert path.vertices == pytest.approx(UM * np.array(ends))
    lines = [line.get_xydata() for line in panel.lines if len(line.get_xydata()) == len(cells.x)]
    assert lines[0] == pytest.approx(UM * np.column_stack((cells.ax, cells.ay)))
    assert lines[1] == pytest.approx(UM * np.column_stack((cells.bx, cells.by)))
    one = drawing(pair()._replace(layers=layers(2, apical=[1])), THESIS).axes[0].lines
    assert [len(line.get_xydata()) for line in one] == [2, 1, 2, 0, 0]  # basal line, layer, basal points, crosses


@pytest.mark.parametrize("phase", PHASES)
def test_a_phase_has_its_colour(phase):
    still = drawn(pair(phase))
    assert len(coloured(still, COLOURS[phase])[0]) > 300
    assert all(len(coloured(still, COLOURS[other])[0]) < 10 for other in set(PHASES) - {phase})


@pytest.mark.parametrize("events", EMT_COLOURS)
def test_an_emt_cell_has_the_colour_of_its_events_a_dark_edge_and_crosses_at_free_points(events):
    (panel,) = drawing(trio(events), THESIS).axes
    soft, _, _, hard = panel.collections
    wanted = [COLOURS["G1/S"], EMT_COLOURS[events], COLOURS["G1/S"]]
    assert [to_hex(colour) for colour in hard.get_facecolors()] == wanted
    assert [to_hex(colour) for colour in soft.get_facecolors()] == wanted
    assert [to_hex(colour) for colour in hard.get_edgecolors()] == ["#ffffff", "#000000", "#ffffff"]
    crosses = [(line.get_color(), line.get_xydata().tolist()) for line in panel.lines if line.get_marker() == "x"]
    apical, basal = "A" in events, "B" in events
    assert [one for one in crosses if one[1]] == [(APICAL, [[30.0, 40.0]])] * apical + [(BASAL, [[30.0, 0.0]])] * basal


def test_titles_say_what_it_is():
    titles = [drawing(pair(t=t), THESIS).axes[0].texts[0].get_text() for t in (1.5, 12.0)]
    assert titles == ["t = 1.5 h · 2 cells · height 40 µm", "t = 12 h · 2 cells · height 40 µm"]
    sheet = tissue.simulate(of_surface("plane", numerics__t_end="0.1 h"), 1)
    n, shown = len(sheet.final.cells.x), len(section(sheet.final).cells.x)
    title = drawing(sheet.final, sheet.parameters).axes[0].texts[0].get_text()
    assert 0 < shown < n
    assert title == f"t = 0.1 h · {shown} of {n} cells · height {UM * height(sheet.final):.3g} µm"


@pytest.mark.slow_with("png", "pdf")
@pytest.mark.parametrize(("ending", "begins"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_the_ending_says_what_is_written_and_the_bytes_are_the_same_again(run, tmp_path, ending, begins):
    files = [tmp_path / f"{name}.{ending}" for name in ("one", "two")]
    for file in files:
        write(drawing(run.frames[0], run.parameters), file)
    assert files[0].read_bytes().startswith(begins)
    assert files[0].read_bytes() == files[1].read_bytes()


def test_what_can_not_be_drawn_is_refused():
    with pytest.raises(InvalidProblem, match="frames is empty"):
        list(stills([], THESIS))
    lost = pair(t=3.0)
    lost.cells.y[1] = np.nan
    with pytest.raises(InvalidProblem, match="t = 3 h: must have finite coordinates"):
        drawing(lost, THESIS)


# Movies


@pytest.mark.slow
def test_stills_have_one_size_and_leave_no_trace_of_the_last_one(run):
    with mpl.rc_context({"font.size": 3.0}):
        together = list(stills(run.frames, run.parameters))
        assert mpl.rcParams["font.size"] == 3.0  # the style of others
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


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["gif", "webp"])
def test_a_movie_shows_every_state_once(run, tmp_path, ending):
    path, seen = tmp_path / f"movie.{ending}", []
    film.movie(run.frames, run.parameters, path, seen.append)
    assert seen == [1, 2, 3, 4, 5]
    with Image.open(path) as movie:
        assert (movie.format, movie.n_frames, movie.info["loop"]) == (ending.upper(), 5, 0)  # for ever
        durations = []
        for k, still in enumerate(stills(run.frames, run.parameters)):
            movie.seek(k)
            movie.load()
            image = np.asarray(movie.convert("RGB")).astype(int)
            assert np.abs(image - still).mean() < 2.5
            assert (image[:20, -20:] == 255).all()  # the paper stays white
            durations.append(movie.info["duration"])
    assert durations == [80] * 4 + [2000]


@pytest.mark.parametrize(
    ("name", "frames", "message"),
    [
        ("x.mp4", [pair()], r"x\.mp4: must end in \.gif or \.webp"),
        ("x", [pair()], r"must end in"),
        ("x.gif", [], "frames is empty"),
    ],
)
def test_a_movie_that_can_not_be_made_leaves_no_file(tmp_path, name, frames, message):
    with pytest.raises(InvalidProblem, match=message):
        film.movie(frames, THESIS, tmp_path / name)
    assert list(tmp_path.iterdir()) == []


# Views in space


@pytest.fixture
def rendering():
    need_rendering()


renders = pytest.mark.usefixtures("rendering")


@pytest.fixture(scope="module")
def sheet():
    return tissue.simulate(of_surface("plane", numerics__t_end="0.2 h", numerics__keep="0.1 h"), 1)


@pytest.mark.slow
@renders
@pytest.mark.parametrize("name", SURFACES)
def test_each_surface_is_drawn_and_handed_to_vtk(name, tmp_path):
    parameters = of_surface(name, numerics__t_end="0.1 h", emt__cells=2, emt__b="0 h")
    run = tissue.simulate(parameters, 1)
    run.view(tmp_path / "one.png")
    image = np.asarray(Image.open(tmp_path / "one.png"))
    shown = (image[40:] < 250).any(axis=2)
    assert 0.05 < shown.mean() < 0.9
    edges = (shown[-5:], shown[:, :5], shown[:, -5:])  # the tissue is in the middle, with room around it
    assert not any(edge.any() for edge in edges)
    blocks, um, cells = run.final.to_vtk(), parameters.cell.soft_radius.value, run.final.cells
    assert blocks["nuclei"].n_points == len(cells.x)
    assert blocks["nuclei"]["radius"] == pytest.approx(um * cells.radius)
    assert blocks["nuclei"].points[:, 1] == pytest.approx(um * cells.y, rel=1e-6, abs=1e-5)
    for layer in ("apical", "basal"):
        assert blocks[layer].n_cells == len(getattr(run.final.sheets, layer).triangles)
    if name == "plane":  # triangles of a periodic layer cover it once
        surface = run.final.sheets.surface
        assert blocks["basal"].area == pytest.approx(um**2 * surface.period_x * surface.period_z, rel=1e-5)


@pytest.mark.slow
@renders
def test_the_same_state_has_the_same_dots_and_a_movie_all_states(sheet, tmp_path):
    cells = sheet.final.cells
    moved = sheet.final._replace(cells=cells._replace(y=np.where(cells.id == 3, cells.y + 1.5, cells.y)))
    for name, frame in (("one", sheet.final), ("again", sheet.final), ("other", moved)):
        space.view([frame], sheet.parameters, tmp_path / f"{name}.png")
    one, again, other = ((tmp_path / f"{name}.png").read_bytes() for name in ("one", "again", "other"))
    assert one == again != other
    for name, t, count in (("all.gif", None, 3), ("some.webp", 0.1, 2)):
        sheet.view(tmp_path / name, t=t)
        with Image.open(tmp_path / name) as movie:
            assert movie.n_frames == count


def test_views_that_are_refused(sheet, tmp_path, monkeypatch):
    with pytest.raises(InvalidProblem, match="must end in"):
        sheet.view(tmp_path / "one.svg")
    with pytest.raises(InvalidProblem, match="must be an output time"):
        sheet.view(tmp_path / "one.png", t=7.0)
    with pytest.raises(InvalidProblem, match="of a slice"):
        two_hours().view(tmp_path / "one.png")
    monkeypatch.setattr(space, "find_library", lambda name: None)
    with pytest.raises(InvalidProblem, match="needs EGL"):
        sheet.view(tmp_path / "one.png")
    monkeypatch.undo()
    monkeypatch.setitem(sys.modules, "pyvista", None)
    monkeypatch.setattr(space, "find_library", lambda name: "libEGL.so.1")
    monkeypatch.setattr("dincl.extras.find_spec", lambda name: None)
    with pytest.raises(MissingLibrary, match=r"needs pyvista.*\[views\]"):
        sheet.view(tmp_path / "one.png")
