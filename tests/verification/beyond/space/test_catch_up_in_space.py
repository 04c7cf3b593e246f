"""The study of catch-up in space, on a small tissue: one limit, known orders, work that is counted."""

from functools import cache

import numpy as np
import pandas as pd
import pytest

from tests.executors import Here
from verification.beyond.space import catch_up, figures_catch_up
from verification.beyond.space.frozen import open_sheet
from verification.beyond.space.sections.catch_up import PART
from verification.page.context import Context
from verification.page.kept import STUDIES
from verification.page.parts import Grid, Text, number
from verification.thesis.chapter3.catch_up import CatchUpForm

FORM = CatchUpForm(1, (20, 80, 320), (20, 40), 80)


@cache
def rows():
    return pd.DataFrame(catch_up.moved({"seed": 0}, FORM, open_sheet(16, 0.5)))


def error_of(method):
    mine = rows()[rows()["method"] == method].sort_values("steps")
    return mine["rms"].to_numpy()


def test_all_methods_have_one_limit():
    assert (np.diff(error_of("PBD")) < 0).all()
    assert error_of("PBD")[-1] < 0.3 * error_of("PBD")[0]
    assert error_of("MidpointCatchUp")[-1] < error_of("LinearisedCatchUp")[-1]
    assert 1.5 < error_of("LinearisedCatchUp")[0] / error_of("LinearisedCatchUp")[1] < 2.5


def test_work_is_counted():
    calls = rows().groupby("method")["calls"].apply(list)
    assert calls["PBD"] == [20, 80, 320]
    assert calls["LinearisedCatchUp"] == [20, 40]
    assert calls["MidpointCatchUp"] == [40, 80]
    assert (rows()["pairs"] > 0).all()


def test_errors_are_medians_and_count_the_lost():
    table = rows().assign(method="PBD", steps=1, rms=[1.0, 5.0, 2.0, np.nan, 3.0, 4.0, 9.0])
    found = catch_up.errors(table).iloc[0]
    assert found["rms"] == 3.5
    assert found["lost"] == 1


@pytest.mark.slow
def test_the_figure_is_drawn(tmp_path):
    assert figures_catch_up.catch_up(catch_up.errors(rows()), tmp_path / "figure.png").stat().st_size > 10_000


@pytest.mark.slow
def test_the_section_says_what_the_tables_say(tmp_path):
    context = Context(tmp_path, False, Here(), complete=STUDIES)
    PART.run(context)
    section = PART.section(context)
    said = " ".join(part.html for part in section.parts if isinstance(part, Text))
    found = context.tables["space_catch_up_orders"]
    assert set(found["method"]) == {"PBD", "LinearisedCatchUp", "MidpointCatchUp"}
    grids = {part.file: part.rows for part in section.parts if isinstance(part, Grid)}
    assert grids["space_catch_up_orders"]["Order in h [range]"].tolist() == found["order"].tolist()
    errors = context.tables["space_catch_up_errors"]
    assert f"{number(errors[errors['method'] == 'PBD']['rms'].iloc[-1])} R_soft" in said
    assert "nan" not in said.lower()
