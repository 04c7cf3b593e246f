"""The figures of chapter 4: they draw what the tables say, and name what is missing."""

import re

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex

from dincl.errors import InvalidProblem
from tests.tissue.study.figures_stand_in import (
    POPULATIONS,
    TIMES,
    caption,
    coloured,
    dots,
    expected,
    last,
    made,
    outcomes,
    whole,
)
from tissue.files.parameters import preset
from tissue.frames.observables import phases
from tissue.pictures.charts import CHECK, CHECKED, ENVIRONMENTS, OUTCOMES, ratios_in_time
from tissue.runs.simulate import simulate
from tissue.statistics.ratios import over_time
from tissue.study.answers import scenario_ratios
from tissue.study.figures.catalogue import FIGURES, found
from tissue.study.figures.conditional import MOST
from tissue.study.figures.examples import frames
from tissue.study.figures.sources import FigureSource, needed

STILLS = ["t = 12 h", "t = 18 h", "t = 24 h"]


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("tissue.study.outcomes.outcomes", outcomes)
        made([f"figure{number}" for number in (10, 12, 14, 15)] + list(POPULATIONS), folder)
    return folder


@pytest.fixture(scope="module")
def results(home):
    return found(home)


@pytest.fixture(scope="module")
def sources(results):
    return {"thesis": FigureSource(results)}


@pytest.fixture(scope="module")
def both(sources, results):
    return sources | {"published": FigureSource(results)}


@pytest.mark.slow_with("10-names0")
@pytest.mark.parametrize(
    ("number", "names"),
    [
        (10, ["[A]", "[B]", "[S]", "[BP]"]),
        (12, ["[A] no INM", "[B] no INM", "[S] no INM", "no EMT no INM"]),
        (14, ["[AxB]", "[AB]", "[BxA]"]),
    ],
)
def test_ratios_against_time_have_their_bands(sources, results, number, names):
    study = results[f"figure{number}"]
    figure = FIGURES[number](sources)
    panels = {panel.get_title("left"): panel for panel in figure.axes}
    for name in names:
        table = over_time(study.cells(name))
        for what, band in zip(OUTCOMES, panels[name].collections, strict=True):
            mine = table[table["what"] == what]
            line = coloured(panels[name], OUTCOMES[what][0])
            assert line.get_xdata().tolist() == list(TIMES)
            assert line.get_ydata() == pytest.approx(100 * mine["value"].to_numpy())
            edges = band.get_paths()[0].vertices[:, 1]
            assert {edges.min(), edges.max()} == {100 * mine["low"].min(), 100 * mine["high"].max()}
    assert "n = 8 runs" in caption(figure)
    assert "95 % Wilson intervals" in caption(figure)


def test_control_cells_and_times_of_events_are_marked(sources, results):
    panels = FIGURES[10](sources).axes
    runs = results["figure10"].runs("[BP]")
    assert panels[3].lines[3].get_ydata() == pytest.approx(
        [100 * runs[f"controls_apical_{t:g}h"].sum() / (50 * 8) for t in TIMES]
    )
    events = [[text.get_text() for text in panel.texts] for panel in panels]
    assert events == [["[A]"], ["[B]"], ["[S]"], ["[B]", "[P]"]]
    assert [text.xy[0] for text in panels[3].texts] == [12.0, 24.0]
    left = {panel.get_title("left"): panel for panel in FIGURES[14](sources).axes}
    assert [text.get_text() for text in left["[AB]"].texts] == ["[AB]"]


def test_basal_positioning_since_the_loss_of_apical_adhesion(sources, results):
    (panel,) = (panel for panel in FIGURES[14](sources).axes if panel.get_title("left") == "Basal positioning")
    lines = {line.get_label(): line for line in panel.lines}
    for name, begin in (("[AxB]", 6.0), ("[AB]", 15.0), ("[BxA]", 24.0)):
        cells = results["figure14"].cells(name)
        assert lines[name].get_xdata().tolist() == [t - begin for t in TIMES]
        assert lines[name].get_ydata() == pytest.approx([100 * cells[f"below_{t:g}h"].mean() for t in TIMES])


