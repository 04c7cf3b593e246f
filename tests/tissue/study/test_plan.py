"""Study files: what they give, every message about a bad one, the seeds, and the studies that come with the package."""

from pathlib import Path

import pytest

import tissue
from dincl.errors import InvalidProblem
from tissue.study.plan import PART, Piece, load_study, run_seeds, shipped

GOOD = """
title = "two scenarios"
base = "thesis"
replicates = 300
seed = 3
trajectories = [5, 0]
[overrides.numerics]
keep = "2 h"
[overrides.emt]
cells = 1
a = "6 h"
[scenarios."[A]"]
[scenarios."[B] / no INM"]
emt = { a = "never", b = "6 h to 24 h, 70 %", inm = 0 }
"""


@pytest.fixture
def written(tmp_path):
    def write(text):
        path = tmp_path / "study.toml"
        path.write_text(text, "utf-8")
        return path

    return write


def refused(path):
    with pytest.raises(InvalidProblem) as caught:
        load_study(path)
    first, *lines = str(caught.value).split("\n  ")
    assert first.startswith(f"{path}: ")
    return lines or [first.removeprefix(f"{path}: ")]


def test_a_study_is_what_its_file_says(written):
    study = load_study(written(GOOD))
    assert (study.title, study.replicates, study.seed, study.trajectories) == ("two scenarios", 300, 3, (0, 5))
    assert study.text == GOOD
    common = {"numerics.keep": "2 h", "emt.cells": 1}
    second = {"emt.a": "never", "emt.b": "6 h to 24 h, 70 %", "emt.inm": 0}
    assert dict(study.scenarios) == {
        "[A]": tissue.preset("thesis").changed({**common, "emt.a": "6 h"}),
        "[B] / no INM": tissue.preset("thesis").changed({**common, **second}),
    }


def test_the_base_may_be_a_file_beside_the_study(written, tmp_path):
    (tmp_path / "mine.toml").write_text('base = "published"\n[tissue]\ncells = 51\n', "utf-8")
    study = load_study(written(GOOD.replace('"thesis"', '"mine.toml"')))
    assert study.scenarios["[A]"].tissue.cells == 51
    assert study.scenarios["[A]"].numerics.substeps == tissue.preset("published").numerics.substeps


def test_pieces_hold_every_replicate_once(written):
    study = load_study(written(GOOD))
    assert list(study.pieces())[:3] == [Piece("[A]", 0, PART), Piece("[A]", 128, PART), Piece("[A]", 256, 44)]
    runs = [(piece.scenario, number) for piece in study.pieces() for number in piece.replicates]
    assert len(runs) == len(set(runs)) == study.runs == 600
    assert PART % 8 == 0


