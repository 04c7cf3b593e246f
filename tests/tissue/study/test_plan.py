"""Study files: what they give and compare, messages, the seeds, and the studies that come with the package."""

from pathlib import Path

import pytest

import tissue
from dincl.errors import InvalidProblem
from tests.tissue.study.stand_in import COMPARE, FACTORS, HEAD, INTERACTION, write
from tissue.study.parts import Part
from tissue.study.plan import load_study, part_size, run_seeds, shipped

GOOD = """
title = "two scenarios"
base = "thesis"
replicates = 70
seed = 3
[overrides.numerics]
keep = "2 h"
[overrides.emt]
cells = 1
a = "6 h"
[scenarios."[A]"]
[scenarios."[B] / no INM"]
emt = { a = "never", b = "6 h to 24 h, 70 %", inm = 0 }
"""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def refused(text):
    with pytest.raises(InvalidProblem) as caught:
        load_study(write(text))
    first, *lines = str(caught.value).split("\n  ")
    assert first.startswith("study.toml: ")
    return lines or [first.removeprefix("study.toml: ")]


def test_a_study_is_what_its_file_says(tmp_path):
    study = load_study(write(GOOD))
    assert (study.title, study.replicates, study.seed) == ("two scenarios", 70, 3)
    assert (study.text, study.paired, study.runs) == (GOOD, False, 140)
    common = {"numerics.keep": "2 h", "emt.cells": 1}
    second = {"emt.a": "never", "emt.b": "6 h to 24 h, 70 %", "emt.inm": 0}
    assert dict(study.scenarios) == {
        "[A]": tissue.preset("thesis").changed({**common, "emt.a": "6 h"}),
        "[B] / no INM": tissue.preset("thesis").changed({**common, **second}),
    }
    (tmp_path / "mine.toml").write_text('base = "published"\n[tissue]\ncells = 51\n', "utf-8")
    study = load_study(write(GOOD.replace('"thesis"', '"mine.toml"')))
    assert study.scenarios["[A]"].tissue.cells == 51
    assert study.scenarios["[A]"].numerics.substeps == tissue.preset("published").numerics.substeps


@pytest.mark.parametrize(
    ("cells", "dimension", "runs"), [(60, 2, 32), (100, 2, 16), (222, 2, 8), (196, 3, 10), (784, 3, 2), (2304, 3, 1)]
)
def test_parts_of_large_tissues_have_few_runs(cells, dimension, runs):
    flat = {"tissue.cells": cells, "tissue.dimension": dimension}
    assert part_size(tissue.preset("published").changed(flat)) == runs


