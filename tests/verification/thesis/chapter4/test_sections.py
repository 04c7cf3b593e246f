"""The tables of the EMT chapter with the presets beside each other, and what its sections end with."""

import re
from functools import cache

import pandas as pd
import pytest

from tests.executors import Nowhere
from tissue.statistics.comparisons import Difference
from tissue.statistics.proportions import corrected
from tissue.statistics.ratios import Ratio, as_ratio
from verification.page.context import Context
from verification.thesis.chapter4 import (
    differences,
    effects,
    follows,
    kept,
    open_programs,
    section_differences,
    studies,
)
from verification.thesis.chapter4.beside import COLUMNS, LABELS, beside, printed, ranked, with_ratios
from verification.thesis.chapter4.claims import s4_1_isolated
from verification.thesis.chapter4.figures import CHECKED, Pictures
from verification.thesis.chapter4.questions import QUESTIONS, answered

TABLES = {name: kept.read(name) for name in kept.COMPLETE}
BASAL = TABLES["ratios"][TABLES["ratios"]["what"] == "basal"].set_index(["study", "scenario"])


@cache
def answers():
    return answered(kept.tables())


class Noted(Nowhere):
    """Notes what is to be drawn."""

    def __init__(self):
        self.drawn = []

    def submit(self, run, /, *arguments, **_):
        self.drawn.append(arguments)


@pytest.mark.slow
@pytest.mark.parametrize("full", [False, True])
def test_figures_are_drawn_of_complete_tables_where_those_have_what_is_needed(tmp_path, full):
    context = Context(tmp_path, full, Noted(), tables=kept.tables())
    captions = [picture.caption for picture in Pictures(context, tmp_path).of(*map(int, COLUMNS["figures"]))]
    numbers = [
        int(re.search(r"Counterpart of Figure (\d+) of chapter 4 of Plunder's thesis", one)[1]) for one in captions
    ]
    assert numbers == list(range(10, 23))
    from_runs = {number for number, text in zip(numbers, captions, strict=True) if "from the complete" not in text}
    assert from_runs == {10, 11, 12, 14, 16, 22}
    both = {number for number, text in zip(numbers, captions, strict=True) if "beside each other" in text}
    # The short form has not all studies of the published preset; Figure 16 wants states that only the other keeps.
    assert both == set(numbers) - ({16} if full else {14, 16, 22})
    for number, presets, where, tables, _ in context.executor.drawn:
        assert list(presets) == (["thesis", "published"] if number in both else ["thesis"])
        assert bool(where) == (number in from_runs or (number in CHECKED and not full))
        assert bool(tables) != (full and number in from_runs)
    assert full or "from 256 runs of this page" in captions[0]


def test_presets_stand_beside_each_other():
    rows = BASAL.drop(index=list(open_programs.MORE), level="study", errors="ignore").reset_index()
    table = beside(with_ratios(rows), "ratios")
    assert list(table)[3:6] == ["Printed energies [95 %]", "Printed energies effective cells", "Printed energies runs"]
    assert len(table) == len(rows) / len(studies.PRESETS)
    row = table[(table["Study"] == "figure12") & (table["Scenario"] == "[B] no INM")].iloc[0]
    for preset, ending in (
        ("Printed energies", ""),
        ("Corrected energies", "_corrected"),
        ("Published program", "_published"),
    ):
        wanted = BASAL.loc[(f"figure12{ending}", "[B] no INM")]
        assert row[f"{preset} [95 %]"].startswith(f"{100 * wanted['value']:.1f} % [")
        assert row[f"{preset} runs"] == wanted["runs"]
    alone = beside(with_ratios(BASAL.loc[["figure10"]].reset_index()), "programs")
    assert list(alone) == ["Scenario", "Printed energies [95 %]", "Printed energies effective cells"]


def test_no_printed_ratio_or_factor_is_lost():
    shown = beside(printed(TABLES["printed"]), "printed")
    assert list(shown)[3:] == [
        f"{LABELS[name]}, {t} h"
        for name, t in zip(("thesis", "corrected", "published", "published"), (48, 48, 48, 54), strict=True)
    ]
    cells = shown.iloc[:, 3:].to_numpy().ravel()
    assert len(cells) == len(TABLES["printed"])
    assert sum("off by" in text for text in cells) == (~TABLES["printed"]["agrees"]).sum()
    assert len(beside(ranked(TABLES["ranking"]), "ranking")) == TABLES["ranking"]["factor"].nunique()


@pytest.mark.slow
def test_no_comparison_is_lost():
    compared = beside(answers(), "comparisons")
    assert len(compared) == len(answers()[["id", "compared"]].drop_duplicates())
    whole = answers().drop_duplicates(["preset", "id"])
    assert beside(whole, "answers")[""].tolist() == list(QUESTIONS)


