"""The page without its browser: settings and knobs, pictures of the run, the answer, and sessions."""

import json
import time

import numpy as np
import pandas as pd
import pytest
from scipy import stats

import tissue
from dincl.errors import InvalidProblem
from dincl.status import Status
from tests.tissue.space.in_space import SURFACES, of_surface
from tissue.events.known import EVENTS
from tissue.files.parameter_files import PRESETS, flat
from tissue.frames.observables import ab_positions, height
from tissue.pictures.emt import EMT_COLOURS
from tissue.study.answers import scenario_means
from tissue.study.plan import load_study
from tissue.study.run import run_study
from verification.explore import frames
from verification.explore.answer import (
    DECIDED,
    HEIGHT,
    NO_INTERVAL,
    Answer,
    Sample,
    difference,
    means_of,
    rows_of,
)
from verification.explore.dialogs import command, parameters_text, study_text
from verification.explore.ensemble import cores, workers
from verification.explore.folder import Folder
from verification.explore.frames import finely_kept, stream
from verification.explore.knobs import CLOSED, groups, number_of, other_keys, scale_of
from verification.explore.sequences import bounded, runs_to_decide, unbounded
from verification.explore.session import Session
from verification.explore.setting import Setting, faults_of, text_of, value_of
from verification.explore.streams import SIZES, told

# A tissue that grows in no time.
SMALL = {
    "tissue.cells": 12,
    "tissue.width": "20 um",
    "numerics.t_end": "4 h",
    "emt.cells": 3,
    "emt.a": "1 h to 3 h",
    "emt.b": "1 h to 3 h",
}
THESIS = Setting("thesis", tissue.preset("thesis"))
PARAMETERS = tissue.preset("thesis").changed(SMALL)
LONG = {"numerics.t_end": "48 h"}
RUNS = 24

# Settings


@pytest.mark.parametrize("changes", [{}, {"cell.alpha_aa": 0, "tissue.diffusion": "0 um^2/h"}], ids=["", "zeros"])
@pytest.mark.parametrize("name", PRESETS)
def test_a_slider_begins_at_its_value_and_every_place_of_it_can_be(name, changes):
    setting = Setting(name, tissue.preset(name).changed(changes))
    for facts in (facts for group in groups().values() for facts in group):
        scale = scale_of(facts, setting.values()[facts.name])
        if scale is None:
            continue
        number, unit = number_of(setting.values()[facts.name])
        assert scale.unit == unit
        assert scale.values[scale.place_of(number)] == pytest.approx(number, rel=0.05), facts.name
        for place in range(len(scale.values)):
            assert scale.place_of(number_of(scale.value_at(place))[0]) == place
        assert setting.with_values({facts.name: scale.value_at(scale.place_of(number))})


def test_settings_are_changes_of_their_base_and_all_keys_are_reached():
    shown, values = {facts.name for group in groups().values() for facts in group}, THESIS.values()
    assert shown <= set(values)
    assert shown | set(other_keys(values)) | {CLOSED} == set(values)
    setting = THESIS.with_values({"tissue.cells": 30, "numerics.mu": "9 min"})
    assert setting.changes == {"tissue.cells": 30}
    assert setting.with_values({"tissue.cells": 60}).changes == {}
    assert setting.parameters == tissue.preset("thesis").changed({"tissue.cells": 30})
    assert Setting.of(tissue.preset("chick")).parameters == tissue.preset("chick")
    wide = THESIS.with_values({"tissue.cells": 182})
    sheet = wide.with_values({"tissue.dimension": 3})
    assert sheet.parameters.in_space
    assert sheet.with_values({"tissue.dimension": 2}).parameters == wide.parameters


@pytest.mark.parametrize(
    ("text", "value"),
    [("40 um", "40 um"), ("3", 3), (" 0.5 ", 0.5), ("true", True), ("[0, 1]", [0, 1]), ("a\nb", "a\nb"), ('"x"', "x")],
)
def test_a_field_takes_what_a_file_takes_with_or_without_quotes(text, value):
    assert value_of(text) == value
    assert value_of(text_of(value)) == value