def test_ratios_at_the_end_with_and_without_inm_beside_the_printed_ones(sources, results):
    figure = FIGURES[13](sources)
    lines = [text.get_text() for text in figure.axes[0].get_yticklabels()]
    assert lines == ["[A]", "[B]", "[S]", "[BP]", "no EMT"]
    for panel, what in zip(figure.axes, ("basal", "apical", "below"), strict=True):
        assert panel.get_title("left") == OUTCOMES[what][2]
        assert panel.yaxis.get_majorticklocs().tolist() == [0, 1, 2, 3, 4]
        studies = (
            ("figure10", ["[A]", "[B]", "[S]", "[BP]"], ""),
            ("figure12", ["[A]", "[B]", "[S]", "no EMT"], " no INM"),
        )
        for marks, (study, names, ending) in zip(dots(panel), studies, strict=True):
            assert [numbers for _, *numbers, _ in marks] == [
                pytest.approx(expected(results[study].cells(f"{name}{ending}"), what)) for name in names
            ]
            assert {colour for *_, colour in marks} == {OUTCOMES[what][0]}
    marks = [[line for line in panel.lines if line.get_marker() == "D"] for panel in figure.axes]
    printed = [sorted(float(line.get_xdata()[0]) for line in lines) for lines in marks]
    assert printed == [[0.0, 10.0, 20.0, 70.0], [30.0], [60.0]]


@pytest.mark.slow
def test_alone_and_in_groups_with_and_without_inm(sources, results):
    figure, programs = FIGURES[15](sources), results["figure15"].study.scenarios[::4]
    panels = figure.axes
    assert [text.get_text() for text in panels[0].get_yticklabels()] == list(programs)
    for panel, inm in zip(panels, ("", " no INM"), strict=True):
        for container, ending in zip(panel.containers, ("", ", 10 cells"), strict=True):
            wanted = [expected(results["figure15"].cells(f"{name}{inm}{ending}")) for name in programs]
            dots, _, (whiskers,) = container.lines
            assert dots.get_xdata() == pytest.approx([value for value, *_ in wanted])
            assert np.round(dots.get_ydata()).tolist() == list(range(len(programs)))
            assert (dots.get_ydata() > range(len(programs))).all() == bool(ending)  # the group below, for y points down
            ends = [segment[:, 0].tolist() for segment in whiskers.get_segments()]
            assert ends == [pytest.approx(interval) for _, *interval in wanted]
    assert "n = 8 runs" in caption(figure)


@pytest.mark.parametrize(("number", "scenario", "has"), [(17, "[AxB]", "ab"), (18, "[Ax]", "a"), (19, "[Bx]", "b")])
def test_cells_with_the_same_events_in_all_environments(sources, results, number, scenario, has):
    figure = FIGURES[number](sources)
    for panel, inm in zip(figure.axes, (True, False), strict=True):
        name = scenario if inm else f"{scenario} no INM"
        tables = [results["figure15"].cells(f"{name}{ending}") for ending in ("", ", 10 cells")]
        for study, population in POPULATIONS.items():
            cells = results[study].cells(population)
            events = [(cells[f"t_{event}_h"] < 48.0) == (event in has) for event in "absp"]
            mine = np.logical_and.reduce(events) & (cells["inm"] == inm)
            tables.append(cells[mine & (cells["t_a_h"] <= cells["t_b_h"])] if has == "ab" else cells[mine])
        for cells, environment, (((_, *numbers, colour),)) in zip(tables, ENVIRONMENTS, dots(panel), strict=True):
            assert numbers == pytest.approx(expected(cells))
            assert colour == ENVIRONMENTS[environment][0]


