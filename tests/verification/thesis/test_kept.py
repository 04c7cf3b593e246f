"""The tables that come with the repository know what makes them, and say what has changed since."""

from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

import pandas as pd
import pytest

from dincl.provenance import differences
from dincl.study.sealed import KEY, read_sealed
from dincl.study.table import ATTRIBUTE
from tests.executors import Nowhere
from verification.beyond.chart import pile_reference
from verification.page import kept
from verification.page.chapters import CHAPTERS
from verification.page.context import Context
from verification.thesis import studies
from verification.thesis.chapter5 import sampling

TABLE = pd.DataFrame({"N": [10, 100], "w1": [0.5, 0.1]})
FILES = sorted(kept.DATA.glob("*.parquet"))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_each_kept_table_names_the_command_that_makes_it(file: Path) -> None:
    module = pd.read_parquet(file).attrs[kept.MAKER]
    assert f"python -m {module}" in kept.import_module(module).__doc__


@pytest.mark.parametrize("file", sorted(kept.DATA.rglob("*.parquet")), ids=lambda file: file.stem)
def test_each_table_that_ships_has_its_checksum(file: Path) -> None:
    assert KEY.encode() in file.read_bytes()
    read_sealed(file)


@pytest.mark.slow
@pytest.mark.skipif(".dev" in version("dincl-testbed"), reason="between releases tables may be of the code before")
def test_what_ships_was_made_by_this_code(tmp_path: Path) -> None:
    """Otherwise: make kept."""
    context = Context(tmp_path, False, Nowhere(), complete=kept.STUDIES)
    for chapter in CHAPTERS:
        if chapter.name in studies.NAMES:
            chapter.run(context)
    assert {f"{name}.parquet" for name in context.studies} == {file.name for file in kept.STUDIES.glob("*.parquet")}
    found = {file.stem: kept.changes(file) for file in kept.files()}
    for name, study in context.studies.items():
        rows = read_sealed(kept.STUDIES / f"{name}.parquet")
        found[name] = differences(rows.attrs[ATTRIBUTE], study.provenance())
    assert {name: lines for name, lines in found.items() if lines} == {}


def test_a_table_knows_whether_its_code_has_changed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "table.parquet"
    kept.keep(TABLE, file, sampling.main)
    pd.testing.assert_frame_equal(pd.read_parquet(file), TABLE)
    assert kept.changes(file) == []
    table = pd.read_parquet(file)
    code = table.attrs[ATTRIBUTE]["code"]
    assert '"meanfield.transport.wasserstein"' in code
    table.attrs[ATTRIBUTE]["code"] = code.replace(
        '"meanfield.transport.wasserstein": "', '"meanfield.transport.wasserstein": "0'
    )
    table.to_parquet(file)
    assert kept.changes(file) == ["module meanfield.transport.wasserstein has changed"]


@pytest.mark.parametrize(("main", "known"), [(sampling.main, True), (pile_reference.main, False)])
def test_provenance_is_noted_only_if_all_rows_have_it(main: Callable[[], None], known: bool, tmp_path: Path) -> None:
    before, after = tmp_path / "before.parquet", tmp_path / "after.parquet"
    kept.keep(TABLE, before, main)
    kept.keep(TABLE, after, sampling.main, [pd.read_parquet(before)])
    assert (ATTRIBUTE in pd.read_parquet(after).attrs) is known
    assert bool(kept.changes(after)) is not known
