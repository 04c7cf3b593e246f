"""Contract of a study's folder: interrupted, resumed, refused if other, grown, readable, the same by any executor."""

import errno
import json
import os
import pickle
import sys
import threading
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from typer.testing import CliRunner

import tissue
from dincl.errors import InvalidProblem
from dincl.study import DamagedTable, StudyStopped
from tests.tissue.study.stand_in import outcomes, run, stored, study_file
from tissue.cli.app import app
from tissue.study.outcomes import outcomes as simulated
from tissue.study.plan import load_study, run_seeds
from tissue.study.read import Results
from tissue.study.store import opened

HOME = "tissue.study.outcomes.outcomes"
# First replicates of the parts, by whether their cells have INM.
PARTS = [(inm, first) for inm in (1, 0) for first in (0, 32, 64)]
OUT = Path("out")


@pytest.fixture(autouse=True)
def computed(tmp_path, monkeypatch):
    """The parts that are computed, in a folder with the study of the stand-in."""
    calls = []

    def counted(parameters, replicates, *rest):
        calls.append((parameters.emt.inm, replicates[0]))
        return outcomes(parameters, replicates, *rest)

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(HOME, counted)
    study_file(".")
    return calls


@pytest.fixture
def whole():
    """The tables of a run without interruption."""
    return stored(tissue.run_study("small.toml", "whole").folder)


def change(old, new):
    text = Path("small.toml").read_text("utf-8")
    assert old in text
    Path("small.toml").write_text(text.replace(old, new), "utf-8")


def refusal():
    with pytest.raises(InvalidProblem) as caught:
        run()
    return str(caught.value)


# The same by any executor


@pytest.mark.parametrize("workers", [1, 5])
def test_files_are_the_same_for_any_number_of_workers(workers, whole):
    told = []
    with ThreadPoolExecutor(workers) as executor:
        run(executor=executor, watch=told.append)
    assert stored("out") == whole
    assert len(whole) == 2 * (3 + 3)
    assert (told[0], told[-1], len(told)) == (0, 140, 7)


@pytest.mark.slow
def test_files_are_the_same_from_workers_of_dask(whole):
    from distributed import Client

    with Client(processes=False, n_workers=2, threads_per_worker=1, dashboard_address=None) as client:
        assert run(executor=client.get_executor()).complete
    assert stored("out") == whole


# A small study of the simulation itself, in a slice and in space.
REAL = """
title = "real"
base = "published"
replicates = 5
seed = 5
[overrides.numerics]
t_end = "1 h"
keep = "0.5 h"
folded = "keep"
[overrides.tissue]
cells = 8
[scenarios.slice]
emt = { cells = 2, a = "0.5 h" }
[scenarios.space]
tissue = { dimension = 3, cells = 36, two_daughters = 1 }
space.boundary = "open"
emt = { cells = 2, b = "0.5 h" }
"""


@pytest.mark.slow
def test_rows_of_the_simulation_stopped_and_taken_up_by_processes_are_those_of_single_runs(monkeypatch):
    monkeypatch.setattr(HOME, simulated)
    Path("real.toml").write_text(REAL)
    whole = tissue.run_study("real.toml", "whole")

    def interrupted_in_space(parameters, *rest):
        if parameters.in_space:
            raise KeyboardInterrupt
        return simulated(parameters, *rest)

    with monkeypatch.context() as patch, ThreadPoolExecutor(1) as executor:
        patch.setattr(HOME, interrupted_in_space)
        with pytest.raises(KeyboardInterrupt):
            tissue.run_study("real.toml", "out", executor)
    assert 0 < len(stored("out")) < len(stored("whole"))
    with ProcessPoolExecutor(2, get_context("forkserver")) as executor:
        tissue.run_study("real.toml", "out", executor)
    assert stored("out") == stored("whole")
    for name in ("slice", "space"):
        seeds = run_seeds(5, name, range(5))
        assert whole.runs(name)["seed"].tolist() == seeds
        alone = tissue.simulate(whole.parameters(name), seeds[1])
        assert whole.runs(name).loc[1, "height_um_1h"] == pytest.approx(
            alone.summary()["height_um"].iloc[-1], rel=1e-12
        )
        assert whole.cells(name)["ab_1h"].nunique() == 10


# Interrupted and resumed


def failing(error, at):
    def fails(parameters, replicates, *rest):
        if (parameters.emt.inm, replicates[0]) == at:
            raise error
        return outcomes(parameters, replicates, *rest)

    return fails


