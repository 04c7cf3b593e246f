"""Results of which a single bit has changed: the values are as before, or an error names the file that is damaged."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tissue
from dincl.errors import InvalidProblem
from dincl.study import parts
from tests.tissue.study.stand_in import outcomes, stored, study_file
from tissue.study.plan import Piece
from tissue.study.read import Results
from tissue.study.store import ABOUT, note, part, trajectory

FLIPS = 70
OUT = Path("out")


@pytest.fixture(autouse=True)
def results(tmp_path, monkeypatch):
    """Of two scenarios with two parts each, one of them short, and stored states of one replicate."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tissue.study.outcomes.outcomes", outcomes)
    study_file(".", 130)
    return tissue.run_study("small.toml", OUT)


def everything(results):
    """All that can be asked of results."""
    names = results.study.scenarios
    tables = [get(name) for name in names for get in (results.cells, results.runs)]
    tables += [results.trajectory(name, number) for name in names for number in results.study.trajectories]
    words = [results.study, results.complete, [results.parameters(name) for name in names], repr(results)]
    return [table.to_dict("tight") for table in (*tables, results.summary(), results.to_frame())], words


def flip(path, bit):
    data = bytearray(path.read_bytes())
    data[bit // 8] ^= 1 << bit % 8
    path.write_bytes(data)
    parts._remembered.cache_clear()  # as another process would begin


def as_text(value):
    """NaN is equal to NaN."""
    return json.dumps(value, default=str)


@pytest.mark.slow
def test_each_flipped_bit_changes_nothing_or_is_told(results, rng):
    whole, files = as_text(everything(results)), sorted(path for path in OUT.rglob("*") if path.stat().st_size)
    files = [path for path in files if path.is_file()]
    assert len(files) == 4 * 3 + 4 + 2
    reported = 0
    # As many of each file, and as many again where chance has it: most are in the largest ones.
    sizes = np.array([path.stat().st_size for path in files])
    chosen = [*range(len(files)), *range(len(files)), *rng.choice(len(files), FLIPS, p=sizes / sizes.sum())]
    for k in chosen:
        path, bit = files[k], int(rng.integers(8 * sizes[k]))
        flip(path, bit)
        said = ""
        try:
            assert as_text(everything(Results(OUT))) == whole, (path, bit)
        except InvalidProblem as error:
            said = str(error)
        reported += bool(said)
        assert not said or path.name in said or ("parts" in path.parts and "replicates " in said)
        flip(path, bit)
    assert reported > 0.8 * len(chosen)
    assert as_text(everything(Results(OUT))) == whole


def test_the_damaged_part_is_named_with_the_command_that_computes_it_again(results):
    piece = Piece("[A] no INM", 128, 2)
    path, whole = part(OUT, "cells", piece), stored(OUT)
    flip(path, 8 * 100)
    assert results.damaged == [path]
    assert not results.complete
    assert ", damaged, " in repr(results)
    with pytest.raises(InvalidProblem) as caught:
        results.cells("[A] no INM")
    first, second = str(caught.value).split("\n  ")
    assert "tissue study FILE --out out" in first
    assert second == f"{path}: replicates 128 to 129 of the scenario '[A] no INM'"
    assert len(results.runs("[A] no INM")) == 130  # of which nothing is damaged
    assert tissue.run_study("small.toml", OUT).complete
    assert stored(OUT) == whole


def test_a_damaged_trajectory_leaves_the_other_tables(results):
    path = trajectory(OUT, "[A]", 2)
    flip(path, 8 * 100)
    assert len(results.cells("[A]")) == 2 * 128
    with pytest.raises(InvalidProblem, match="replicate-00002"):
        results.trajectory("[A]", 2)


def test_a_note_that_names_no_checksum_of_a_file_is_told(results):
    path = note(OUT, Piece("[A]", 0, 128))
    noted = json.loads(path.read_text())
    noted["sha256"].popitem()
    path.write_text(json.dumps(noted))
    assert len(results.damaged) == 1
    assert not results.complete


@pytest.mark.parametrize(
    "change", [{"title": "other"}, {"seed": 8}, {"replicates": 129}, {"processors": []}, {"more": 1}]
)
def test_a_note_of_the_study_that_was_changed_is_refused_and_restored(change, results, caplog):
    path, whole = OUT / ABOUT, (OUT / ABOUT).read_bytes()
    path.write_text(json.dumps(json.loads(whole) | change))
    with pytest.raises(InvalidProblem, match=r"study\.json: must be as it was written, but is damaged"):
        Results(OUT)
    before = stored(OUT)
    assert tissue.run_study("small.toml", OUT).complete
    assert caplog.messages == [f"{path} is damaged (_damaged-study.json): it is written again"]
    assert path.read_bytes() == whole
    assert stored(OUT) == before


def test_a_damaged_note_is_not_replaced_by_that_of_another_study(results):
    path = OUT / ABOUT
    path.write_text("{")
    before = stored(OUT)
    Path("small.toml").write_text(Path("small.toml").read_text().replace("seed = 7", "seed = 8"))
    with pytest.raises(InvalidProblem, match=r"study\.json: must be the note of a study"):
        tissue.run_study("small.toml", OUT)
    assert path.read_text() == "{"
    assert stored(OUT) == before


def test_a_study_of_before_checksums_of_its_note_can_be_read(results):
    path = OUT / ABOUT
    noted = json.loads(path.read_text())
    noted.pop("sha256")
    path.write_text(json.dumps(noted))
    assert Results(OUT).complete


def test_each_file_is_read_for_its_checksum_once(results, monkeypatch):
    parts._remembered.cache_clear()
    read = []
    monkeypatch.setattr(parts, "checksum", lambda path, real=parts.checksum: read.append(path) or real(path))
    for _ in range(3):
        results.cells("[A]")
        assert results.complete
    assert len(read) == len(set(read)) == 2 * (2 + 2 + 2)
    pd.testing.assert_frame_equal(results.cells("[A]"), Results(OUT).cells("[A]"))


@pytest.mark.parametrize("name", ["part-99999999999", "part--1", "part-x", "part-00002"])
def test_a_note_with_the_name_of_no_piece_is_refused(results, name):
    path = note(OUT, Piece(results.study.scenarios[0], 0, 128))
    path.rename(path.with_stem(name))
    with pytest.raises(InvalidProblem, match=rf"{name}\.json: must be the note of a piece, part-NNNNN"):
        _ = Results(OUT).complete