def test_ratios_given_the_time_of_an_event(sources, results):
    panels = {panel.get_title("left"): panel for panel in FIGURES[20](sources).axes}
    assert list(panels) == ["[A], cells without [P]", "[B], cells without [P]", "[P]"]
    for title, panel in panels.items():
        times = f"t_{title[1].lower()}_h"
        for study, population in POPULATIONS.items():
            cells = results[study].cells(population)
            cells = cells[np.isinf(cells["t_p_h"])] if "without" in title else cells
            lines = [line for line in panel.lines if line.get_color() == ENVIRONMENTS[study][0]]
            for line, inm in zip(lines, (True, False), strict=True):
                for middle, value in line.get_xydata():
                    mine = cells[(cells[times] > middle - 1.5) & (cells[times] <= middle + 1.5) & (cells["inm"] == inm)]
                    assert value == pytest.approx(100 * last(mine).mean())
    line = next(
        line for line in panels["[A], cells without [P]"].lines if line.get_color() == ENVIRONMENTS["table5_35"][0]
    )
    assert line.get_xdata().tolist() == [7.5, 10.5, 13.5, 16.5, 19.5, 22.5]


def test_ratios_given_the_position_at_the_onset(sources, results):
    cells = results["table5_35"].cells("35 % [P]")
    calm = cells[np.isinf(cells["t_p_h"])]
    for panel, inm in zip(FIGURES[21](sources).axes, (True, False), strict=True):
        mine = calm[calm["inm"] == inm]
        line = coloured(panel, ENVIRONMENTS["table5_35"][0])
        assert len(line.get_xdata()) == 10
        for middle, value in line.get_xydata():
            here = mine[(mine["onset_ab"] > middle - 0.05) & (mine["onset_ab"] <= middle + 0.05)]
            assert value == pytest.approx(100 * last(here).mean())


def test_a_dot_for_each_cell_without_protrusions_but_not_too_many(sources, results, monkeypatch):
    cells = results["table5_35"].cells("35 % [P]")
    calm = cells[np.isinf(cells["t_p_h"]) & np.isfinite(cells["onset_h"])]
    assert len(calm) < MOST
    panels = FIGURES[22](sources).axes
    for panel, inm in zip(panels, (True, False), strict=True):
        dots = np.concatenate([part.get_offsets() for part in panel.collections])
        mine = calm.loc[calm["inm"] == inm, ["ab_48h", "onset_ab"]].to_numpy()
        assert sorted(map(tuple, dots)) == sorted(map(tuple, mine))
        still, apical, basal = (part.get_offsets()[:, 0] for part in panel.collections)
        assert basal.max() < 0 <= still.min() <= still.max() <= 1 < apical.min()
        assert to_hex(panel.collections[2].get_facecolor()) == OUTCOMES["basal"][0]
    monkeypatch.setattr("tissue.study.figures.conditional.MOST", 50)
    figure = FIGURES[22](sources)
    assert sum(len(part.get_offsets()) for panel in figure.axes for part in panel.collections) == 50
    assert f"n = 50 at random from {len(calm)}" in caption(figure)


def test_examples_are_the_stored_runs_at_the_onset_halfway_and_at_the_end(sources, results):
    top, bottom = sorted((whole(1, k) for k in (0, 1)), key=start)
    figure = FIGURES[11](sources)
    assert [panel.texts[0].get_text()[:8] for panel in figure.axes] == STILLS * 2
    for panel, run in zip(figure.axes[::3], (top, bottom), strict=True):
        nuclei = run.loc[run["time_h"] == 12.0, ["nucleus_x_um", "nucleus_y_um"]].to_numpy()
        assert panel.collections[0].get_offsets() == pytest.approx(nuclei)
    told = re.findall(r"= ([-\d.]+) at the onset", caption(figure))
    assert told == [f"{start(run):.2f}" for run in (top, bottom)]


def start(run):
    return float(run.loc[(run["emt"] >= 0) & (run["time_h"] == 12.0), "y_ab"].mean())


def test_a_cell_alone_and_a_group(sources, results):
    figure = FIGURES[16](sources)
    assert [panel.texts[0].get_text()[:8] for panel in figure.axes] == STILLS * 2
    counts = [sum(line.get_marker() == "x" and len(line.get_xdata()) for line in panel.lines) for panel in figure.axes]
    assert counts == [1, 1, 1, 10, 10, 10]
    alone, group = (end(1), end(10))
    assert f"extruded {'basally' if alone else 'apically'}" in caption(figure) or "not extruded" in caption(figure)
    assert f"{group} of 10 extruded basally" in caption(figure)


