"""The chapter on EMT from its studies to the page, and the numbers it is made of."""

import re

import numpy as np
import pandas as pd
import pytest

from dincl.errors import InvalidProblem
from tests.executors import Here, Nowhere
from tests.verification.thesis.shortened_emt import FEW, emt_form
from tests.verification.undrawn import draw_nothing
from verification.page.context import Context
from verification.page.report import write_report
from verification.thesis.chapter4 import kept, printed, sensitivity, studies, summaries
from verification.thesis.chapter4 import page as chapter
from verification.thesis.chapter4.claims import s3_1_counts

pytestmark = pytest.mark.slow

FORM = emt_form(FEW)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    context = Context(tmp_path_factory.mktemp("report"), False, Here(), [FORM])
    with pytest.MonkeyPatch.context() as patch:
        draw_nothing(patch)
        write_report([chapter.CHAPTER], context)
    return (context.out / "emt.html").read_text("utf-8"), context


def test_the_page_shows_all_figures_and_printed_tables(made):
    text, context = made
    drawn = [path for path in (context.out / "figures").iterdir() if not path.name.startswith("card_")]
    assert len(drawn) > 10
    assert not re.search(r"\bnan\b", text)
    for row in kept.read("printed").itertuples():
        assert f"<td>{row.scenario}</td>" in text


def test_a_second_call_runs_nothing(made):
    again = Context(made[1].out, False, Nowhere(), [FORM])
    chapter.run(again)
    for name, table in again.tables.items():
        pd.testing.assert_frame_equal(table, made[1].tables[name])


def test_tables_say_what_the_cells_say(made):
    """Counted again from the stored cells, without the statistics."""
    context = made[1]
    table = context.tables["emt_ratios"].set_index(["study", "scenario", "what"])
    assert len(table) == 3 * (4 + 4 + 3 + 44 + 3 + 4 + 4)
    results = studies.completed(studies.chosen(FORM), context.out / "emt", Nowhere())
    cells = results["figure15"].cells("[ABP] no INM, 10 cells")
    row = table.loc["figure15", "[ABP] no INM, 10 cells", "basal"]
    assert (row["count"], row["of"], row["runs"]) == ((cells["ab_25h"] < 0).sum(), 80, 8)
    cells = results["table5_63"].cells("63 % [P]")
    kind = (cells["t_a_h"] < 25) & (cells["t_b_h"] > 25) & cells["inm"]
    categories = context.tables["emt_categories"].set_index(["study", "category"])
    assert categories.loc[("table5_63", "[A]"), "of"] == kind.sum()
    assert context.tables["emt_outside"]["preset"].tolist() == ["thesis"]
    assert context.tables["emt_outside"]["of"].item() == sum(
        results[name].cells(f"{name[7:]} % [P]")["onset_ab"].notna().sum() for name in summaries.POPULATIONS
    )


def test_printed_ratios_are_compared_at_their_level(made):
    table = made[1].tables["emt_printed"]
    assert len(table) == 2 * len(printed.PRINTED)
    assert (table["agrees"] == ((table["low"] <= 0) & (table["high"] >= 0))).all()
    assert np.allclose(table["difference"], table["measured"] - table["printed"])


def test_kept_tables_are_of_the_complete_studies():
    """As many runs as the studies say, for each of their scenarios."""
    ratios = kept.read("ratios")
    for name, study in studies.chosen(studies.FULL).items():
        mine = ratios[ratios["study"] == name]
        wanted = 0 if name in studies.FURTHER else 3 * len(study.scenarios)
        assert len(mine) == wanted, name
        assert (mine["runs"] == study.replicates).all()
    assert (kept.read("controls")["failed"] == 0).all()


def test_rows_of_one_preset_take_the_place_of_its_own():
    """The rows of the other stay, in their order, before or behind them as the presets are."""
    before = pd.DataFrame({"study": ["figure10", "table5_7", "figure10_published"], "count": [1, 2, 3]})
    made = {"published": ["figure12_published"], "thesis": ["questions"]}
    expected = {
        "published": ["figure10", "table5_7", *made["published"]],
        "thesis": [*made["thesis"], "figure10_published"],
    }
    for preset, studies_made in made.items():
        table = kept.with_others(pd.DataFrame({"count": [9], "study": studies_made}), before, preset)
        assert table["study"].tolist() == expected[preset]
        assert list(table) == ["study", "count"]
    by_preset = pd.DataFrame({"preset": ["thesis", "published"], "of": [1, 2]})
    table = kept.with_others(pd.DataFrame({"preset": ["published"], "of": [3]}), by_preset, "published")
    assert table["of"].tolist() == [1, 3]


def test_unknown_preset_is_refused_before_any_run(tmp_path):
    with pytest.raises(InvalidProblem, match=r"^preset = 'publishd': must be thesis or corrected or published$"):
        kept.main(tmp_path, "publishd")
    assert not list(tmp_path.iterdir())


def test_sensitivity_has_a_scenario_for_each_point():
    study = sensitivity.study()
    assert len(study.scenarios) == sensitivity.BASE_POINTS * (len(sensitivity.BOUNDS) + 2)
    stiffness = {given.cell.alpha_ax for given in study.scenarios.values()}
    assert 1.0 <= min(stiffness) < 1.1
    assert 2.9 < max(stiffness) <= 3.0
    kept_table = kept.read(sensitivity.NAME)
    assert set(kept_table["parameter"]) == set(sensitivity.BOUNDS)


def test_the_footnote_of_orders():
    """34 orders by another way of counting: a selection of k events has k! orders, half of them with P after B."""
    count = 3 + 6 + 6  # of one, two and three of A, B, S
    count += 1 + 2 * 3 + 12  # with B and P: of two, three and four events
    assert len(s3_1_counts._orders()) == count == 34


def test_few_runs_are_enough_for_all_tables():
    assert set(FEW) == set(studies.SHORT.replicates)