@pytest.mark.parametrize(
    ("values", "at", "said"),
    [
        ({"tissue.cells": -1}, ["tissue.cells"], "must be a whole number from 1 to 1000000"),
        ({"cell.min_cycle": "30 h"}, ["cell.min_cycle"], 'cell.max_cycle = "21 h": must be at least'),
        ({"numerics.mu": "x", "tissue.cells": 0}, ["numerics.mu", "tissue.cells"], "must be"),
        ({"tissue.dimension": 3, "tissue.cells": 45}, ["tissue.cells"], ""),
    ],
)
def test_faults_stand_at_the_keys_that_were_changed(values, at, said):
    with pytest.raises(InvalidProblem) as found:
        THESIS.with_values(values)
    faults, others = faults_of(found.value, list(values))
    assert set(at) <= set(faults)
    assert all(said in faults[key] for key in at)
    assert not others


def test_files_of_python_cannot_be_named():
    with pytest.raises(InvalidProblem, match=r"own\.modules"):
        THESIS.with_values({CLOSED: ["/tmp/code.py"]})
    assert CLOSED in flat(THESIS.parameters.as_dict())


# Pictures


def parsed(pieces):
    """Headers with their payloads."""
    data, found = b"".join(pieces), []
    while data:
        head, load = SIZES.unpack_from(data)
        begin = SIZES.size + head
        found.append((json.loads(data[SIZES.size : begin]), data[begin : begin + load]))
        data = data[begin + load :]
    return found


@pytest.mark.slow_with("cylinder", "sphere")
@pytest.mark.parametrize("name", ["slice", *SURFACES])
def test_pictures_are_those_of_the_run(name):
    brief = {"numerics__t_end": "0.5 h", "emt__cells": 3, "emt__a": "0.1 h"}
    parameters = PARAMETERS if name == "slice" else of_surface(name, **brief)
    (head, _), *shown, (end, _) = parsed(stream(parameters, 3))
    run = tissue.simulate(finely_kept(parameters), 3)
    heights, um = run.summary().set_index("time_h")["height_um"], parameters.cell.soft_radius.value
    assert end == {"kind": "end", "status": "SUCCESS", "detail": ""}
    assert (head["end"], len(shown)) == (parameters.t_end, len(run.frames))
    assert all(one["colour"] == EMT_COLOURS[one["name"]] for one in head["looks"])
    axes = "xy" if name == "slice" else "xyz"
    lengths = [f"{point}{axis}" for point in ("", "a", "b") for axis in axes] + ["radius"]
    if name == "slice":
        assert len(shown) > 30
        assert head["painter"] == "tissue"
    else:
        surface = run.final.sheets.surface
        assert (head["painter"], head["surface"]["bends"]) == ("sheet", surface.bends)
        periods = [um * surface.period_x, um * surface.period_z]
        assert [period or np.inf for period in head["periods"]] == pytest.approx(periods)
    for (header, payload), frame in zip(shown, run.frames, strict=True):
        n, rows = header["cells"], len(lengths) + 6
        table = np.frombuffer(payload[: 4 * rows * n], "<f4").reshape(rows, n)
        members = np.frombuffer(payload[4 * rows * n :], "<i4")
        assert header["t"] == pytest.approx(frame.t, abs=1e-12)
        assert (table[0].view("<i4") == frame.cells.id).all()
        for row, column in zip(table[1:], lengths, strict=False):
            assert row == pytest.approx(um * getattr(frame.cells, column), rel=1e-6, abs=1e-5)
        assert table[-1] == pytest.approx(ab_positions(frame), abs=1e-5)
        assert header["height"] == (None if np.isnan(heights[frame.t]) else pytest.approx(um * height(frame)))
        names = [head["looks"][k]["name"] if k >= 0 else None for k in table[-3].view("<i4")]
        has = zip(frame.cells.events, frame.cells.emt, strict=True)
        assert names == [EVENTS[event] if k >= 0 else None for event, k in has]
        if name == "slice":
            assert (members[: header["layer"]] == frame.layers.apical).all()
        else:
            assert (members.reshape(-1, 3) == frame.sheets.apical.triangles).all()


