"""Steps that are too long: refused where the parameters tell, else the run ends with the Status UNSTABLE."""

import numpy as np
import pytest

import tissue
from dincl.errors import InvalidProblem
from dincl.status import Status
from tissue.runs.batch import Batch
from tissue.runs.stability import swings
from tissue.state.running import JUMPED

SHORT = {"numerics.t_end": "6 h", "numerics.keep": "3 h", "tissue.cells": 20}


@pytest.mark.parametrize(
    ("preset", "changes", "least"),
    [
        ("published", {}, 4),  # bending of a cell in mitosis: 2 x 15, h/mu = 0.25/n below 2/30
        ("thesis", {}, 11),
        ("chick", {"numerics.dt": "0.2 h"}, 16),
        ("published", {"cell.alpha_ax": 20}, 11),  # 4 x 20
        ("published", {"cell.alpha_bx": 60}, 16),  # 2 x 60
        ("published", {"cell.alpha_axb": 0, "cell.alpha_aa": 40}, 5),  # 2 k (1 + cos(pi/20)), k = 10
        ("published", {"cell.alpha_xx": 100}, 13),  # 2 k, k = 50
        ("published", {"tissue.dimension": 3, "tissue.cells": 196, "cell.alpha_aa": 60}, 12),  # 6 k, k = 15
        ("published", {"types.hard.cells": 2, "types.hard.alpha_axb": 60, "types.hard.place": 0.1}, 16),
        ("published", {"types.thin.cells": 2, "types.thin.soft_radius": "4 um", "types.thin.place": 0.1}, 6),
    ],
)
def test_the_fewest_substeps_of_parameters(preset, changes, least):
    """One fewer is refused with the least number; that number is taken."""
    given = tissue.preset(preset).changed(SHORT | changes | {"numerics.substeps": 1000})
    with pytest.raises(InvalidProblem, match=rf"numerics\.substeps = {least - 1}: must be at least {least}: dt/"):
        given.changed({"numerics.substeps": least - 1})
    assert given.changed({"numerics.substeps": least}).numerics.substeps == least


@pytest.mark.parametrize(
    "changes",
    [
        # The springs of freed points that are stiffer than the others.
        {"emt.cells": 4, "emt.a": "1 h", "events.freed_stiffness": 10, "numerics.substeps": 10},
        # Soft discs in a heap, of which each overlaps many.
        {"cell.alpha_xx": 30, "cell.alpha_axb": 15, "numerics.substeps": 4},
    ],
)
def test_what_shows_while_a_tissue_runs_ends_it(changes):
    parameters = tissue.preset("published").changed(SHORT | changes)
    runs = tissue.simulate_many(parameters, range(8), throw=False)
    fine = tissue.simulate_many(parameters.changed({"numerics.substeps": 160}), range(8))
    right = np.array([run.summary()["height_um"].iloc[-1] for run in fine])
    assert {run.status for run in runs} <= {Status.UNSTABLE, Status.NON_FINITE, Status.SUCCESS}
    assert sum(run.status is Status.UNSTABLE for run in runs) >= 4
    assert all("substep" in run.detail or "one dt" in run.detail for run in runs if run.status is Status.UNSTABLE)
    for run in runs:
        if run.status:
            assert abs(run.summary()["height_um"].iloc[-1] - right.mean()) < 0.1 * right.mean()


def test_unstable_runs_are_the_same_in_company_and_from_saved_states():
    parameters = tissue.preset("published").changed(
        SHORT
        | {"emt.cells": 4, "emt.a": "1 h", "events.freed_stiffness": 10, "numerics.substeps": 10}
        | {"numerics.keep": "1 h"}
    )
    together = tissue.simulate_many(parameters, range(3), throw=False)
    for seed, run in enumerate(together):
        alone = tissue.simulate(parameters, seed, throw=False)
        assert (alone.status, alone.detail, alone.final.t) == (run.status, run.detail, run.final.t)
        assert run.final.t > 1.0
        later = tissue.simulate(parameters, seed, run.frames[1], throw=False)
        assert (later.status, later.detail, later.final.t) == (run.status, run.detail, run.final.t)


def test_to_look_for_swings_changes_nothing():
    """Steps far below the limit leave none."""
    parameters = tissue.preset("published").changed(SHORT)
    batch = Batch(parameters, range(8))
    for _ in batch.times():
        pass
    (group,) = batch._groups
    before = [state.cells.x.copy() for state in group.states]
    assert swings(group).max() < 1e-3
    assert all(np.array_equal(x, state.cells.x) for x, state in zip(before, group.states, strict=True))


def test_a_point_that_jumps_is_noted():
    """A basal spring of length nearly 0 at power 2 is stiff without bound: its cell is thrown out."""
    wrong = {"cell.alpha_axb": 0.5, "numerics.substeps": 10, "numerics.t_end": "24 h", "numerics.keep": "12 h"}
    runs = tissue.simulate_many(tissue.preset("corrected").changed(SHORT | wrong), range(8), throw=False)
    assert Status.UNSTABLE in {run.status for run in runs}
    for run in runs:
        if run.status:
            assert run.summary()["height_um"].iloc[-1] < 60.0
    batch = Batch(tissue.preset("published").changed(SHORT), range(2))
    assert all(batch.state(k).sizes[JUMPED] == 0 for k in range(2))
