"""The chapter on EMT: its figures, corrections, factors and answers say what the tables say, in each reading."""

import math
from functools import cache
from itertools import combinations

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex

import tissue
from dincl.errors import InvalidProblem
from tests.verification.thesis.tables import CLAIMS as ALL
from tests.verification.thesis.tables import shipped_tables
from tissue.files.parameter_files import flat
from tissue.pictures.charts import OUTCOMES
from verification.audit import STUDIES
from verification.claims import Comparison, Verdict
from verification.site.store import shipped
from verification.thesis.chapter4 import differences, frequencies, groups, page, printed
from verification.thesis.chapter4.claims import s4_1_isolated
from verification.thesis.chapter4.ensembles import ENERGIES, NAMES, PRESETS, ensemble, preset_of
from verification.thesis.chapter4.frequencies import GROUPS, RATIOS, READINGS, Sized
from verification.thesis.chapter4.groups import by_importance, factors_of_cells, shuffled
from verification.thesis.chapter4.questions import QUESTIONS, QuestionAnswer, answer, answered
from verification.thesis.chapter4.ratios import happened

EMT = [name for name in STUDIES if name.startswith("emt_")]
CLAIMS = {name: claim for name, claim in ALL.items() if name.startswith("c4.")}
KEPT = shipped_tables()
END = 48.0


@cache
def tables() -> dict[str, pd.DataFrame]:
    found = {name: shipped(name) for name in EMT}
    return found | {"emt_printed": printed.compared(found), "emt_answers": answered(found)}


def coloured(panel, colour):
    return [line for line in panel.lines if to_hex(line.get_color()) == colour]


@pytest.mark.slow_with("10", "12", "14", "15", "20")
@pytest.mark.parametrize("number", page.FIGURES)
def test_figures_are_drawn(number: int, tmp_path, monkeypatch) -> None:
    """Of Figures 10 and 21 a line has the numbers of the table."""
    drawn = []
    monkeypatch.setattr(page, "write", lambda figure, path: drawn.append(figure))
    assert page.draw(number, tables(), tmp_path / "x.png") == tmp_path / "x.png"
    panels = {panel.get_title("left"): panel for panel in drawn[0].axes}
    assert all(panel.get_title("left").endswith(tuple(PRESETS)) for panel in drawn[0].axes)
    if number == 10:
        rows = tables()["emt_in_time"].query("study == 'figure10_published' and scenario == '[A]' and what == 'basal'")
        (line,) = coloured(panels["[A], published"], OUTCOMES["basal"][0])
        assert line.get_ydata() == pytest.approx((100 * rows["count"] / rows["of"]).to_numpy())
    if number == 21:
        rows = tables()["emt_groups"].query("study == 'table5_7' and given == 'onset_ab' and kind == 'no INM'")
        (line,) = coloured(panels["without INM, thesis"], page.COLOURS["table5_7"])
        assert line.get_ydata() == pytest.approx(100 * rows["value"].to_numpy())


def test_the_correction_of_the_printed_ratios_has_the_effects_of_the_table() -> None:
    main = tables()["emt_effects"].query("`with` == ''")
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


def test_control_cells_rarely_leave() -> None:
    rows = tables()["emt_in_time"].query("what == 'control cells, apical'")
    assert (rows["count"] / rows["of"]).max() < 0.01


# Differences of the presets


def test_names_of_ensembles_tell_the_reading() -> None:
    assert {preset_of(name) for name in NAMES} == set(PRESETS)
    thesis, corrected = values("thesis"), values("corrected")
    assert {key for key in thesis if thesis[key] != corrected[key]} == set(ENERGIES)
    printed_, mended = (ensemble(name).scenarios["[B] no INM"] for name in ("figure12", "figure12_corrected"))
    assert printed_.rules.spring_power != mended.rules.spring_power


# Keys of [P] and [S], which runs of the printed ratios do not have.
UNREACHED = ("events.at_depth", "events.bent_stiffness", "events.contraction", "events.spring_above")
# Written in other units, and equal.
SAME = ("cell.initial_rest_length", "tissue.diffusion", "tissue.height", "tissue.width")


def values(name: str) -> dict[str, object]:
    return flat(tissue.preset(name).as_dict())


