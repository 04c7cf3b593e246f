"""Eight runs side by side are the runs alone, bit for bit: none of them knows of the others."""

import numpy as np
import pytest

import dincl
from dincl.compiled.lanes import WIDTH
from dincl.status import Status
from tests.tissue.bits import same_end
from tests.tissue.kernel_calls import aged, together
from tests.tissue.states import numbers
from tissue.files.parameters import preset
from tissue.runs.run import RunFailed
from tissue.runs.simulate import simulate, simulate_many

# Cells divide all the time, so that replicates soon differ in their numbers of cells.
LIVELY = {"cell.min_cycle": "1 h", "cell.max_cycle": "3 h", "cell.g2": "0.4 h", "cell.mitosis": "0.4 h"}
SHORT = {name: preset(name).changed({"numerics.t_end": "6 h"} | LIVELY) for name in ("thesis", "published")}
each_preset = pytest.mark.parametrize("name", SHORT)


# Against one run at a time


# Nobody knows of the others


@each_preset
def test_same_end_in_any_company(name):
    many = simulate_many(SHORT[name], range(10))
    turned = simulate_many(SHORT[name], range(9, -1, -1))
    for run in many:
        assert same_end(run, turned[9 - run.seed])
    assert same_end(many[3], simulate_many(SHORT[name], [3])[0])
    assert not same_end(many[3], many[4])


def test_a_lost_tissue_leaves_the_others_alone():
    states = [aged(20, k) for k in range(WIDTH)]
    sound, _ = together(states, 6, numbers(), range(WIDTH))
    states[2].cells.y[7] = np.nan
    made, ended = together(states, 6, numbers(), range(WIDTH))
    assert ended.tolist() == [0, 0, 1, 0, 0, 0, 0, 0]
    for k in range(WIDTH):
        assert k == 2 or all(a.tobytes() == b.tobytes() for a, b in zip(made[k].cells, sound[k].cells, strict=True))


# What can go wrong


def test_a_failed_run_is_told():
    wild = preset("thesis").changed({"tissue.diffusion": "1e12 um^2/h", "numerics.t_end": "3 h"})
    runs = simulate_many(wild, range(3), throw=False)
    alone = simulate(wild, 1, throw=False)
    assert [run.status for run in runs] == [Status.NON_FINITE] * 3
    assert runs[1].final.t == alone.final.t
    assert runs[1].detail.startswith(f"t = {runs[1].final.t:g} h: cell ")
    assert runs[1].stats["substeps"] == round(runs[1].final.t / 0.1) * 20
    with pytest.raises(RunFailed) as failure:
        simulate_many(wild, range(3))
    assert failure.value.run.seed == 0


@pytest.mark.parametrize("seeds", [[-1], [0, 1.5]])
def test_bad_seeds(seeds):
    with pytest.raises(dincl.InvalidProblem, match="seed"):
        simulate_many(SHORT["thesis"], seeds)


def test_no_seeds_no_runs():
    assert simulate_many(SHORT["thesis"], []) == ()