@pytest.mark.parametrize("error", [ZeroDivisionError("no"), KeyboardInterrupt(), BrokenExecutor("gone")])
@pytest.mark.parametrize("workers", [1, 3])
def test_an_error_leaves_what_was_computed_and_the_rest_comes_later(error, workers, whole, monkeypatch, computed):
    with monkeypatch.context() as patch:
        patch.setattr(HOME, failing(error, (1, 64)))
        expected = StudyStopped if isinstance(error, BrokenExecutor) else type(error)
        with ThreadPoolExecutor(workers) as executor, pytest.raises(expected):
            run(executor=executor)
    assert stored("out").items() < whole.items()
    results = Results("out")
    assert not results.complete
    assert not results.as_planned
    assert results.runs("[A]")["replicate"].tolist() == list(range(64))
    computed.clear()
    assert run().complete
    assert {(1, 64)} <= set(computed) <= set(PARTS) - {(1, 0), (1, 32)}
    assert stored("out") == whole


def test_parts_under_way_are_stored_when_another_fails(monkeypatch):
    begun, failed = threading.Event(), threading.Event()

    def together(parameters, replicates, *rest):
        if replicates[0] == 0:
            begun.wait()
            failed.set()
            raise ZeroDivisionError
        begun.set()
        failed.wait()
        return outcomes(parameters, replicates, *rest)

    monkeypatch.setattr(HOME, together)
    with ThreadPoolExecutor(2) as executor, pytest.raises(ZeroDivisionError):
        run(executor=executor)
    assert Results("out").runs("[A]")["replicate"].tolist()[:32] == list(range(32, 64))


@pytest.mark.parametrize("written", [2, 3, 4, 7, 12])
def test_a_full_disk_stops_the_study_and_keeps_what_there_is(written, monkeypatch, computed, whole):
    calls, sync = [], os.fsync

    def full_after(descriptor):
        calls.append(descriptor)
        if len(calls) > 2 * written:  # of a file and of its folder
            raise OSError(errno.ENOSPC, "No space left on device")
        sync(descriptor)

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full_after)
        with pytest.raises(StudyStopped, match=r"out cannot be written to: .*No space left on device"):
            run()
    assert not list(OUT.rglob("_partial-*"))
    kept = stored("out")
    assert len(kept) == written - 2  # study.json and study.toml came first
    assert kept.items() <= whole.items()
    there = {name: [part.first for part in opened_parts().stored(name)] for name in ("[A]", "[A] no INM")}
    computed.clear()
    run()
    assert len(computed) == 6 - sum(map(len, there.values()))
    assert stored("out") == whole


def opened_parts():
    with opened(load_study("small.toml"), "out") as parts:
        return parts


def test_more_replicates_go_on_with_the_rows_that_are_there(computed):
    first = run()
    assert first.as_planned
    before = stored("out")
    computed.clear()
    change("replicates = 70", "replicates = 100")
    grown = run()
    assert computed == [(inm, first) for inm in (1, 0) for first in (70, 96)]
    assert before.items() <= stored("out").items()
    at_once = tissue.run_study("small.toml", "whole")
    for scenario in grown.study.scenarios:
        pd.testing.assert_frame_equal(grown.cells(scenario), at_once.cells(scenario))
        pd.testing.assert_frame_equal(grown.runs(scenario), at_once.runs(scenario))
    assert (grown.complete, grown.as_planned, at_once.as_planned) == (True, False, True)
    computed.clear()
    for file in OUT.glob("runs/*5D/*-0006[49]*"):
        file.unlink()
    assert run().runs("[A]")["replicate"].tolist() == list(range(100))
    assert computed == [(1, 64)]


# Refused if other

SOFT, HARD = (f'[overrides.types.{name}]\ncells = 1\nplace = "scattered"\n' for name in ("soft", "hard"))


@pytest.mark.parametrize(
    ("old", "new", "difference"),
    [
        ("seed = 7", "seed = 8", "seed: 7 -> 8"),
        ("seed = 7", "seed = 7\npaired = true", "paired: False -> True"),
        ("inm = 0", "inm = 0.5", "scenario '[A] no INM': emt.inm: 0.0 -> 0.5"),
        ('"thesis"', '"published"', "scenario '[A]': tissue.cells: 60 -> 45"),
        ('.types.soft]', '.types.late]', "scenario '[A]': types.soft.cells: 1 -> None"),
        (SOFT + HARD, HARD + SOFT, "scenario '[A]': order of types: ['soft', 'hard'] -> ['hard', 'soft']"),
    ],
)  # fmt: skip
def test_results_of_another_study_are_refused_with_what_differs(old, new, difference, computed):
    change('[scenarios."[A]"]', f'{SOFT}{HARD}[scenarios."[A]"]')
    run()
    before, made = stored("out"), len(computed)
    change(old, new)
    head, *lines = refusal().split("\n  ")
    assert head == "out: holds results of another study; give another folder. What differs:"
    assert difference in lines
    assert len(lines) <= 13
    assert (stored("out"), len(computed)) == (before, made)