@pytest.mark.parametrize(
    ("old", "new", "messages"),
    [
        ('title = "two scenarios"', "", ["title is missing: must be a text of one line"]),
        ("replicates = 300", "replicates = 0", ["replicates = 0: must be a whole number from 1 to 10000000"]),
        ("seed = 3", "seed = -1", ["seed = -1: must be a whole number from 0 to 9223372036854775807"]),
        ("seed = 3", "sead = 3", ["sead = 3: unknown key; the nearest known one is seed", "seed is missing"]),
        ("[5, 0]", "[5, 5]", ["trajectories = [5, 5]: must be a list of different replicates"]),
        ("[5, 0]", "[300]", ["trajectories = [300]: must be below replicates = 300"]),
        ('"thesis"', '"these"', ["base = 'these': must be \"thesis\", \"corrected\", \"published\", \"chick\""]),
        ('keep = "2 h"', 'kep = "2 h"', ["every scenario: numerics.kep = '2 h': unknown key; the nearest"]),
        ("inm = 0", "inm = 2", ["scenario '[B] / no INM': emt.inm = 2: must be a number from 0 to 1"]),
        ("a = \"never\", b", 'b = "never", p = "6 h", b2', ["emt.b2 = '6 h to 24 h, 70 %'", "[P] waits for [B]"]),
        ('[scenarios."[A]"]', '[scenarios.""]', ["scenarios = {'': {}, ", "'' is too long, empty or not printable"]),
        ('[scenarios."[A]"]', f'[scenarios.{"x" * 300}]', ["is too long, empty or not printable"]),
        ('[scenarios."[A]"]', '[scenarios."[A]"]\nemt = 3', ["scenario '[A]': emt = 3: unknown key"]),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_with_key_value_and_what_is_allowed(written, old, new, messages):
    assert old in GOOD
    lines = refused(written(GOOD.replace(old, new)))
    for message in messages:
        assert any(message in line for line in lines), lines
    assert len(lines) <= len(messages)


def test_a_study_without_scenarios(written):
    text = GOOD[: GOOD.index("[scenarios")]
    assert refused(written(text)) == [
        'scenarios is missing: must be at least one table, such as [scenarios."[A]"], of sections of parameters'
    ]
    assert "scenarios = {}: must be" in refused(written(text + "[scenarios]\n"))[0]


def test_all_errors_are_in_one_message(written):
    text = GOOD.replace("replicates = 300", "replicates = -1").replace('"2 h"', '"2 um"').replace("inm = 0", "inm = 2")
    lines = refused(written(text))
    assert [line.partition(" = ")[0] for line in lines] == [
        "replicates",
        "every scenario: numerics.keep",
        "scenario '[B] / no INM': emt.inm",
    ]


def test_a_file_that_is_none_names_the_studies_that_are(tmp_path):
    with pytest.raises(
        InvalidProblem, match="there is no such file; must be a TOML file, or a study: curved_published, figure10, "
    ):
        load_study(tmp_path / "none.toml")
    bad = tmp_path / "bad.toml"
    bad.write_text("title = ", "utf-8")
    with pytest.raises(InvalidProblem, match="must be a readable TOML file"):
        load_study(bad)


def test_a_base_that_is_bad_is_told(written, tmp_path):
    (tmp_path / "mine.toml").write_text('base = "published"\n[tissue]\ncells = 0\n', "utf-8")
    (line,) = refused(written(GOOD.replace('"thesis"', '"mine.toml"')))
    assert line.endswith("mine.toml: tissue.cells = 0: must be a whole number from 1 to 1000000")


@pytest.mark.parametrize(
    ("emt", "remark"),
    [
        ('b = "12 h", p = "6 h"', "[P] at 6 h waits for [B] at 12 h"),
        ('b = "12 h", p = "12 h"', None),
        ('b = "6 h to 24 h, 70 %", p = "7 h"',
         "[P] (7 h) waits for [B] (6 h to 24 h, 70 %) where [B] is later, and does not begin in cells without [B]"),
        ('b = "6 h to 24 h", p = "6 h to 24 h"', "[P] (6 h to 24 h) waits for [B] (6 h to 24 h) where [B] is later"),
        ('b = "6 h to 9 h"', None),
        ('b = "48 h"', None),
        ('b = "60 h"', '[B] never begins: emt.b = "60 h", and numerics.t_end = "48 h"'),
        ('b = "6 h to 60 h, 5 %"',
         '[B] does not begin in all cells: emt.b = "6 h to 60 h, 5 %", and numerics.t_end = "48 h"'),
    ],
)  # fmt: skip
def test_where_an_event_waits_or_is_late_there_is_a_remark(written, emt, remark):
    head = GOOD[: GOOD.index("[scenarios")].replace('a = "6 h"', "")
    study = load_study(written(f"{head}[scenarios.x]\nemt = {{ {emt} }}\n[scenarios.y]\n"))
    assert study.remarks == ([f"scenario 'x': {remark}"] if remark else [])


def test_seeds_are_a_function_of_study_scenario_and_replicate():
    seeds = run_seeds(1, "[A]", range(1000))
    assert seeds[:2] == [2176706722546484908, 1253807600118948024]  # as long as this holds, old results can be repeated
    assert run_seeds(1, "[A]", [999, 3]) == [seeds[999], seeds[3]]
    others = [run_seeds(study, name, range(1000)) for study, name in ((2, "[A]"), (1, "[A] "), (1, "[B]"))]
    every = [seed for part in (seeds, *others) for seed in part]
    assert len(set(every)) == 4000
    assert all(0 <= seed < 2**63 for seed in every)
    assert max(every) > 2**62


def times(study):
    """(N^EMT, INM, T^P, T^A, T^B, T^S) of each scenario, in the columns of the tables of chapter 4."""
    emts = {name: parameters.emt for name, parameters in load_study(study).scenarios.items()}
    return {name: (emt.cells, emt.inm, *map(str, (emt.p, emt.a, emt.b, emt.s))) for name, emt in emts.items()}


@pytest.mark.parametrize("suffix", ["", "_published"])
def test_tables_1_to_3_of_chapter_4(suffix):
    never = "never"
    assert times(f"figure10{suffix}") == {
        "[A]": (1, 1, never, "12 h", never, never),
        "[B]": (1, 1, never, never, "12 h", never),
        "[S]": (1, 1, never, never, never, "12 h"),
        "[BP]": (1, 1, "24 h", never, "12 h", never),
    }
    assert times(f"figure12{suffix}") == {
        "[A] no INM": (1, 0, never, "12 h", never, never),
        "[B] no INM": (1, 0, never, never, "12 h", never),
        "[S] no INM": (1, 0, never, never, never, "12 h"),
        "no EMT no INM": (1, 0, never, never, never, never),
    }
    assert times(f"figure14{suffix}") == {
        "[AxB]": (1, 1, never, "6 h", "24 h", never),
        "[AB]": (1, 1, never, "15 h", "15 h", never),
        "[BxA]": (1, 1, never, "24 h", "6 h", never),
    }


@pytest.mark.parametrize("suffix", ["", "_published"])
def test_table_4_of_chapter_4(suffix):
    table = [(row[2:], *row[:2]) for row in times(f"figure15{suffix}").values()]
    rows = [
        ("18 h", "6 h", "12 h"), ("18 h", "12 h", "6 h"), ("6 h", "never", "6 h"), ("18 h", "never", "6 h"),
        ("never", "6 h", "18 h"), ("never", "18 h", "6 h"), ("never", "6 h", "never"), ("never", "18 h", "never"),
        ("never", "never", "6 h"), ("never", "never", "18 h"), ("never", "never", "never"),
    ]  # fmt: skip
    assert sorted(table) == sorted(((*row, "never"), n, inm) for row in rows for n in (1, 10) for inm in (0, 1))
    assert times(f"figure15{suffix}")["[BxA] no INM, 10 cells"] == (10, 0, "never", "18 h", "6 h", "never")


def test_table_5_of_chapter_4():
    for name, percent in (("63", 90), ("35", 50), ("7", 10)):
        (row,) = times(f"table5_{name}").values()
        some = "6 h to 24 h, 70 %"
        assert row == (10, 0.5, f"6 h to 24 h, {percent} %", some, some, "never")
        assert load_study(f"table5_{name}").replicates == 50_000


def test_every_study_that_comes_with_the_package():
    assert len(shipped()) >= 12
    studies = {name: load_study(name) for name in shipped()}
    assert len({study.seed for study in studies.values()}) == len(studies)
    for name, study in studies.items():
        preset = tissue.preset("published" if "published" in name else "thesis")
        for parameters in study.scenarios.values():
            assert parameters.t_end == preset.t_end
            cells = {1: 51, 10: 45}.get(parameters.emt.cells, 784) if "published" in name else 60
            assert parameters.tissue.cells == cells
            assert parameters.in_space == (cells == 784)
    assert Path(tissue.__file__).parent.joinpath("studies").is_dir()


def test_keys_that_nothing_reads_are_told(written):
    text = GOOD.split("[scenarios", maxsplit=1)[0].replace('cells = 1\na = "6 h"', "cells = 1")
    wide = 'layer.perimeter = "250 um"\nspace.boundary = "open"\n'
    study = load_study(written(f"{text}[scenarios.one]\n[scenarios.wide]\n{wide}"))
    assert study.remarks == [
        'scenario \'wide\': nothing reads layer.perimeter = "250 um": layer.shape = "line"',
        "scenario 'wide': nothing reads space.boundary = \"open\": tissue.dimension = 2",
        "scenarios 'one', 'wide' differ only in keys that nothing reads",
    ]
    arc = 'layer = { shape = "circle", perimeter = "400 um", aspect = 2, side = "outside" }\n'
    study = load_study(written(f"{text}[scenarios.one]\n[scenarios.arc]\n{arc}"))
    assert study.remarks == ["scenario 'arc': nothing reads layer.aspect = 2.0: layer.shape = \"circle\""]


def test_modules_belong_into_the_base(written):
    (line,) = refused(written(GOOD.replace("[overrides.numerics]", 'own.modules = ["m.py"]\n[overrides.numerics]')))
    assert line.endswith("put own.modules into the base, or under [overrides.own]")
