"""The rows of a study, measured again from the states of the same runs."""

import numpy as np
import pandas as pd
import pytest

from dincl.errors import InvalidProblem
from tissue.events.known import bit
from tissue.files.parameters import preset
from tissue.frames.observables import ab_positions
from tissue.runs.simulate import simulate_many
from tissue.study.categories import control_shares, outcome, run_shares, run_shares_in_time
from tissue.study.outcomes import EXTENTS, SIDES, outcomes

WILD = {"tissue.diffusion": "1e12 um^2/h"}
SEEDS, REPLICATES = [7, 3, 11, 5, 2, 13, 17, 19, 23, 29], range(40, 50)
TIMES = (0, 2, 4, 6, 8, 10)
SCENARIO = {
    "emt.cells": 6,
    "emt.inm": 0.5,
    "emt.a": "1 h to 8 h, 70 %",
    "emt.b": "1 h to 4 h, 80 %",
    "emt.p": "2 h to 4 h, 60 %",
    "numerics.t_end": "10 h",
    "numerics.keep": "2 h",
}


@pytest.fixture(scope="module", params=["thesis", "published"])
def made(request):
    parameters = preset(request.param).changed(SCENARIO)
    return outcomes(parameters, REPLICATES, SEEDS), simulate_many(parameters, SEEDS)


def columns(table, name):
    """(times, rows) of the columns of all output times."""
    return np.array([table[f"{name}_{t}h"].to_numpy() for t in TIMES])


def test_rows_are_in_order(made):
    cells, runs = (table.to_pandas() for table in made[0])
    assert cells["replicate"].tolist() == [number for number in REPLICATES for _ in range(6)]
    assert cells["cell"].tolist() == [*range(6)] * 10
    assert runs["replicate"].tolist() == list(REPLICATES)
    assert runs["seed"].tolist() == SEEDS
    assert set(runs["status"]) == {"SUCCESS"}
    assert set(runs["detail"]) == {""}


def test_positions_are_those_of_the_states(made):
    cells, runs = (table.to_pandas() for table in made[0])
    positions, below = columns(cells, "ab"), columns(cells, "below")
    counts = [columns(runs, name) for name in ("controls", "controls_apical", "controls_basal")]
    for k, run in enumerate(made[1]):
        for j, frame in enumerate(run.frames):
            expected, emt = ab_positions(frame), frame.cells.emt >= 0
            others = expected[~emt]
            mine = slice(6 * k, 6 * k + 6)
            np.testing.assert_allclose(positions[j, mine], expected[emt], rtol=1e-12)
            assert below[j, mine].tolist() == (expected[emt] <= others.min()).tolist()
            assert [count[j, k] for count in counts] == [len(others), (others > 1).sum(), (others < 0).sum()]


def test_heights_and_widths_are_those_of_the_states(made):
    runs = made[0].runs.to_pandas()
    for k, run in enumerate(made[1]):
        summary = run.summary()
        for name in EXTENTS:
            np.testing.assert_allclose(columns(runs, name)[:, k], summary[name], rtol=1e-12)


def test_what_became_of_the_cells(made):
    """Where they are at the end, since when at most; what they had, and when that began."""
    cells = made[0].cells.to_pandas()
    end = cells["ab_10h"].to_numpy()
    side = np.where(end < 0, -1, np.where(end > 1, 1, 0))
    assert cells["extruded"].tolist() == [SIDES[s + 1] for s in side]
    assert (cells["extruded_h"].isna() == (side == 0)).all()
    for s, since, row in zip(side, cells["extruded_h"], columns(cells, "ab").T, strict=True):
        if s:
            after = row[np.array(TIMES) >= since]
            assert ((after < 0) if s < 0 else (after > 1)).all()
    assert {-1, 0} <= set(side.tolist())
    started = np.isfinite(cells[["t_a_h", "t_b_h", "t_p_h"]].to_numpy())
    final = np.concatenate([run.final.cells.events[run.final.cells.emt >= 0] for run in made[1]])
    assert (final == started @ np.array([bit(name) for name in "abp"])).all()
    assert (cells["onset_h"] == cells[["t_a_h", "t_b_h", "t_s_h"]].min(axis=1)).all()
    assert (cells["onset_ab"].isna() == np.isinf(cells["onset_h"])).all()
    moves = np.concatenate([run.frames[0].cells.moves[run.frames[0].cells.emt >= 0] for run in made[1]])
    assert (cells["inm"] == moves).all()