def test_who_leaves_in_every_preset_is_counted():
    found = follows.isolated(TABLES["ratios"])
    some = dict(re.fullmatch(r"(.*) \((.*)\)", text).groups() for text in found["some"])
    for preset, ending in studies.PRESETS.items():
        for name in [*found["every"], *some]:
            study = "figure12" if "INM" in name else "figure10"
            most = BASAL.loc[(study + ending, name), "low"] > 0.5
            assert most == (name not in some or preset in some[name])
    for name in found["few"]:
        assert (
            BASAL.xs(name, level="scenario").loc[lambda rows: rows.index.str.match(r"figure1[02]"), "high"] < 0.05
        ).all()


@pytest.mark.slow
def test_groups_are_compared_with_holms_correction():
    found = follows.groups(TABLES["ratios"])
    assert found["of"] == 22
    pairs, values = [], []
    for ending in studies.PRESETS.values():
        rows = BASAL.loc[f"figure15{ending}"]
        for name in rows.index[~rows.index.str.endswith("10 cells")]:
            one = Difference(as_ratio(rows.loc[f"{name}, 10 cells"]), as_ratio(rows.loc[name]))
            pairs.append((ending, one.value))
            values.append(one.p_value())
    shown = corrected(pd.Series(values)) < 0.05
    for preset, ending in studies.PRESETS.items():
        mine = [value for (own, value), is_shown in zip(pairs, shown, strict=True) if own == ending and is_shown]
        counts = found["counts"][preset]
        assert (counts["more"], counts["less"]) == (sum(value > 0 for value in mine), sum(value < 0 for value in mine))
        assert sum(counts.values()) == 22
    mixed = follows.heterogeneous(TABLES["ratios"], TABLES["categories"])
    assert [sum(counts.values()) for counts in mixed["counts"].values()] == [18, 18, 18]
    assert set(mixed["every"]["more"]).isdisjoint(mixed["every"]["less"])


@pytest.mark.slow
def test_every_question_has_one_place():
    found = follows.questions(answers())
    names = [name for names in found["same"].values() for name in names] + found["other"]
    assert sorted(names) == sorted(QUESTIONS)


def test_apical_extrusion_is_set_beside_that_of_control_cells():
    found = follows.controls(TABLES["controls"], TABLES["ratios"])
    assert found["most"][0] == TABLES["controls"]["apical"].max()
    assert all(0 < above <= every == 74 for above, every in found["counts"].values())


def test_one_row_is_changed_at_a_time():
    changed = TABLES["changed"]
    for start in ("as printed", "published"):
        shown = section_differences.one_by_one(changed, start)
        assert list(shown["Changed"]) == ["nothing changed", *differences.ROWS, effects.COUNTING]
        agrees = changed[changed["start"] == start]["agrees"].sum()
        assert shown.iloc[:, 1:].map(lambda text: text.endswith("✓")).to_numpy().sum() == agrees


def test_unchanged_runs_give_the_ratios_of_the_studies():
    """Other seeds: the same ratios beyond chance."""
    bare = TABLES["changed"][TABLES["changed"]["row"] == ""]
    p = []
    for row in bare.itertuples():
        ending, time = ("_published", 54.0) if row.start == "published" else ("", 48.0)
        mine = {"preset": studies.preset_of(ending), "time_h": time, "scenario": row.scenario, "what": row.what}
        made = TABLES["printed"][(TABLES["printed"][list(mine)] == pd.Series(mine)).all(axis=1)].iloc[0]
        one = Difference(Ratio(row.count, row.of), Ratio(round(made["measured"] * made["runs"]), int(made["runs"])))
        p.append(one.p_value())
    assert corrected(pd.Series(p)).min() > 0.01


def test_what_makes_a_ratio_agree_is_told():
    found = section_differences.found(TABLES["changed"], TABLES["effects"])
    told = {one["ratio"]: one for one in found}
    assert told["[B] leaves basally"]["agrees"]
    assert told["[B] without INM leaves basally"]["needs"] == ["energy of the cytoskeleton"]
    assert told["[A] leaves basally"]["needs"] == ["energy of the cytoskeleton", "energy of the apical junctions"]
    assert not any(one["makes"] for one in found if not one["agrees"])
    largest = [told[name]["largest"][0] for name in ("[A] leaves basally", "[B] without INM leaves basally")]
    assert largest == ["energy of the cytoskeleton +28 [+26, +29]", "energy of the cytoskeleton +58 [+56, +60]"]


def test_the_correction_of_the_printed_ratios_has_the_effects_of_the_table():
    main = TABLES["effects"][TABLES["effects"]["with"] == ""]
    points = (100 * main["effect"]).round().astype(int).abs()
    basal = (main["what"] == "basal") & (main["scenario"] != "[B]")
    two = main["row"].isin(["energy of the cytoskeleton", "energy of the apical junctions"])
    said = s4_1_isolated._printed.correction
    assert said is not None
    assert "28 points, without INM by 40, of [B] without INM by 58" in said.depends
    assert "14, 17, 9" in said.depends
    assert sorted(points[basal & two]) == [9, 14, 17, 28, 40, 58]
    assert "no other by over 6" in said.depends
    assert (100 * main["effect"][basal & ~two]).abs().max() < 6