def end(cells):
    """How many cells of the run that has most are extruded basally at the end."""
    runs = [whole(cells, k) for k in (0, 1)]
    return max(int((run.loc[(run["emt"] >= 0) & (run["time_h"] == 24.0), "y_ab"] < 0).sum()) for run in runs)


def test_a_run_without_events_is_shown_from_its_start(sources, results, monkeypatch):
    calm = whole(1, 0)[lambda run: run["time_h"] < 12.0]
    monkeypatch.setattr("tissue.study.read.Results.trajectory", lambda *_: calm)
    titles = [panel.texts[0].get_text()[:7] for panel in FIGURES[11](sources).axes]
    assert titles == ["t = 0 h", "t = 6 h"] * 2  # output times, each once


def test_states_come_back_from_their_table():
    run = simulate(
        preset("thesis").changed({"numerics.keep": "6 h", "numerics.t_end": "12 h", "emt.cells": 3, "emt.a": "6 h"}), 2
    )
    (frame,), final = frames(run.table(), [12.0], run.parameters), run.final
    for name in ("x", "y", "ax", "ay", "bx", "by", "radius", "birth", "cycle", "id", "emt", "events"):
        assert getattr(frame.cells, name) == pytest.approx(getattr(final.cells, name))
    assert all((one == other).all() for one, other in zip(frame.layers, final.layers, strict=True))
    assert (phases(frame, run.parameters.numbers()) == phases(final, run.parameters.numbers())).all()


@pytest.mark.parametrize("number", FIGURES)
def test_a_study_that_is_missing_is_named(results, number):
    studies = needed(FIGURES[number])
    for absent in studies:
        others = {name: study for name, study in results.items() if name != absent}
        with pytest.raises(InvalidProblem, match=f"results lack {absent}: must have {', '.join(studies)}"):
            FIGURES[number]({"thesis": FigureSource(others)})


@pytest.mark.slow_with("10", "12", "15", "16")
@pytest.mark.parametrize("number", FIGURES)
def test_two_presets_stand_beside_each_other(sources, both, number):
    alone, beside = FIGURES[number](sources), FIGURES[number](both)
    assert len(beside.axes) == 2 * len(alone.axes)
    if number not in (11, 16):
        titles = [panel.get_title("left") for panel in beside.axes]
        wanted = [panel.get_title("left") for panel in alone.axes]
        assert titles == [f"{title}, {preset}" for title in wanted for preset in ("thesis", "published")]
        assert {panel.get_subplotspec().colspan.start for panel in beside.axes[::2]} == {0}


@pytest.mark.slow
def test_kept_tables_come_first_and_the_runs_are_laid_over_them(results):
    rows = pd.concat([scenario_ratios(results[name]).assign(study=name) for name in ("figure10", "figure12")])
    kept = {"ratios": rows.assign(value=0.5, low=0.4, high=0.6)}
    source = FigureSource(results, kept)
    assert not FigureSource({}, kept).lacks(FIGURES[13])
    for panel in FIGURES[13]({"thesis": source}).axes:
        fewer, ratios = dots(panel)[::2], dots(panel)[1::2]
        assert {value for marks in ratios for _, value, *_ in marks} == {50.0}
        assert all(colour == CHECK["color"] for marks in fewer for *_, colour in marks)
    texts = [text.get_text() for text in FIGURES[13]({"thesis": source}).legends[0].get_texts()]
    assert CHECKED in texts
    assert "Diamonds: the end by complete studies, n = 8 runs" in caption(FIGURES[10]({"thesis": source}))


def test_ratios_of_all_times_at_once_are_those_of_each(results):
    cells = results["figure15"].cells("[AxB], 10 cells")
    pd.testing.assert_frame_equal(ratios_in_time(cells), over_time(cells), check_dtype=False)