def test_a_run_that_fails_has_no_cells_and_says_so():
    """Noise throws nuclei out of all bounds."""
    wild = preset("thesis").changed(SCENARIO | WILD)
    made = outcomes(wild, [0, 1], [0, 1])
    runs = made.runs.to_pandas()
    assert set(runs["status"]) == {"NON_FINITE"}
    assert runs["detail"].str.contains("has a coordinate that is not finite").all()
    assert runs["controls_0h"].tolist() == [54, 54]
    assert runs["controls_10h"].isna().all()
    assert runs["height_um_0h"].tolist() == [40.0, 40.0]
    assert runs["nuclei_width_um_10h"].isna().all()
    assert made.cells.num_rows == 0
    assert made.cells.schema.names[:3] == ["replicate", "cell", "inm"]


def test_a_tissue_without_emt_has_runs_and_no_cells():
    made = outcomes(preset("thesis").changed({"numerics.t_end": "1 h"}), [0], [5])
    assert made.cells.num_rows == 0
    assert made.runs["controls_1h"].to_pylist() == [len(simulate_many(preset("thesis"), [5])[0].frames[1].cells.x)]


@pytest.mark.parametrize("changes", [{}, WILD])
def test_to_be_asked_often_changes_no_row(changes, monkeypatch):
    """Also of runs that fail between two output times."""
    parameters = preset("thesis").changed(SCENARIO | changes)
    whole = outcomes(parameters, range(8), SEEDS[:8])
    monkeypatch.setattr("tissue.runs.batch.ASKED", 500)
    asked = []
    again = outcomes(parameters, range(8), SEEDS[:8], ask=lambda: asked.append(1))
    assert len(asked) == 100  # each step
    assert again.cells.equals(whole.cells)
    assert again.runs.equals(whole.runs)


def test_work_without_an_end_ends_when_that_is_said():
    """Once in 10 million hours a state is kept; the work is ended at the tenth question, long before."""
    asked = []

    def ask():
        asked.append(1)
        if len(asked) == 10:
            raise LookupError

    endless = preset("thesis").changed(SCENARIO | {"numerics.t_end": "1e7 h", "numerics.keep": "1e7 h"})
    with pytest.raises(LookupError):
        outcomes(endless, [0], [5], ask=ask)


# Shares of the cells of runs, on tables written by hand


def table_of(*rows, step=0.5):
    """A table with the positions of cells at times 0, step, 2 step, ..."""
    columns = {f"ab_{step * k:g}h": column for k, column in enumerate(zip(*rows, strict=True))}
    below = {f"below_{step * k:g}h": [y < 0.2 for y in column] for k, column in enumerate(zip(*rows, strict=True))}
    return pd.DataFrame({"replicate": range(len(rows))} | columns | below)


def test_outcomes_by_the_thesis():
    cells = table_of((0.5, -0.1), (0.1, 0.0), (1.0, 1.1))
    assert list(outcome(cells, "basal", 0.5)) == [True, False, False]
    assert list(outcome(cells, "apical", 0.5)) == [False, False, True]
    assert list(outcome(cells, "apical", 0)) == [False, False, False]
    assert list(outcome(cells, "below", 0)) == [False, True, False]


def test_outcomes_that_can_not_be():
    cells = table_of((0.5, -0.1))
    with pytest.raises(InvalidProblem, match=r"t = 0\.7: must be an output time; these are \[0\.0, 0\.5\] h"):
        outcome(cells, "basal", 0.7)
    with pytest.raises(InvalidProblem, match="what = 'out': must be one of basal, apical, below"):
        outcome(cells, "out", 0.5)


def test_runs_count_alike_however_many_cells_they_have():
    cells = table_of((0.5, -0.1), (0.1, 0.0), (1.0, 1.1), (0.4, -0.2)).assign(replicate=[7, 7, 7, 3])
    assert run_shares(cells, "basal", 0.5).to_dict() == pytest.approx({3: 1.0, 7: 1 / 3})
    assert run_shares_in_time(cells)["basal"].tolist() == [[0.0, 1.0], [0.0, pytest.approx(1 / 3)]]
    columns = {"status": ["SUCCESS", "NON_FINITE", "SUCCESS", "SUCCESS"], "controls_1h": [50, 50, 0, 40]}
    runs = pd.DataFrame({"replicate": range(4), **columns, "controls_apical_1h": [5, 5, 0, 0]})
    assert control_shares(runs, "apical", 1.0).to_dict() == {0: 0.1, 3: 0.0}
