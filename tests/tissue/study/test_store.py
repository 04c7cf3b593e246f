"""The folder of a study: what it holds, what is refused, and what continues."""

import json
from importlib.metadata import version
from pathlib import Path

import pandas as pd
import pytest

import tissue
from dincl.errors import InvalidProblem
from dincl.study.parts import fingerprint
from tests.tissue.study.stand_in import STUDY, run, stored
from tissue.study import identity, store
from tissue.study.plan import Piece, load_study
from tissue.study.store import note, opened

PARTS = [f"part-0000{k}.parquet" for k in range(3)]


pytestmark = pytest.mark.usefixtures("folder")


def refusal():
    with pytest.raises(InvalidProblem) as caught:
        run()
    return str(caught.value)


def changed(old, new):
    text = Path("small.toml").read_text("utf-8")
    assert old in text
    Path("small.toml").write_text(text.replace(old, new), "utf-8")


def test_what_is_in_the_folder():
    run()
    names = [f"cells/scenario=%5BA%5D{inm}/{name}" for inm in ("", "%20no%20INM") for name in PARTS]
    whole = [
        f"trajectories/scenario=%5BA%5D{inm}/replicate-{k:05d}.parquet" for inm in ("", "%20no%20INM") for k in (2, 129)
    ]
    notes = [name.replace("cells", "parts").replace("parquet", "json") for name in names]
    tables = sorted([*names, *(name.replace("cells", "runs") for name in names), *whole, *notes])
    files = [str(path.relative_to("out")) for path in Path("out").rglob("*") if path.is_file()]
    assert sorted(files) == sorted([*tables, "study.json", "study.lock", "study.toml"])
    assert Path("out/study.toml").read_text("utf-8") == STUDY.format(replicates=300)
    noted = json.loads(Path("out/study.json").read_text("utf-8"))
    assert list(noted["scenarios"]) == ["[A]", "[A] no INM"]
    assert noted["scenarios"]["[A] no INM"]["emt"]["inm"] == 0
    assert len(noted["processors"]) == 1


def test_a_folder_with_something_else_is_refused_and_left_alone():
    Path("out").mkdir()
    Path("out/thesis.pdf").write_text("dear", "utf-8")
    assert refusal() == "out: must be new, empty or the folder of this study; it holds thesis.pdf"
    assert [path.name for path in Path("out").iterdir()] == ["thesis.pdf"]


@pytest.mark.parametrize("text", ["{", "[]", "{}"])
def test_notes_that_are_none_are_refused(text):
    Path("out").mkdir()
    Path("out/study.json").write_text(text, "utf-8")
    assert "study.json: must be the note of a study" in refusal()


@pytest.mark.parametrize(
    ("old", "new", "difference"),
    [
        ("seed = 7", "seed = 8", "seed: 7 -> 8"),
        ("[2, 129]", "[2]", "trajectories: [2, 129] -> [2]"),
        ("inm = 0", "inm = 0.5", "scenario '[A] no INM': emt.inm: 0.0 -> 0.5"),
        ("cells = 2", "cells = 3", "every scenario: emt.cells: 2 -> 3"),
        ('[scenarios."[A]"]', '[scenarios."[Ax]"]', "scenario '[A]': is there no more\n  scenario '[Ax]': is new"),
    ],
)
def test_results_of_another_study_are_refused_with_what_differs(old, new, difference, computed):
    run()
    before, made = stored("out"), len(computed)
    changed(old, new)
    assert refusal() == f"out: holds results of another study; give another folder. What differs:\n  {difference}"
    assert stored("out") == before
    assert len(computed) == made


def test_more_replicates_go_on_with_the_rows_that_are_there(computed):
    first = run()
    assert first.as_planned
    before, rows = stored("out"), first.runs("[A]")
    computed.clear()
    changed("replicates = 300", "replicates = 420")
    grown = run()
    assert computed == [(1, 300), (1, 384), (0, 300), (0, 384)]
    assert before.items() <= stored("out").items()
    pd.testing.assert_frame_equal(grown.runs("[A]").head(300), rows)
    Path("whole.toml").write_text(STUDY.format(replicates=420), "utf-8")
    at_once = tissue.run_study("whole.toml", "whole")
    for scenario in grown.study.scenarios:
        pd.testing.assert_frame_equal(grown.cells(scenario), at_once.cells(scenario))
        pd.testing.assert_frame_equal(grown.runs(scenario), at_once.runs(scenario))
    assert grown.trajectory("[A]", 129).equals(at_once.trajectory("[A]", 129))
    assert grown.complete
    assert not grown.as_planned
    assert at_once.as_planned


def test_fewer_replicates_than_planned_are_refused(computed):
    run()
    computed.clear()
    changed("replicates = 300", "replicates = 200")
    assert refusal().startswith("out: replicates = 200: must be at least 300, which this folder was planned with")
    assert computed == []