def test_the_rows_are_all_in_which_the_presets_differ() -> None:
    thesis, published = values("thesis"), values("published")
    rows = [key for row in differences.ROWS.values() for key in row.keys]
    known = [*rows, *UNREACHED, *differences.COUNTED, *SAME]
    assert len(known) == len(set(known))
    assert set(known) == {key for key in thesis if thesis[key] != published[key]}


def test_what_is_written_in_other_units_is_equal() -> None:
    thesis = tissue.preset("thesis").changed({"numerics.t_end": "1 h"})
    other = thesis.changed({key: values("published")[key] for key in SAME})
    assert tissue.simulate(thesis, 0).table().equals(tissue.simulate(other, 0).table())


@pytest.mark.parametrize("scenario", differences.SCENARIOS)
def test_what_no_printed_ratio_reaches_changes_no_run(scenario: str) -> None:
    given = differences.Swap("", frozenset()).parameters(scenario)
    given = given.changed({"numerics.t_end": "20 h"})
    other = given.changed({key: values("published")[key] for key in UNREACHED})
    one, two = (tissue.simulate(parameters, 3).table() for parameters in (given, other))
    assert one.equals(two)


def test_no_product_of_fewer_than_six_rows_is_constant() -> None:
    signs = np.array([[row in setting.published for row in differences.ROWS] for setting in differences.design()])
    signs = np.where(signs, 1, -1)
    assert len({tuple(row) for row in signs}) == len(signs) == 2**differences.FREE
    for size in range(1, 6):
        for rows in combinations(range(signs.shape[1]), size):
            assert signs[:, rows].prod(axis=1).sum() == 0


def test_effects_are_those_of_a_known_law() -> None:
    """Ratios 0.5 + 0.2 s_1 - 0.1 s_2 s_3, with as many hits as that."""
    signs = np.array([[row in setting.published for row in differences.ROWS] for setting in differences.design()])
    signs = np.where(signs, 1.0, -1.0)
    p = 0.5 + 0.2 * signs[:, 0] - 0.1 * signs[:, 1] * signs[:, 2]
    hits = (np.arange(10) < np.round(10 * p)[:, None]).astype(float)
    found = {names: differences.effect(hits, sign)[0] for names, sign in differences.contrasts(signs)}
    names = list(differences.ROWS)
    assert found.pop((names[0], "")) == pytest.approx(0.4)
    assert found.pop((names[1], names[2])) == pytest.approx(-0.2)
    assert max(map(abs, found.values())) < 1e-12


# Ranking


def emt_cells(runs, cells, seed, odds, *, p=0.5, shared=0.0, fixed=None):
    """Cells as in Table 5, or all with the ``fixed`` times; ``odds``: the log odds to leave, given the table."""
    rng, n = np.random.default_rng(seed), runs * cells
    table = pd.DataFrame({"replicate": np.repeat(np.arange(runs), cells), "cell": np.tile(np.arange(cells), runs)})
    table["inm"] = rng.random(n) < 0.5
    for event, chance in (("a", 0.7), ("b", 0.7), ("s", 0.0), ("p", p)):
        drawn = np.where(rng.random(n) < chance, rng.uniform(6, 24, n), math.inf)
        table[f"t_{event}_h"] = drawn if fixed is None else fixed.get(event, math.inf)
    table["t_p_h"] = table[["t_p_h", "t_b_h"]].max(axis=1)
    table["onset_h"] = table[["t_a_h", "t_b_h", "t_s_h"]].min(axis=1)
    onset = pd.Series(rng.random(n), dtype="Float64")
    table["onset_ab"] = onset.where(np.isfinite(table["onset_h"]), None)
    logit = odds(table) + shared * np.repeat(rng.normal(size=runs), cells)
    leaves = rng.random(n) < 1 / (1 + np.exp(-np.asarray(logit, dtype=float)))
    return table.assign(ab_0h=0.5, ab_48h=np.where(leaves, -0.2, 0.5))


def known(table):
    """[P] decides most, then the onset, then a late [A] hinders; INM, [B] itself and the place do nothing."""
    onset = table["onset_ab"].fillna(0.5).astype(float)
    late = table["t_a_h"].where(np.isfinite(table["t_a_h"]), 15.0) - 15.0
    return -0.5 + 3 * np.isfinite(table["t_p_h"]) - 4 * (onset - 0.5) - 0.12 * late