def test_results_of_another_version_are_refused(monkeypatch):
    run()
    monkeypatch.setattr("tissue.study.store.version_of", lambda _: "0.1")
    assert refusal().endswith(" -> '0.1'")


def test_a_worker_with_other_code_is_refused(monkeypatch):
    here = threading.current_thread()
    monkeypatch.setattr("tissue.study.run.code", lambda: {"tissue": "ab"[threading.current_thread() is here]})
    with pytest.raises(StudyStopped, match=r"a worker has other code, {'tissue': 'a'}: must be {'tissue': 'b'}"):
        run()


def test_a_folder_that_is_not_of_this_study_is_refused_and_left_alone(computed):
    assert run().complete
    change("replicates = 70", "replicates = 60")
    assert refusal().startswith("out: replicates = 60: must be at least 70, which this folder was planned with")
    OUT.joinpath("study.json").unlink()
    assert refusal() == "out: must be new, empty or the folder of this study; it holds cells, columns.csv, runs"
    Path("file").write_text("")
    for place in ("file", "/proc/out"):
        with pytest.raises(InvalidProblem, match="must be a folder that can be written to"):
            tissue.run_study("small.toml", place)
    with opened(load_study("small.toml"), "new"), pytest.raises(InvalidProblem, match="another process works on it"):
        tissue.run_study("small.toml", "new")


@pytest.mark.parametrize("text", ["{", "[]", "{}", "[" * 100_000])
def test_records_that_are_none_are_refused(text):
    OUT.mkdir()
    OUT.joinpath("study.json").write_text(text, "utf-8")
    assert "study.json: must be the record of a study" in refusal()


def test_another_title_or_comparison_is_no_other_study(computed):
    run()
    made = len(computed)
    change('"small"', '"tiny"')
    assert run().study.title == "tiny"
    assert OUT.joinpath("study.toml").read_text("utf-8") == Path("small.toml").read_text("utf-8")
    assert len(computed) == made


# Readable


def test_results_are_the_tables_in_order():
    results = run()
    record = results.study
    assert (record.title, record.replicates, record.seed) == ("small", 70, 7)
    for name, parameters in load_study("small.toml").scenarios.items():
        assert results.parameters(name) == parameters
        made = outcomes(parameters, list(range(70)), run_seeds(7, name, range(70)))
        pd.testing.assert_frame_equal(results.cells(name), made.cells.to_pandas())
        pd.testing.assert_frame_equal(results.runs(name), made.runs.to_pandas())
    assert results.cells("[A]", ["ab_0h", "cell"]).columns.tolist() == ["ab_0h", "cell"]
    counts = {"scenario": ["[A]", "[A] no INM"], "runs": [70, 70], "failed": [1, 1], "folded": [0, 0]}
    assert results.summary().to_dict("list") == counts
    assert [len(results.cells(name)) for name in record.scenarios] == [138, 138]
    assert "2 scenarios of 70 runs, complete" in results._repr_html_()
    assert "<th>0</th>" not in results._repr_html_()
    assert results.origin["runs of each scenario, as planned"] == "70"
    assert {"dincl-testbed", "numba", "numpy"} <= results.origin.keys()
    assert repr(pickle.loads(pickle.dumps(results))) == repr(results)
    assert len(pd.read_parquet("out/cells")) == 276  # as other programs read them


def test_results_refuse_what_is_not_there():
    with pytest.raises(InvalidProblem, match="none: must be the folder of a study"):
        Results("none")
    results = run()
    with pytest.raises(InvalidProblem, match=r"scenario = 'A': must be one of '\[A\]', '\[A\] no INM'"):
        results.cells("A")
    with pytest.raises(InvalidProblem, match=r"columns = \['ab'\]: must be of replicate, cell, extruded, ab_0h"):
        results.cells("[A]", ["cell", "ab"])
    for file in OUT.glob("runs/*/*"):
        file.unlink()
    assert results.summary()["runs"].tolist() == [0, 0]
    assert "not complete" in repr(results)
    with pytest.raises(InvalidProblem, match="nothing of the scenario '\\[A\\]' is stored yet"):
        results.cells("[A]")