def test_a_stream_ends_with_its_failure_or_with_its_reader():
    wild = PARAMETERS.changed({"tissue.diffusion": "1e12 um^2/h"})
    run = tissue.simulate(finely_kept(wild), 0, throw=False)
    assert run.status is not Status.SUCCESS
    assert parsed(stream(wild, 0))[-1][0] == {"kind": "end", "status": run.status.name, "detail": run.detail}

    def refused():
        yield from ()
        raise InvalidProblem("no room")

    ((header, _),) = parsed(told(refused()))
    assert header == {"kind": "end", "status": "INVALID", "detail": "no room"}
    seen = []
    pieces = stream(PARAMETERS, 3, lambda: len(seen) >= 1)
    seen.extend(iter(lambda: next(pieces, b""), b""))
    assert parsed(seen)[-1][0]["kind"] == "frame"
    assert len(parsed(seen)) < 30
    endless = PARAMETERS.changed({"numerics.t_end": "1e7 h", "numerics.keep": "1e7 h"})  # nothing to show for long
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
    lengths = np.hypot(*np.diff(np.array(head["layer"]), axis=0).T)
    assert lengths.sum() == pytest.approx(300, rel=1e-3)
    assert head["closed"]
    assert head["inside"]
    assert parsed(stream(PARAMETERS, 0))[0][0]["layer"] == []


# Numbers of the answer

RNG = np.random.default_rng(3)
FIRST, SECOND = RNG.normal(1.0, 2.0, 40), RNG.normal(0.5, 0.7, 30)
NOTHING = pd.DataFrame(columns=["what", "time_h"])


def heights(values):
    """An answer that knows the height of each run alone."""
    return Answer(len(values), 0, {}, {HEIGHT: Sample(values)}, NOTHING, {})


def test_means_have_intervals_of_all_times_and_their_bands_are_students():
    low, high = stats.t.interval(0.95, 39, FIRST.mean(), stats.sem(FIRST))
    value, below, above = means_of(np.column_stack((FIRST, 2 * FIRST)))
    assert value == pytest.approx([FIRST.mean(), 2 * FIRST.mean()])
    assert (below[1], above[1]) == pytest.approx((2 * low, 2 * high))
    assert Sample(FIRST).interval() == unbounded(FIRST)
    shares = RNG.random(20)
    assert Sample(shares, (0.0, 1.0)).interval() == bounded(shares)


def test_a_difference_is_that_of_as_many_runs_as_both_have():
    gap = difference(Sample(FIRST), Sample(SECOND))
    assert gap.value == pytest.approx((FIRST[:30] - SECOND).mean())
    assert gap.bounds is None
    shares = difference(Sample(1.0 * (FIRST > 1), (0.0, 1.0)), Sample(1.0 * (SECOND > 1), (0.0, 1.0)))
    assert shares.bounds == (-1, 1)
    assert shares.interval() == bounded(shares.values, -1, 1)


def test_what_is_decided_is_said_by_these_intervals_alone():
    def needed(one, two):
        (row,) = rows_of(heights(one), heights(two))
        return row.needed

    assert needed(FIRST + 5, SECOND) == DECIDED
    assert needed(FIRST, FIRST) == "equal so far"
    close = FIRST[:30] - SECOND - 0.4
    runs = int(needed(FIRST, SECOND + 0.4).split()[0].replace(" ", ""))
    assert runs == max(runs_to_decide(abs(close.mean()), close.std()) - 30, 1)
    (few,), (many,) = (rows_of(heights(values), None) for values in (FIRST[:3], FIRST))
    assert few.value.endswith(f", {NO_INTERVAL}")
    assert many.value.endswith("]")


# Sessions


@pytest.fixture(scope="module")
def pool():
    with workers() as threads:
        yield threads


def begin(folder, pool, **changes):
    session = Session.begin(Folder(folder), pool, THESIS.with_values(SMALL | changes))
    session.most = RUNS
    return session


def wait(session):
    """Until all runs are there; sides take them in."""
    for side in (session.now, session.held):
        while side is not None and not side.ensemble.over:
            time.sleep(0.01)
        if side is not None:
            side.catch_up()