@pytest.fixture(scope="module")
def cells():
    return emt_cells(300, 10, 1, known, shared=0.5)


@pytest.fixture(scope="module")
def hits(cells):
    return cells["ab_48h"] < 0


def test_factors_are_finite_numbers(cells):
    numbers, found = factors_of_cells(cells, END)
    assert np.isfinite(numbers.to_numpy()).all()
    assert {factor.name for factor in found} == set(numbers) - {"S", "S time"}
    by_name = {factor.name: factor for factor in found}
    assert by_name["A"].columns == ("A", "A time")
    had = happened(cells, END)["A"].to_numpy()
    assert (by_name["A time"].among == had).all()
    assert (numbers.loc[had, "A time"] == cells.loc[had, "t_a_h"]).all()
    assert numbers.loc[~had, "A time"].nunique() == 1


def test_only_cells_with_an_event_exchange_its_times(cells):
    numbers, found = factors_of_cells(cells, END)
    test = np.arange(500, 1500)
    part, rng = numbers.iloc[test], np.random.default_rng(0)
    had = happened(cells, END)["A"].to_numpy()[test]
    for factor in found:
        after = pd.DataFrame(shuffled(part, factor, test, rng), columns=part.columns)
        changed = {name for name in part if not np.array_equal(after[name], part[name])}
        assert changed == set(factor.columns)
        assert all(sorted(after[name]) == sorted(part[name]) for name in part)
        if factor.name == "A time":
            assert (after["A time"].to_numpy()[~had] == part["A time"].to_numpy()[~had]).all()
        if factor.name == "A":
            assert (
                (after["A time"] == numbers.loc[cells["t_a_h"] == np.inf, "A time"].iloc[0]) == (after["A"] == 0)
            ).all()


@pytest.mark.slow
def test_importance_finds_what_made_the_outcome(cells, hits, monkeypatch):
    monkeypatch.setattr(groups, "SHUFFLES", 2)
    found = by_importance(cells, hits, END, seed=0)
    # Shuffling [A] shuffles its time, too: both tell of the time.
    assert list(found["factor"][:2]) == ["P", "onset"]
    assert set(found["factor"][2:4]) == {"A", "A time"}
    rows = found.set_index("factor")
    assert (rows.loc[["P", "onset", "A time"], "low"] > 0).all()
    assert (rows.loc[["inm", "place", "B time", "P time", "others with [P]"], "value"].abs() < 0.01).all()
    assert (rows["low"] <= rows["value"]).all()
    assert (rows["value"] <= rows["high"]).all()
    assert (found["loss"] < 0.9 * found["without"]).all()
    assert set(found["cells"]) == {3000}
    pd.testing.assert_frame_equal(found, by_importance(cells, hits, END, seed=0))


def test_a_ranking_needs_both_outcomes(cells, hits):
    with pytest.raises(InvalidProblem, match="0 of 3000 cells in 300 replicates have the outcome"):
        by_importance(cells, hits & ~hits, END, seed=0)
    first = cells["replicate"] < 4
    with pytest.raises(InvalidProblem, match="in 4 replicates"):
        by_importance(cells[first], hits[first], END, seed=0)


# Answers and claims


def parts(held: int, refuted: int, undecided: int) -> tuple[Sized, ...]:
    """So many comparisons that hold, that do not, and that are open."""
    ends = [(1.0, 2.0)] * held + [(-2.0, -1.0)] * refuted + [(-1.0, 1.0)] * undecided
    return tuple(Sized(Comparison("x", sum(end) / 2, 0.0, float("inf"), end), 100 + k) for k, end in enumerate(ends))