@pytest.mark.parametrize("how", ["half written", "flipped", "cut", "empty", "pipe"])
@pytest.mark.parametrize("kind", ["cells", "runs"])
def test_a_damaged_file_is_named_and_computed_again_once_it_is_removed(kind, how, whole, computed):
    """A part of which a file is not there is none."""
    results = run()
    path = sorted(OUT.glob(f"{kind}/*5D/*"))[1]
    data = bytearray(path.read_bytes())
    if how == "flipped":
        column = pq.ParquetFile(path).metadata.row_group(0).column(0)
        data[(column.dictionary_page_offset or column.data_page_offset) + column.total_compressed_size - 1] ^= 1
    path.unlink()
    if how == "half written":
        path.with_name(f"_partial-{path.name}").write_bytes(data)
        assert results.runs("[A]")["replicate"].tolist() == [*range(32), *range(64, 70)]
    else:
        if how == "pipe":  # to open one would wait
            os.mkfifo(path)
        else:
            path.write_bytes({"cut": data[:-50], "empty": b""}.get(how, data))
        with pytest.raises(DamagedTable, match=f"{path.name}: must be as it was written, but .*; .*remove it to have"):
            getattr(results, kind)("[A]")
        path.unlink()
    computed.clear()
    assert run().complete
    assert computed == [(1, 32)]
    assert stored("out") == whole
    assert not list(OUT.rglob("_partial-*"))


# Results of somebody else are data


def named(modules, place):
    """Name files of Python in each scenario of the record: as a table, or as a key with a point in it."""
    record = json.loads(OUT.joinpath("study.json").read_text())
    for tables in record["parameters"].values():
        tables.pop("own", None)
        tables.update({"own": {"modules": modules}} if place == "table" else {"own.modules": modules})
    OUT.joinpath("study.json").write_text(json.dumps(record))


def commands(*more):
    """What the commands that read results say."""
    calls = (["summary"], ["summary", "--csv"], ["page"])
    return [CliRunner().invoke(app, [*call, str(OUT), *more]) for call in calls]


@pytest.mark.parametrize("place", ["table", "key"])
@pytest.mark.parametrize("given", ["out/foreign_{}.py", "{}", "./out/../out/foreign_{}.py"])
def test_results_run_python_only_if_they_are_trusted(place, given, tmp_path):
    run()
    name = f"{place}{len(given)}"
    file, ran = tmp_path / "out" / f"foreign_{name}.py", tmp_path / "RAN"
    file.write_text(f"with open({str(ran)!r}, 'a') as ran:\n    ran.write('x')\n")
    named([str(file) if given == "{}" else given.format(name)], place)
    results = Results(OUT)
    for scenario in results.study.scenarios:
        results.cells(scenario), results.runs(scenario)
        with pytest.raises(InvalidProblem, match=r"needs files of Python, .*foreign_.*: must be trusted, as"):
            results.parameters(scenario)
    results.summary(), repr(results), results.origin
    assert all("--trust" in one.output and one.exit_code == 2 for one in commands())
    assert not ran.exists()
    assert file.stem not in sys.modules
    assert not any("--trust" in one.output for one in commands("--trust"))
    assert ran.read_text() == "x"
    assert Results(OUT).parameters("[A]").own.modules == (str(file),)  # which this process has run by now
    sys.modules.pop(file.stem)


def test_a_small_file_of_many_million_rows_is_refused():
    results, rows = run(), 1 << 24
    zeros = pa.array([0], pa.int64()).take(pa.repeat(0, rows))
    pq.write_table(pa.table({"replicate": zeros}), min(OUT.glob("runs/*5D/*")), compression="zstd")
    with pytest.raises(InvalidProblem, match=rf"must be a table of at most 1000 times its \d+ bytes in .*{rows} rows"):
        results.runs("[A]")


@pytest.mark.parametrize("name", ["study.toml", "study.json"])
def test_a_link_in_the_folder_is_not_written_through(name):
    run()
    Path("precious").write_bytes(OUT.joinpath(name).read_bytes())
    before = Path("precious").read_bytes()
    (OUT / name).unlink()
    (OUT / name).symlink_to(Path("precious").resolve())
    change('"small"', '"tiny"')
    run()
    assert not (OUT / name).is_symlink()
    assert Path("precious").read_bytes() == before
