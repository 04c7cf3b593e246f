"""What is measured of a tissue, by hand and against definitions computed another way; where it means nothing."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.path import Path
from typer.testing import CliRunner

import tissue
from dincl.errors import InvalidProblem
from dincl.status import Status
from tests.tissue.space.in_space import of_surface
from tests.tissue.states import HEIGHT, cells, layers
from tests.tissue.states import tissue as cells_at
from tissue.cli.app import app
from tissue.files.parameters import preset
from tissue.frames.frame import Frame
from tissue.frames.observables import (
    PHASES,
    ab_positions,
    extents,
    height,
    is_measurable,
    phases,
    positions,
    state_of,
)
from tissue.frames.section import section
from tissue.model.apical_tree import apical_tree
from tissue.model.energy import nearest_image
from tissue.model.measures import measure, measure_folds, measure_positions
from tissue.model.scale import nearest_on_junction, nearest_on_triangle
from tissue.report.page import write_page
from tissue.runs.tables import SUMMARY_COLUMNS
from tissue.state.basal_curve import LINE, ellipse
from tissue.study.answers import folded_remarks, scenario_means

PRESETS = ("thesis", "corrected", "published", "chick", "gastrulation", "cuboidal", "sheet")
FAST = {"tissue.two_daughters": 0.6, "cell.min_cycle": "6 h", "cell.max_cycle": "10 h", "numerics.t_end": "30 h"}
SHEET = {"tissue.dimension": 3, "tissue.cells": 196, "numerics.t_end": "2 h", "numerics.keep": "1 h"}


def layer(apical, nuclei=None, curve=LINE):
    """Cells with these apical points, the basal points below them."""
    apical = np.asarray(apical, float)
    nuclei = apical * (1.0, 0.5) if nuclei is None else np.asarray(nuclei, float)
    basal = np.column_stack((np.arange(len(apical)), np.zeros(len(apical))))
    return Frame(0.0, cells_at(nuclei, apical, basal), layers(len(apical)), curve)


def tangled(n, seed, ring=False):
    """A layer that goes up and down, back and forth."""
    rng = np.random.default_rng(seed)
    path = np.cumsum(rng.normal(0.3, 1.0, (n, 2)) * (1.0, 0.5), axis=0)
    path[:, 1] += 8.0
    curve = ellipse(100.0, 1.0, inside=True, ring=True) if ring else LINE
    return layer(path, rng.uniform(path.min(axis=0) - 2.0, path.max(axis=0) + 2.0, (n, 2)), curve)


@pytest.fixture(scope="module")
def sheet():
    return tissue.simulate(tissue.preset("published").changed(SHEET), 3)


def nearest_of_all(frame, some):
    """h at the point of the apical layer nearest to some nuclei, among all pieces and images, one after the other."""
    state, found = state_of(frame), []
    tree, periods = apical_tree(state), np.array([state.space.surface.period_x, np.inf, state.space.surface.period_z])
    shifts = [
        np.array(shift) * 1.0
        for shift in itertools.product(*(((0,) if math.isinf(p) else (-p, 0, p)) for p in periods))
    ]
    nearest = nearest_on_junction if tree.corners.shape[1] == 2 else nearest_on_triangle
    for at in np.column_stack((frame.cells.x, frame.cells.y, frame.cells.z))[some]:
        inside = np.where(np.isfinite(periods), at % periods, at)
        near = [
            nearest(tuple(inside + shift), *map(tuple, tree.points[k]))
            for k in np.argsort(tree.numbers)
            for shift in shifts
        ]
        found.append(min(near, key=lambda one: one[0])[1])
    return frame.heights(*np.array(found).T)


@pytest.mark.parametrize("ring", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_the_nearest_of_all_pieces_is_found(seed, ring):
    frame = tangled(40, seed, ring)
    height = frame.heights(frame.cells.x, frame.cells.y, frame.cells.z)
    np.testing.assert_allclose(positions(frame).y_ab, height / nearest_of_all(frame, range(40)), rtol=1e-12)


def test_the_nearest_of_all_triangles_and_images_is_found(sheet):
    some = np.arange(0, len(sheet.final.cells.x), 23)
    expected = sheet.final.cells.y[some] / nearest_of_all(sheet.final, some)
    np.testing.assert_allclose(positions(sheet.final).y_ab[some], expected, rtol=1e-12)


def random_frame(seed, n=25):
    """A tissue whose apical layer goes up and down, back and forth."""
    rng = np.random.default_rng(seed)
    state = cells(n, seed)
    bent = state._replace(ax=state.ax + rng.normal(0.0, 0.6, n), ay=HEIGHT + rng.normal(0.0, 1.5, n))
    return Frame(0.0, bent, layers(n, apical=np.flatnonzero(rng.uniform(size=n) < 0.7)))


@pytest.mark.parametrize("seed", range(4))
def test_reference_is_the_nearest_of_very_many_points_of_the_layer(seed):
    state = random_frame(seed)
    c, line = state.cells, state.layers.apical
    part = np.linspace(0.0, 1.0, 4001)[:, None]
    x, y = ((1 - part) * array[line[:-1]] + part * array[line[1:]] for array in (c.ax, c.ay))
    for i, position in enumerate(ab_positions(state)):
        nearest = np.argmin((x - c.x[i]) ** 2 + (y - c.y[i]) ** 2)
        assert position == pytest.approx(c.y[i] / y.ravel()[nearest], abs=2e-3)


@pytest.mark.parametrize("name", ["plane", "sphere"])
def test_positions_against_a_dense_sample_of_the_apical_surface(name):
    frame = tissue.simulate(of_surface(name), 6).final
    found, c, surface = ab_positions(frame), frame.cells, frame.sheets.surface
    corners = np.column_stack((c.ax, c.ay, c.az))[frame.sheets.apical.triangles]
    u, v = (part.ravel()[None, :, None] for part in np.meshgrid(np.linspace(0, 1, 21), np.linspace(0, 1, 21)))
    u, v = u[:, (u + v <= 1)[0, :, 0]], v[:, (u + v <= 1)[0, :, 0]]
    for i in range(0, len(c.x), 7):
        at = np.array([c.x[i], c.y[i], c.z[i]])
        a, b, d = (
            nearest_image((corners - at).reshape(-1, 3).T, surface).T.reshape(-1, 3, 3).transpose(1, 0, 2)[:, :, None]
        )
        sample = (a + u * (b - a) + v * (d - a)).reshape(-1, 3)
        x, y, z = (sample[(sample**2).sum(axis=1).argmin()] + at)[:, None]
        expected = frame.heights(*at[:, None]) / frame.heights(x, y, z)
        assert found[i] == pytest.approx(expected[0], abs=0.05)


@pytest.mark.parametrize(
    ("nuclei", "apical", "left", "expected"),
    [
        # On the upright part; 1 above the level part and 1 beside the upright one: the first counts; below the left end
        ([[3, 7], [1, 5], [0, 0.5]], [[0, 4], [2, 4], [2, 8]], None, [1.0, 1.25, 0.125]),
        ([[0, 2], [3, 4]], [[0, 8], [0, 8]], None, [0.25, 0.5]),
        ([[0, 2], [3, 4]], [[0, 8], [1, 5]], [1], [0.4, 0.8]),
    ],
)
def test_positions_by_hand(nuclei, apical, left, expected):
    frame = layer(apical, nuclei)
    frame = frame._replace(layers=layers(len(apical), apical=left))
    assert ab_positions(frame).tolist() == pytest.approx(expected)


def test_height_widths_and_nuclear_layers_by_hand():
    frame = layer([[-3, 50], [0, 7], [4, 9], [9, 50]], [[-6, 1], [0, 1], [0.5, 1], [1, 1]])
    c = frame.cells._replace(bx=frame.cells.ax)
    frame = frame._replace(cells=c, layers=layers(4, apical=[1, 2], basal=[0, 1, 2]))
    assert height(frame) == 8.0
    assert extents(frame)[2:5] == (4.0, 7.0, 7.0)
    assert extents(layer([[0, 8]], [[3, 1]])).nuclear_layers == 1.0


def test_nuclear_layers_are_what_lines_along_the_normals_cross():
    """Vertical ones; in a ring of length 30 radii from its middle: with nuclei everywhere 2 N / 30 discs each."""
    frame = random_frame(2)
    x = frame.cells.x
    lines = np.linspace(x.min() - 1, x.max() + 1, 20_001)
    crossed = (np.abs(lines[:, None] - x) <= 1.0).sum(axis=1)
    assert extents(frame).nuclear_layers == pytest.approx(crossed.mean(), rel=1e-3)
    curve = ellipse(30.0, 1.0, inside=True, ring=True)
    nuclei = np.column_stack(curve.above(np.linspace(-15.0, 15.0, 90, endpoint=False), np.full(90, 1.0)))
    ring = layer(np.zeros((90, 2)), nuclei, curve)
    apart = np.abs((np.linspace(-15.0, 15.0, 5000)[:, None] - curve.feet(*nuclei.T) + 15.0) % 30.0 - 15.0)
    assert extents(ring).nuclear_layers == pytest.approx((apart <= 1.0).sum(axis=1).mean(), rel=1e-3)
    assert extents(ring).nuclear_layers == pytest.approx(6.0, rel=1e-12)


@pytest.mark.parametrize("begins", ["mitosis", "G2"])
def test_phases_are_those_of_the_run(begins):
    """The discs of a run are enlarged from the phase on that the parameters name."""
    parameters = preset("thesis").changed(
        {"rules.enlarge_from": begins, "numerics.t_end": "12 h", "numerics.keep": "0.1 h"}
    )
    given, met = parameters.numbers(), set()
    for state in tissue.simulate(parameters, 3).frames:
        now = phases(state, given)
        met |= set(now.tolist())
        late = now >= PHASES.index(begins)
        assert (state.cells.radius == np.where(late, given.enlarged_radius, given.hard_radius)).all()
    assert met == {0, 1, 2}


@pytest.mark.parametrize("name", ["x", "y", "ax", "ay", "bx", "by"])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e101])
def test_what_can_not_be_measured_is_told(name, value):
    state = random_frame(0)
    assert is_measurable(state)
    getattr(state.cells, name)[7] = value
    assert not is_measurable(state)


@pytest.mark.parametrize("function", [height, extents, ab_positions])
def test_what_has_no_measure_is_refused(function):
    """An empty layer; positions, where the layer is on the basal line."""
    with pytest.raises(InvalidProblem, match=r"layers\.apical is empty"):
        function(layer([[0, 8]], [[0, 1]])._replace(layers=layers(1, apical=[], basal=[0])))
    if function is ab_positions:
        with pytest.raises(InvalidProblem, match=r"cell 1: the point of the apical layer .* is at height 0"):
            function(layer([[0, 8], [3, 0]], [[0, 1], [4, -1]]))


FLAT = [[k, 8.0] for k in range(12)]
# Crossings, the longest loop, what runs backwards, stretch; by hand.
SHAPES = {
    "level": (FLAT, 0, 0.0, 0.0, 1.0),
    "a step back": (
        [[0, 8], [2, 8], [1, 9], [3, 9]],
        0,
        0.0,
        math.sqrt(2) / (4 + math.sqrt(2)),
        (4 + math.sqrt(2)) / 3,
    ),
    "a loop": ([[0, 8], [4, 8], [4, 10], [2, 10], [2, 6], [6, 6]], 1, 4.0, 2 / 16, 16 / 6),
    "neighbours in one place": ([[0, 8], [1, 8], [1, 8], [2, 8]], 0, 0.0, 0.0, 2 / 3),
    "two points passed": ([[0, 8], [2, 8.1], [1, 8.2], [1.5, 7.5], [4, 8]], 1, None, None, None),
}


@pytest.mark.parametrize("name", SHAPES)
def test_shapes_of_the_layer(name):
    apical, crossings, loop, backward, stretch = SHAPES[name]
    folds = measure(state_of(layer(apical))).folds
    assert folds.crossings == crossings
    if loop is not None:
        assert (folds.loop, folds.backward, folds.stretch) == pytest.approx((loop, backward, stretch))


@pytest.mark.parametrize("seed", range(3))
def test_crossings_are_those_of_all_pairs(seed):
    frame = tangled(60, seed)
    path = np.column_stack((frame.cells.ax, frame.cells.ay))
    along, count = np.diff(path, axis=0), 0
    for k, m in itertools.combinations(range(len(along)), 2):
        both = np.column_stack((along[k], -along[m]))
        count += m > k + 1 and bool((abs(np.linalg.solve(both, path[m] - path[k]) - 0.5) < 0.5).all())
    assert measure(state_of(frame)).folds.crossings == count > 0


@pytest.mark.slow
def test_crossings_of_triangles_are_those_of_all_pairs():
    """On a narrow cylinder the apical layer crosses itself for a moment."""
    brief = {"numerics__t_end": "0.3 h", "numerics__keep": "0.05 h", "emt__cells": 3, "emt__a": "0.1 h"}
    with pytest.warns(UserWarning, match="the apical layer crosses itself"):
        run = tissue.simulate(of_surface("cylinder", **brief), 2)
    frame = next(frame for frame in run.frames if measure(state_of(frame)).folds.crossings)
    tree, pairs = apical_tree(state_of(frame)), 0
    low, high = tree.points.min(axis=1), tree.points.max(axis=1)
    for k in range(len(tree.points)):
        near = ((low[k] <= high[k + 1 :]) & (low[k + 1 :] <= high[k])).all(axis=1)
        for m in k + 1 + np.flatnonzero(near):
            pairs += _cross(tree, k, m) or _cross(tree, m, k)
    found = measure(state_of(frame))
    assert found.folds.crossings == pairs > 0
    assert found.fold == "the apical layer crosses itself"
    assert 0.0 < found.folds.backward < 1 / 3


def _cross(tree, k, m):
    """Whether an edge of triangle k goes through triangle m."""
    for c in range(3):
        ends = tree.corners[k][[c, (c + 1) % 3]]
        if set(ends) & set(tree.corners[m]):
            continue
        p, q = tree.points[k][[c, (c + 1) % 3]]
        one, two, three = tree.points[m]
        matrix = np.column_stack((p - q, two - one, three - one))
        if abs(np.linalg.det(matrix)) > 1e-12:
            t, u, v = np.linalg.solve(matrix, p - one)
            if 0 < t < 1 and u > 0 and v > 0 and u + v < 1:
                return True
    return False


@pytest.mark.parametrize("name", PRESETS)
def test_presets_are_not_folded(name):
    run = tissue.simulate(tissue.preset(name), 1)
    summary = run.summary()
    assert run.folded == ""
    assert (summary["folded"] == "no").all()
    assert summary.notna().all().all()
    assert summary["apically_extruded"].dtype == np.int64


@pytest.fixture(scope="module")
def fast():
    with pytest.warns(UserWarning, match=r"^the apical layer was folded.*t = \d+ h: "):
        return tissue.simulate(tissue.preset("published").changed(FAST))


def test_a_tissue_that_grows_fast_is_folded(fast):
    """A number is NaN where there is a reason, and nowhere else."""
    summary, parameters = fast.summary(), fast.parameters
    hidden = [one.column for one in SUMMARY_COLUMNS if one.of_layer]
    there = summary["folded"] != "no"
    assert fast.status is Status.SUCCESS
    assert ", folded" in repr(fast)
    assert there.any()
    assert not there.all()
    assert (summary[hidden].isna().all(axis=1) == there).all()
    assert summary.drop(columns=hidden).notna().all().all()
    table = fast.table()
    assert (table["y_ab"].isna() == table["time_h"].isin(summary.loc[there, "time_h"])).all()
    kept = replace(fast, parameters=parameters.changed({"numerics.folded": "keep"}))
    assert kept.summary().notna().all().all()
    assert kept.table()["y_ab"].notna().all()


def test_a_run_stops_where_it_is_folded(fast):
    stopped = tissue.simulate(fast.parameters.changed({"numerics.folded": "stop"}), throw=False)
    first = fast.summary().query("folded != 'no'")["time_h"].iloc[0]
    assert stopped.status is Status.FOLDED
    assert stopped.final.t == first
    assert stopped.detail == f"{fast.folded}."


STUDY = """
title = "fast"
base = "published"
replicates = 3
seed = 1
[overrides]
tissue.two_daughters = 0.6
cell = { min_cycle = "6 h", max_cycle = "10 h" }
numerics = { t_end = "30 h", keep = "10 h" }
emt = { cells = 4, a = "1 h" }
[scenarios.left]
[scenarios.kept]
numerics.folded = "keep"
[scenarios.slow]
tissue.two_daughters = 0
"""


@pytest.mark.slow
def test_studies_leave_folded_runs_out(tmp_path):
    (tmp_path / "fast.toml").write_text(STUDY, "utf-8")
    results = tissue.run_study(tmp_path / "fast.toml", tmp_path / "out")
    assert results.summary().set_index("scenario")[["failed", "folded"]].T.to_dict("list") == {
        "left": [3, 3],
        "kept": [0, 3],
        "slow": [0, 0],
    }
    assert set(results.runs("left")["status"]) == {"FOLDED"}
    assert results.runs("left")["height_um_30h"].isna().all()
    assert results.runs("kept")["height_um_30h"].notna().all()
    assert set(scenario_means(results)["scenario"]) == {"kept", "slow"}
    left, kept = folded_remarks(results)
    assert left.startswith("left: the apical layer was folded in 3 of 3 runs")
    assert left.endswith("; the answers leave these runs out")
    assert kept.endswith("; the answers have these runs all the same")
    remarks = [f"Folded: {left}.", f"Folded: {kept}."]
    said = CliRunner().invoke(app, ["summary", str(tmp_path / "out")]).output.splitlines()
    assert said[1:3] == remarks
    again = CliRunner().invoke(app, ["study", str(tmp_path / "fast.toml"), "--out", str(tmp_path / "out")])
    *first, last = again.stdout.splitlines()
    assert first[-2:] == remarks
    assert last.startswith("9 runs, 0 of them now in ")
    page = write_page(results).read_text("utf-8")
    assert page.index("<p class=folded>left: ") < page.index("<h2>Answers</h2>")


def test_beyond_the_apical_layer_of_a_tube_is_its_lumen():
    """Where the layer overhangs that differs from y_AB > 1: its nearest point is above a nucleus in the lumen."""
    rng = np.random.default_rng(5)
    curve = ellipse(60.0, 1.0, inside=True, ring=True)
    s = np.linspace(-30.0, 30.0, 90, endpoint=False)
    heights = 4.0 + 2.5 * np.sin(2 * np.pi * s / 10)
    apical = np.column_stack(curve.above(s + 1.2 * heights, heights))
    nuclei = rng.uniform(apical.min(axis=0), apical.max(axis=0), (90, 2))
    found = positions(layer(apical, nuclei, curve))
    assert (found.apically == Path(apical).contains_points(nuclei)).all()
    assert (found.apically != (found.y_ab > 1)).any()
    assert not (found.apically & found.basally).any()


@pytest.mark.parametrize("make", [lambda n: tangled(n, 1), lambda n: layer([[k, 8 + math.sin(k)] for k in range(n)])])
def test_the_work_grows_as_the_number_of_cells(make):
    """Counted by boxes looked at: four times as many cells, and two steps more to each."""
    looks = []
    for n in (1000, 4000):
        state = state_of(make(n))
        tree = apical_tree(state)
        looks.append(measure_positions(state, tree).looks + measure_folds(state, tree).looks)
    assert looks[1] < 1.5 * 4 * looks[0]
    assert looks[1] < 300 * 4000


def test_widths_of_a_periodic_sheet_are_the_period(sheet):
    period = sheet.final.sheets.surface.period_x
    assert extents(sheet.final)[2:5] == (period, period, period)
    cut = section(sheet.final).cells
    assert (abs(cut.x) <= period / 2).all()
    assert (abs(cut.ax - cut.x) <= period / 2).all()


def test_heights_and_arclengths_of_a_tube():
    """Radii of a circle, and angles from its lowest point."""
    ring = {"layer.shape": "circle", "layer.closed": True, "layer.perimeter": "100 R_soft", "tissue.cells": 300}
    parameters = tissue.preset("published").changed(ring | {"numerics.t_end": "0.1 h", "numerics.keep": "0.1 h"})
    table = tissue.simulate(parameters).table()
    um, radius = parameters.cell.soft_radius.value, 100 / (2 * math.pi)
    x, y = table["nucleus_x_um"] / um, table["nucleus_y_um"] / um - radius
    np.testing.assert_allclose(table["nucleus_height_um"] / um, radius - np.hypot(x, y), atol=1e-9)
    np.testing.assert_allclose(table["nucleus_along_um"] / um, radius * np.arctan2(x, -y), atol=1e-9)
    straight = tissue.simulate(tissue.preset("published").changed({"numerics.t_end": "0.1 h"})).table()
    assert "nucleus_height_um" not in straight