@pytest.mark.parametrize(
    ("counts", "mostly", "verdict"),
    [
        ((4, 0, 0), False, Verdict.HOLDS),
        ((4, 1, 0), False, Verdict.REFUTED),
        ((4, 0, 1), False, Verdict.OPEN),
        ((3, 1, 1), True, Verdict.HOLDS),
        ((2, 2, 0), True, Verdict.REFUTED),
        ((2, 1, 1), True, Verdict.OPEN),
        ((0, 0, 0), False, Verdict.OPEN),
    ],
)
def test_an_answer_holds_if_all_or_most_of_its_comparisons_do(
    counts: tuple[int, int, int], mostly: bool, verdict: Verdict
) -> None:
    found = QuestionAnswer(parts(*counts), mostly).evidence
    assert found.verdict is verdict
    assert found.runs_needed == (99 + sum(counts) if verdict is Verdict.OPEN and any(counts) else None)


def test_kinds_of_which_no_cell_leaves_or_all_do_tell_nothing() -> None:
    assert all(answer(KEPT, question, preset).parts for question in QUESTIONS for preset in READINGS)
    names = [part.comparison.what for part in answer(KEPT, "Q5", "published").parts]
    assert not any(name.startswith("no EMT") for name in names)
    for count in (0, KEPT[RATIOS]["of"]):
        assert answer(KEPT | {RATIOS: KEPT[RATIOS].assign(count=count)}, "Q5", "published").parts == ()


def test_the_last_question_is_asked_of_cells_with_inm_and_without() -> None:
    """The mean of six kinds changes with either."""
    (mean,) = answer(KEPT, "Q8", "published").parts
    for kind in ("[A]", "[A] no INM", "[BA]", "[B] no INM"):
        table = KEPT[GROUPS]
        mine = (table["kind"] == kind) & (table["study"] == "table5_7_published")
        changed = {**KEPT, GROUPS: table.assign(count=table["count"].where(~mine, 0))}
        (less,) = answer(changed, "Q8", "published").parts
        assert less.comparison.value < mean.comparison.value


def test_orders_are_compared_at_the_same_time_of_a() -> None:
    """What the order explains is less than what it seems to explain at any time; small with corrected energies."""
    for preset in READINGS:
        found = {part.comparison.what: part.comparison for part in answer(KEPT, "Q4", preset).parts}
        for inm in ("INM", "no INM"):
            same = found[f"{inm}, [AB] minus [BA] with [A] at the same time [points]"]
            more = found[f"{inm}, [AB] minus [BA] with [A] at any time, minus with [A] at the same time [points]"]
            assert same.true or preset == "thesis"
            assert more.value > abs(same.value)


# By reading, where those differ: with the printed energies, by the published program, with the corrected energies.
READ_AS = {
    "c4.remain": "OPEN HOLDS HOLDS",
    "c4.timing-isolated": "OPEN CORRECTED CORRECTED",
    "c4.inm-swaps": "OPEN HOLDS HOLDS",
    "c4.straightness": "REFUTED HOLDS REFUTED",
    "c4.straightness-rule": "CORRECTED HOLDS CORRECTED",
    "c4.homogeneous-drop": "REFUTED CORRECTED OPEN",
    "c4.mixed-with-inm": "REFUTED HOLDS HOLDS",
    "c4.mixed-without-inm": "REFUTED HOLDS REFUTED",
    "c4.q5-mixed": "OPEN CORRECTED CORRECTED",
    "c4.almost-double": "HOLDS CORRECTED CORRECTED",
    "c4.timing": "HOLDS HOLDS OPEN",
    "c4.most-basal": "REFUTED OPEN HOLDS",
    "c4.q1": "REFUTED HOLDS HOLDS",
    "c4.q4": "OPEN HOLDS HOLDS",
    "c4.q5": "REFUTED HOLDS OPEN",
    "c4.q6": "OPEN HOLDS HOLDS",
}


# These describe the model, and are not about the outcomes of simulations.
OF_THE_MODEL = {"c4.straightness-rule"}


@pytest.mark.slow
def test_the_readings_differ_where_it_is_said_and_one_of_them_decides() -> None:
    found = {}
    for name, claim in CLAIMS.items():
        evidence = claim.decide(KEPT)
        if evidence.readings:
            decides = frequencies.READINGS["thesis" if name in OF_THE_MODEL else "published"]
            assert list(evidence.readings) == list(frequencies.READINGS.values())
            assert evidence.readings[decides].printed == evidence.printed
        readings = [claim.verdict(each).name for each in evidence.readings.values()]
        if len(set(readings)) > 1:
            found[name] = " ".join(readings)
    assert found == READ_AS