def test_a_damaged_part_of_a_study_that_grew_is_computed_again(computed):
    run()
    changed("replicates = 300", "replicates = 320")
    run()
    before = stored("out")
    computed.clear()
    note(Path("out"), Piece("[A]", 256, 44)).write_text("", "utf-8")
    results = run()
    assert computed == [(1, 256)]
    assert results.complete
    assert results.runs("[A]")["replicate"].tolist() == list(range(320))
    assert stored("out").keys() == before.keys()


def test_a_folder_whose_identity_has_the_replicates_goes_on(computed):
    """As older versions wrote it."""
    run()
    noted = json.loads(Path("out/study.json").read_text("utf-8"))
    mark = fingerprint({key: noted[key] for key in (*identity.IDENTITY, "replicates")})
    old = json.dumps(noted).replace(noted["fingerprint"], mark)
    own = {key: value for key, value in json.loads(old).items() if key != "sha256"}
    Path("out/study.json").write_text(json.dumps({**own, "sha256": fingerprint(own)}), "utf-8")
    for path in Path("out/parts").glob("*/*.json"):
        path.write_text(path.read_text("utf-8").replace(noted["fingerprint"], mark), "utf-8")
    computed.clear()
    changed("replicates = 300", "replicates = 301")
    assert run().complete
    assert computed == [(1, 300), (0, 300)]


def test_results_of_other_code_are_refused(monkeypatch):
    run()
    other = {**identity.code(), "numba": "0.1"}
    monkeypatch.setattr(identity, "code", lambda: other)
    assert refusal().endswith(f"What differs:\n  numba: {version('numba')} -> 0.1")


def test_many_differences_are_cut_short():
    old = identity.identity(load_study("figure10"))
    new = identity.identity(load_study("figure10_published"))
    lines = identity.differences(old, new)
    assert len(lines) == identity.MOST_DIFFERENCES + 1
    assert lines[0] == "seed: 10 -> 110"
    assert lines[2].startswith("every scenario: tissue.")
    assert lines[-1].startswith("and ")


def test_the_code_version_knows_the_sources_that_make_numbers():
    code = identity.house_code.__wrapped__()
    assert code["numba"] == version("numba")
    rows = {"tissue.runs.start", "tissue.step.substeps", "tissue.study.outcomes", "tissue.runs.tables"}
    rows |= {"dincl.compiled.functions", "tissue.events.apical", "tissue.events.division", "tissue.runs.tables"}
    assert rows <= code.keys()
    aside = {
        "tissue.picture",
        "tissue.cli_study",
        "tissue.statistics.ratios",
        "tissue.study.store",
        "dincl.study.execute",
    }
    assert aside.isdisjoint(code)


def test_another_title_is_no_other_study(computed):
    run()
    made = len(computed)
    changed('"small"', '"tiny"')
    assert run().study.title == "tiny"
    assert len(computed) == made


def test_another_processor_is_told(monkeypatch, caplog):
    run()
    assert caplog.messages == []
    monkeypatch.setattr(store, "processor", lambda: "Linux x86_64 i486")
    run()
    (line,) = caplog.messages
    assert line == f"out: begun on {identity.processor()}, goes on with Linux x86_64 i486: last bits may differ"
    run()
    assert len(caplog.messages) == 1
    noted = json.loads(Path("out/study.json").read_text("utf-8"))
    assert noted["processors"] == [identity.processor(), "Linux x86_64 i486"]


def test_a_folder_in_use_is_refused():
    with store.opened(load_study("small.toml"), "out"):
        assert refusal() == "out: another process works on it, and goes on undisturbed"
    assert run().complete


def test_a_place_that_can_not_be_written_to():
    Path("out").write_text("a file", "utf-8")
    assert "out: must be a folder that can be written to: " in refusal()
    with pytest.raises(InvalidProblem, match="must be a folder that can be written to"):
        tissue.run_study("small.toml", "/proc/out")


def test_another_order_of_types_is_another_study():
    """Runs are a function of the order, the fingerprint of the identity is not."""
    text = Path("small.toml").read_text("utf-8")
    hard, soft = (
        '[overrides.types.hard]\ncells = 1\nplace = "scattered"\n',
        '[overrides.types.soft]\ncells = 1\nplace = "scattered"\n',
    )
    at = text.index("[scenarios")
    Path("small.toml").write_text(text[:at] + hard + soft + text[at:], "utf-8")
    with opened(load_study("small.toml"), "out"):
        pass
    Path("small.toml").write_text(text[:at] + soft + hard + text[at:], "utf-8")
    with pytest.raises(InvalidProblem, match="every scenario: order of types: hard, soft -> soft, hard"):
        run()
