"""Damaged or half-written files of a study are computed again; a full disk costs what was not written."""

import errno
import os
from contextlib import contextmanager
from pathlib import Path

import pandas as pd
import pyarrow.parquet as pq
import pytest

import tissue
from dincl.files import replacing
from dincl.study import StudyStopped
from tests.tissue.study.stand_in import STUDY, run, stored
from tissue.study.plan import Piece
from tissue.study.store import note, part

pytestmark = pytest.mark.usefixtures("folder")


def damaged(path, how):
    data = bytearray(path.read_bytes())
    match how:
        case "flipped":
            group = pq.ParquetFile(path).metadata.row_group(0)
            largest = max(map(group.column, range(group.num_columns)), key=lambda column: column.total_compressed_size)
            begin = largest.dictionary_page_offset or largest.data_page_offset
            data[begin + largest.total_compressed_size // 2] ^= 1
        case "cut":
            del data[-50:]
        case "empty":
            data.clear()
    path.write_bytes(data)


@pytest.mark.parametrize("how", ["flipped", "cut", "empty"])
@pytest.mark.parametrize("kind", ["cells", "runs", "trajectories"])
def test_a_damaged_file_is_set_aside_and_computed_again(kind, how, computed, caplog):
    run()
    before = stored("out")
    path = sorted(Path("out", kind, "scenario=%5BA%5D").iterdir())[1]
    damaged(path, how)
    broken = path.read_bytes()
    computed.clear()
    assert run().complete
    assert stored("out") == before
    assert computed == [(1, 128)]
    assert path.with_name(f"_damaged-{path.name}").read_bytes() == broken
    (line,) = caplog.messages
    assert line == f"{path} is damaged (_damaged-{path.name}): its runs are computed again"
    assert len(pd.read_parquet(f"out/{kind}")) > 0  # passes over it


def test_a_part_of_another_study_is_not_taken_for_one_of_this(computed, caplog):
    run()
    before = stored("out")
    Path("other.toml").write_text(STUDY.format(replicates=300).replace("seed = 7", "seed = 8"), "utf-8")
    tissue.run_study("other.toml", "other")
    place = part(Path(), "cells", Piece("[A]", 128, 128))
    (Path("out") / place).write_bytes((Path("other") / place).read_bytes())
    computed.clear()
    run()
    assert computed == [(1, 128)]
    assert len(caplog.messages) == 1
    assert stored("out") == before


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"study": "x", "piece": ["[A]", 128, 128], "sha256": {}}'])
def test_a_note_that_is_none_counts_for_nothing(text, computed, caplog):
    run()
    before = stored("out")
    path = note(Path("out"), Piece("[A]", 128, 128))
    path.write_text(text, "utf-8")
    computed.clear()
    run()
    assert computed == [(1, 128)]
    assert stored("out") == before
    assert caplog.messages == [f"{path} is damaged (_damaged-{path.name}): its runs are computed again"]


def test_a_piece_whose_runs_are_gone_is_computed_again(computed):
    run()
    before = stored("out")
    part(Path("out"), "runs", Piece("[A] no INM", 256, 44)).unlink()
    computed.clear()
    run()
    assert computed == [(0, 256)]
    assert stored("out") == before


def test_half_written_files_are_removed():
    run()
    half = Path("out/cells/scenario=%5BA%5D/_partial-part-00000.parquet")
    half.write_bytes(b"half")
    run()
    assert not half.exists()


def test_a_disk_that_is_full_for_a_moment_costs_nothing(monkeypatch):
    whole = stored(tissue.run_study("small.toml", "whole").folder)
    full = part(Path("out"), "cells", Piece("[A]", 256, 44))

    tries = []

    @contextmanager
    def onto_full_disk(path):
        with replacing(path) as partial:
            if path == full and not tries:
                tries.append(partial)
                partial.symlink_to("/dev/full")
            yield partial

    monkeypatch.setattr("dincl.study.parts.replacing", onto_full_disk)
    with pytest.raises(StudyStopped, match=r"out cannot be written to: .*No space left on device"):
        run()
    assert "part-00002.parquet" in [path.name for path in full.parent.iterdir()]  # tried once more
    run()
    assert stored("out") == whole


@pytest.mark.parametrize("written", [2, 3, 4, 7, 12])
def test_a_full_disk_stops_the_study_and_keeps_what_there_is(written, monkeypatch, computed):
    whole = stored(tissue.run_study("small.toml", "whole").folder)
    computed.clear()
    calls, sync = [], os.fsync

    def full_after(descriptor):
        calls.append(descriptor)
        if len(calls) > 2 * written:  # of a file and of its folder
            raise OSError(errno.ENOSPC, "No space left on device")
        sync(descriptor)

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full_after)
        with pytest.raises(StudyStopped, match="No space left on device"):
            run()
    assert not list(Path("out").rglob("_partial-*"))
    kept = stored("out")
    assert len(kept) == written - 2  # study.json and study.toml came first
    assert kept.items() <= whole.items()
    finished = sum(name.startswith("parts") for name in kept)
    computed.clear()
    run()
    assert len(computed) == 6 - finished
    assert stored("out") == whole
