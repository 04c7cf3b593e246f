"""Results of somebody else are data: to read them runs no Python, takes bounded memory and writes through no link."""

import os
import sys
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from typer.testing import CliRunner

import tissue
from dincl.errors import InvalidProblem
from dincl.study.parts import checksum, fingerprint, read_note, write_note
from tests.tissue.study.stand_in import outcomes, study_file
from tissue.cli.app import app
from tissue.study.identity import IDENTITY
from tissue.study.read import Results

OUT = Path("out")
WRITES = "with open('{}', 'a') as file:\n    file.write('x')\n"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tissue.study.outcomes.outcomes", outcomes)
    study_file(".", 130)
    tissue.run_study("small.toml", OUT)
    return tmp_path


def rewrite(change):
    """Change the note of the study, and all that depends on it, so that every checksum fits."""
    noted = read_note(OUT / "study.json")
    noted.pop("sha256")
    change(noted)
    noted["fingerprint"] = fingerprint({key: noted[key] for key in IDENTITY})
    write_note(OUT / "study.json", {**noted, "sha256": fingerprint(noted)})
    for path in OUT.glob("parts/*/part-*.json"):
        write_note(path, read_note(path) | {"study": noted["fingerprint"]})


def named(modules, place):
    """Name files of Python in each scenario: as a table, or as a key with a point in it."""

    def change(noted):
        for tables in noted["scenarios"].values():
            tables.pop("own", None)
            tables.update({"own": {"modules": modules}} if place == "table" else {"own.modules": modules})

    return change


def commands(*more):
    """What the commands that read results say."""
    runner = CliRunner()
    calls = (["summary"], ["summary", "--csv"], ["page"], ["figures"])
    return [runner.invoke(app, [*call, str(OUT), *more]) for call in calls]


@pytest.mark.parametrize("place", ["table", "key"])
@pytest.mark.parametrize("path", ["out/foreign_{}.py", "{}", "./out/../out/foreign_{}.py"])
def test_results_run_no_python(place, path, folder):
    name = f"{place}{len(path)}"
    file = folder / "out" / f"foreign_{name}.py"
    file.write_text(WRITES.format(folder / "RAN"))
    given = str(file) if path == "{}" else path.format(name)
    rewrite(named([given], place))
    results = Results(OUT)
    for scenario in results.study.scenarios:
        results.cells(scenario), results.runs(scenario)
        with pytest.raises(InvalidProblem, match=r"needs files of Python, .*foreign_.*: must be trusted, as"):
            results.parameters(scenario)
    results.summary(), results.to_frame(), repr(results), results.origin
    *said, _ = commands()  # that figures cannot be drawn is said of each one
    assert all("--trust" in one.output and one.exit_code == 2 for one in said)
    assert not (folder / "RAN").exists()
    assert file.stem not in sys.modules


def test_results_that_are_trusted_run_it(folder):
    file = folder / "out" / "trusted_rules.py"
    file.write_text(WRITES.format(folder / "RAN"))
    rewrite(named([str(file)], "table"))
    for said in commands("--trust"):  # the tables of the stand-in lack columns of which they would speak
        assert "--trust" not in said.output
    assert (folder / "RAN").read_text() == "x"
    assert Results(OUT).parameters("[A]").own.modules == (str(file),)  # which this process has run by now
    sys.modules.pop("trusted_rules")


@pytest.mark.parametrize("kind", ["runs", "cells"])
def test_a_table_of_many_million_rows(kind):
    """A column of one value takes a few kB, whatever its length is; checksums fit."""
    file, rows = min((OUT / kind).glob("*/part-00000.parquet")), 1 << 25
    zeros = pa.array([0], pa.int64()).take(pa.repeat(0, rows))
    pq.write_table(pa.table({"replicate": zeros}), file, compression="zstd")
    path = OUT / "parts" / file.parent.name / f"{file.stem}.json"
    noted = read_note(path)
    noted["sha256"][file.relative_to(OUT).as_posix()] = checksum(file)
    write_note(path, noted)
    with pytest.raises(InvalidProblem, match=rf"must be a table of at most 1000 times its \d+ bytes in .*{rows} rows"):
        getattr(Results(OUT), kind)("[A]")


@pytest.mark.parametrize("name", ["study.toml", "study.json"])
def test_a_link_in_the_folder_is_not_written_through(name, folder):
    (folder / "precious").write_text("precious\n")
    (OUT / name).unlink()
    (OUT / name).symlink_to(folder / "precious")
    tissue.run_study("small.toml", OUT)
    assert not (OUT / name).is_symlink()
    assert (folder / "precious").read_text() == "precious\n"


@pytest.mark.parametrize("name", ["study.json", "cells", "runs", "parts"])
def test_a_pipe_in_the_folder_is_refused_at_once(name, folder):
    file = OUT / name if name == "study.json" else next(iter(sorted((OUT / name).rglob("part-*"))))
    file.unlink()
    os.mkfifo(file)
    with pytest.raises(InvalidProblem):
        [table(one) for one in Results(OUT).study.scenarios for table in (Results(OUT).cells, Results(OUT).runs)]