@pytest.mark.parametrize(
    ("old", "new", "messages"),
    [
        ('title = "two scenarios"', "", ["title is missing: must be a text of one line"]),
        ("replicates = 70", "replicates = 0", ["replicates = 0: must be a whole number from 1 to 10000000"]),
        ("seed = 3", "seed = -1", ["seed = -1: must be a whole number from 0 to 9223372036854775807"]),
        ("seed = 3", "sead = 3", ["seed is missing", "sead = 3: unknown key; the nearest known one is seed"]),
        ("seed = 3", "seed = 3\npaired = 1", ["paired = 1: must be true or false"]),
        ('"thesis"', '"these"', ["base = 'these': must be \"thesis\", \"corrected\", \"published\", \"chick\""]),
        ('keep = "2 h"', 'kep = "2 h"', ["scenario '[A]': numerics.kep = '2 h': unknown key; the nearest"]),
        ("inm = 0", "inm = 2", ["scenario '[B] / no INM': emt.inm = 2: must be a number from 0 to 1"]),
        ('[scenarios."[A]"]', '[scenarios.""]', ["scenarios = {'': {}, "]),
        ('[scenarios."[A]"]', f'[scenarios.{"x" * 300}]', ["is too long, empty or not printable"]),
        ('[scenarios."[A]"]', '[scenarios."[A]"]\nemt = 3', ["scenario '[A]': emt = 3: must be a section"]),
        ("seed = 3", 'seed = 3\nown.modules = ["m"]', ["put own.modules into the base, or under [overrides.own]"]),
        (GOOD[GOOD.index("[scenarios") :], "", ["scenarios is missing: must be at least one table, such as"]),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_with_key_value_and_what_is_allowed(old, new, messages):
    assert old in GOOD
    lines = refused(GOOD.replace(old, new))
    assert len(lines) == len(messages)
    assert all(message in line for message, line in zip(messages, lines, strict=True)), lines


def test_files_that_are_none_are_named(tmp_path):
    with pytest.raises(
        InvalidProblem, match="there is no such file; must be a TOML file, or a study: curved_published, figure10, "
    ):
        load_study(tmp_path / "none.toml")
    with pytest.raises(InvalidProblem, match="must be a readable TOML file"):
        load_study(write("title = "))
    (tmp_path / "mine.toml").write_text('base = "published"\n[tissue]\ncells = 0\n', "utf-8")
    (line,) = refused(GOOD.replace('"thesis"', '"mine.toml"'))
    assert line.endswith("mine.toml: tissue.cells = 0: must be a whole number from 1 to 1000000")


@pytest.mark.parametrize(
    ("emt", "remark"),
    [
        ('b = "48 h"', None),
        ('b = "48 h"\ncells = 0', '[B] never begins: emt.b = "48 h", and emt.cells = 0'),
        ('b = "60 h"', '[B] never begins: emt.b = "60 h", and numerics.t_end = "48 h"'),
        ('b = "6 h to 60 h, 5 %"', None),
    ],
)  # fmt: skip
def test_where_no_run_begins_an_event_there_is_a_remark(emt, remark):
    head = GOOD[: GOOD.index("[scenarios")].replace('a = "6 h"', "")
    study = load_study(write(f"{head}[scenarios.x.emt]\n{emt}\n[scenarios.y]\n"))
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
    study, first, last = load_study(write(GOOD)), Part("[A]", 0, 32), Part("[B] / no INM", 64, 6)
    assert study.seeds(first) == run_seeds(3, "[A]", range(32))
    paired = load_study(write(GOOD.replace("seed = 3", "seed = 3\npaired = true")))
    assert paired.seeds(last) == paired.seeds(last._replace(scenario="[A]")) != study.seeds(last)


# Factors, and [compare]


def test_levels_are_crossed_into_scenarios():
    study = load_study(write(HEAD + FACTORS))
    assert list(study.scenarios) == ["late, line", "late, arc", "early, line", "early, arc"]
    changes = {"numerics.keep": "24 h", "emt.cells": 5, "emt.a": "6 h"}
    circle = {"layer.shape": "circle", "layer.perimeter": "400 um"}
    assert study.scenarios["early, arc"] == tissue.preset("thesis").changed({**changes, **circle})
    assert study.compare is None


def test_effect_and_by_are_simple_effects_and_their_interaction():
    compare = load_study(write(HEAD + FACTORS + COMPARE)).compare
    assert compare.contrasts == {
        "early - late, line": {"late, line": -1, "early, line": 1},
        "early - late, arc": {"late, arc": -1, "early, arc": 1},
        INTERACTION: {"late, arc": -1, "early, arc": 1, "late, line": 1, "early, line": -1},
    }
    assert compare.count == 9
    assert compare.effects[INTERACTION] == ("early", "late", "arc", "line")


def test_three_times_in_two_shapes_and_a_third_factor():
    times = FACTORS.replace("early =", 'middle = { emt.a = "12 h" }\nearly =')
    more = '[factors.inm]\nwith = { emt.inm = 1 }\nwithout = { emt.inm = 0 }\n[compare]\noutcomes = ["basal"]\n'
    compare = load_study(write(HEAD + times + more + 'effect = "time"\nby = "shape"\n')).compare
    assert len(compare.contrasts) == 6
    weights = compare.contrasts["(early - late, arc) - (early - late, line)"]
    assert set(weights.values()) == {0.5, -0.5}
    assert len(weights) == 8
    alone = load_study(write(HEAD + times + more + 'effect = "inm"\n')).compare
    assert set(alone.contrasts["without - with"].values()) == {1 / 6, -1 / 6}


def test_outcomes_alone_ask_for_all_pairs_of_scenarios():
    two = '[scenarios.x]\nemt.a = "6 h"\n[scenarios.y]\nemt.b = "6 h"\n[compare]\noutcomes = ["below", "height_um"]\n'
    compare = load_study(write(f"{HEAD}{two}")).compare
    assert compare.contrasts == {"y - x": {"y": 1, "x": -1}}
    assert compare.effects == {"y - x": ("y", "x")}
    assert (compare.outcomes, compare.count) == (("below", "height_um"), 2)
    four = load_study(write(HEAD + FACTORS + COMPARE.replace('effect = "time"\nby = "shape"\n', ""))).compare
    assert len(four.contrasts) == 6
    (line,) = refused(HEAD + two.replace('[scenarios.x]\nemt.a = "6 h"\n', ""))
    assert line == "compare: must have two scenarios or more, there is y"


def test_contrasts_of_named_scenarios():
    own = '[scenarios.x]\nemt.a = "6 h"\n[scenarios.y]\nemt.b = "6 h"\n[compare]\noutcomes = ["below"]\n'
    compare = load_study(write(f'{HEAD}{own}[compare.contrasts."Is x lower?"]\nx = 1\ny = -1\n')).compare
    assert compare.contrasts == {"Is x lower?": {"x": 1, "y": -1}}
    assert compare.effects == {}


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"basal", ', '"bassal", ', "compare.outcomes = ['bassal', 'controls_apical']: must be a list of some of"),
        ('outcomes = ["basal", "controls_apical"]', "", "compare.outcomes is missing: must be a list of some of"),
        ('"ratio"', '"odds"', "compare.measures = ['difference', 'odds']: must be a list of some of difference, ratio"),
        ('"basal", "controls_apical"]\nmeasures = ["difference", "ratio"]', '"height_um"]\nmeasures = ["ratio"]',
         "compare.measures = ['ratio']: must have 'difference', too: height_um is no share of EMT cells"),
        ('effect = "time"', 'effect = "tme"', "compare.effect = 'tme': must be one of the factors: time, shape"),
        ('by = "shape"', 'by = "time"', "compare.by = 'time': must be one of the factors: shape"),
        ('effect = "time"\n', "", "compare.effect = '': must be one of the factors: time, shape"),
        ('by = "shape"', 'bye = "shape"', "compare.bye = 'shape': unknown key; the nearest known one is compare.by"),
        ('by = "shape"', 'correction = "holm"', "compare.correction = 'holm': unknown key; the nearest known one is"),
        ('by = "shape"', 'contrasts = 3', "compare.contrasts = 3: must be a table of weights of scenarios for each"),
        ('by = "shape"', 'contrasts.q = { "late, arc" = 1, "late, line" = -2 }', "compare.contrasts.'q' = {'late, "),
        ('by = "shape"', 'contrasts.q = { "late, arc" = 1, "lat" = -1 }', "compare.contrasts.'q'.'lat' = -1: must be"),
        ('by = "shape"', 'contrasts."early - late" = { "late, arc" = 1, "early, arc" = -1 }',
         "compare.contrasts.'early - late': must have another name: compare.effect asks"),
    ],
)  # fmt: skip
def test_what_is_wrong_in_compare_is_said_in_one_message(old, new, message):
    assert old in COMPARE
    (line,) = refused(HEAD + FACTORS + COMPARE.replace(old, new))
    assert line.startswith(message)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (FACTORS.replace("arc = ", "#"), "factors = {'time': "),
        (FACTORS.replace("line = {}", 'line = { emt.a = "9 h" }'), "factors time and shape both set emt.a: must set "),
        (FACTORS + '[scenarios."early, arc"]\n', "scenarios.'early, arc': must have another name: levels of factors"),
        ("", "scenarios is missing: must be at least one table"),
        (
            FACTORS + "[compare]\n",
            "compare = {}: must be a table: outcomes, and on request the factor effect,",
        ),
    ],
)
def test_factors_that_are_none(text, message):
    assert refused(HEAD + text)[0].startswith(message)


# Studies that come with the package


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
