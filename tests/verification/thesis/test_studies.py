"""All studies whose tables ship: the tables have every run, and the smallest forms give rows of them again."""

from pathlib import Path

import pandas as pd
import pytest
from typer.testing import CliRunner

from dincl import study as studies
from dincl.study.table import run_names
from tests.executors import Here
from verification import cli
from verification.audit import STUDIES
from verification.site.agreement import compare_studies
from verification.site.store import shipped

# Fewer runs of these have other ratios: the smallest form has the columns alone.
FEWER = ("curved_ways_out", "emt_groups", "emt_ranking", "emt_effects")
SLOW = ("orders", "proved_", "work_", "hard", "programs", "decisions")
SLOW += ("tissue_", "emt_", "meanfield_", "space_", "curved_", "needs_", "fit_")


@pytest.mark.parametrize("name", STUDIES)
def test_the_table_that_ships_has_every_run(name: str) -> None:
    study, smallest = STUDIES[name](), STUDIES[name](smallest=True)
    assert study.name == name
    runs = set(map(study.name_of, study.runs))
    assert set(run_names(shipped(name), study.key)) == runs
    assert name in FEWER or set(map(smallest.name_of, smallest.runs)) <= runs


@pytest.mark.slow_with(*SLOW)
@pytest.mark.parametrize("name", STUDIES)
def test_the_smallest_form_gives_rows_of_the_table_that_ships(name: str) -> None:
    study, smallest, table = STUDIES[name](), STUDIES[name](smallest=True), shipped(name)
    if not smallest.runs:
        pytest.skip("a single long run")
    rows = smallest.rows(Here())
    assert set(rows) == set(table)
    found = compare_studies(rows, table, study)
    assert found.rows == (0 if name in FEWER else len(rows))
    chaotic = ".methods." in STUDIES[name].__module__  # penalties throw discs about
    assert found.apart <= (len(rows) // 50 if chaotic else 0), found.worst


@pytest.mark.slow
def test_command_make_lists_studies_and_writes_those_that_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(studies, "workers", Here)
    listed = CliRunner().invoke(cli.app, ["make"]).output
    assert [line.partition(":")[0] for line in listed.splitlines()] == list(STUDIES)
    assert CliRunner().invoke(cli.app, ["make", "stability_drift", "none"]).exit_code == 2
    made = CliRunner().invoke(cli.app, ["make", "stability_drift", "--smallest", "--out", str(tmp_path)])
    rows = pd.read_parquet(tmp_path / "made" / "stability_drift.parquet")
    assert made.exit_code == 0
    assert made.output == f"{tmp_path / 'made' / 'stability_drift'}.parquet: {len(rows)} rows\n"