@pytest.fixture(scope="module")
def compared(tmp_path_factory, pool):
    """Two settings side by side, and the study that was made of them, carried out."""
    session = begin(tmp_path_factory.mktemp("explored"), pool)
    session.start()
    session.hold()
    session.set_values({"emt.s": "1 h"})
    session.start()
    wait(session)
    settings = {side.name: side.setting for side in (session.held, session.now)}
    path = session.folder.save("mine", study_text("mine", settings, RUNS, session.seed))
    return session, run_study(path, session.folder.root / "results" / "mine")


def test_the_study_gives_the_numbers_of_the_page_and_sides_have_seeds_of_their_own(compared):
    session, results = compared
    rows = scenario_means(results).set_index(["scenario", "outcome"])["value"]
    for side in (session.held, session.now):
        assert results.parameters(side.name) == side.setting.parameters
        assert len(side.answer.shares) == 3
        for what, sample in side.answer.shares.items():
            assert sample.values.tolist() == results.values(side.name, what).tolist()
        assert rows[side.name, "controls_apical"] == side.answer.means["control cells apical"].value
        found = results.runs(side.name)["height_um_4h"]
        assert side.answer.means["height [µm]"].value == pytest.approx(found.mean(), rel=1e-14)
    seeds = [set(results.runs(name)["seed"]) for name in ("A", "B")]
    assert seeds[0].isdisjoint(seeds[1])
    assert session.seed_of(5) in seeds[1]
    assert session.folder.parameter_files() == []
    for row in rows_of(session.now.answer, session.held.answer):
        low, high = row.difference[row.difference.index("[") + 1 : row.difference.index("]")].split(", ")
        assert (row.needed == DECIDED) == (float(low) > 0 or float(high) < 0), row


def test_a_hundred_quick_changes_leave_no_work_behind(tmp_path, pool):
    session, left = begin(tmp_path, pool, **LONG), []
    for k in range(100):
        left.append(session.now.ensemble)
        assert session.set_values({"numerics.mu": f"{0.1 + (k + 1) / 1000:g} h"}) == ({}, [])
        assert session.now.ensemble is not left[-1]
        session.start(10_000)
        assert session.now.ensemble.busy <= cores()
    session.stop()
    while any(one.busy for one in (*left, session.now.ensemble)):
        time.sleep(0.001)
    assert all(one.over and one.runs < 100 for one in (*left, session.now.ensemble))
    assert pool._work_queue.empty()


def test_values_that_only_go_together_are_taken_together(tmp_path, pool):
    session = begin(tmp_path, pool)
    for values in ({"cell.min_cycle": "30 h"}, {"tissue.two_daughters": 0.5}):
        faults, _ = session.set_values(values)
        assert list(faults) == ["cell.min_cycle"]
    assert session.now.setting.changes["tissue.two_daughters"] == 0.5
    assert session.set_values({"cell.max_cycle": "40 h"}) == ({}, [])
    assert session.now.setting.changes["cell.min_cycle"] == "30 h"
    assert not session.pending


@pytest.mark.parametrize(
    ("error", "said"), [(InvalidProblem("no room"), "no room"), (KeyError("own"), "KeyError: 'own'")]
)
def test_runs_that_cannot_be_made_say_why(tmp_path, pool, monkeypatch, error, said):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr("tissue.study.outcomes.outcomes", fail)
    session = begin(tmp_path, pool)
    session.start()
    while not session.now.ensemble.over:
        time.sleep(0.001)
    assert (session.now.ensemble.fault, session.now.ensemble.runs) == (said, 0)


def test_files_of_the_page_are_those_of_its_setting(tmp_path, pool):
    session = begin(tmp_path, pool)
    path = session.folder.save("copy", parameters_text(session.now.setting))
    assert tissue.load(path) == session.now.setting.parameters
    session.open("copy.toml")
    assert session.now.setting.parameters == tissue.load(path)
    assert not session.now.setting.changes
    plain = session.folder.save("plain", study_text("plain", {"A": THESIS}, 8, 0))
    assert load_study(plain).scenarios["A"] == tissue.preset("thesis")
    for title, runs, name in (("", 8, "title"), ("good", 0, "replicates")):
        with pytest.raises(InvalidProblem, match=name):
            study_text(title, {"A": THESIS}, runs, 0)
    assert command("a b.toml") == "tissue study 'a b.toml' --out 'results/a b'"
