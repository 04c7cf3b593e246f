"""The chapter on EMT: its studies come out again, and its page, its figures and corrections say what the tables say."""

from functools import cache

import pandas as pd
import pytest
from matplotlib.colors import to_hex

from tissue.pictures.charts import OUTCOMES
from verification.site.store import shipped
from verification.thesis.chapter4 import figures, printed
from verification.thesis.chapter4.claims import s4_1_isolated
from verification.thesis.chapter4.ensembles import NAMES, PRESETS, ensemble, preset_of
from verification.thesis.chapter4.questions import answered
from verification.thesis.studies import STUDIES

EMT = [name for name in STUDIES if name.startswith("emt_")]


@cache
def tables() -> dict[str, pd.DataFrame]:
    found = {name: shipped(name) for name in EMT}
    return found | {"emt_printed": printed.compared(found), "emt_answers": answered(found)}


def coloured(panel, colour):
    return [line for line in panel.lines if to_hex(line.get_color()) == colour]


@pytest.mark.slow_with("10", "12", "14", "15", "20")
@pytest.mark.parametrize("number", figures.FIGURES)
def test_figures_are_drawn(number: int, tmp_path, monkeypatch) -> None:
    """Of Figures 10 and 21 a line has the numbers of the table."""
    drawn = []
    monkeypatch.setattr(figures, "write", lambda figure, path: drawn.append(figure))
    assert figures.draw(number, tables(), tmp_path / "x.png") == tmp_path / "x.png"
    panels = {panel.get_title("left"): panel for panel in drawn[0].axes}
    assert all(panel.get_title("left").endswith(tuple(PRESETS)) for panel in drawn[0].axes)
    if number == 10:
        rows = tables()["emt_in_time"].query("study == 'figure10_published' and scenario == '[A]' and what == 'basal'")
        (line,) = coloured(panels["[A], published"], OUTCOMES["basal"][0])
        assert line.get_ydata() == pytest.approx((100 * rows["count"] / rows["of"]).to_numpy())
    if number == 21:
        rows = tables()["emt_groups"].query("study == 'table5_7' and given == 'onset_ab' and kind == 'no INM'")
        (line,) = coloured(panels["without INM, thesis"], figures.COLOURS["table5_7"])
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


def test_names_of_ensembles_tell_the_reading() -> None:
    assert {preset_of(name) for name in NAMES} == set(PRESETS)
    for name in ("figure12", "figure12_corrected", "figure12_published"):
        assert len(ensemble(name).scenarios) == 4
    printed_, mended = (ensemble(name).scenarios["[B] no INM"] for name in ("figure12", "figure12_corrected"))
    assert printed_.rules.spring_power != mended.rules.spring_power
