"""The quasi-steady model: the rules and the randomness of the first-order model around minima by DAHA."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from dincl.status import Status
from tissue.files.parameters import preset
from tissue.runs.simulate import simulate
from tissue.state.cells import Cells
from tissue.state.checkpoint import streams
from tissue.state.numbers import Daha
from verification.thesis.quasi_steady.daha import Stopped, TissueArrowHurwicz
from verification.thesis.quasi_steady.run import simulate_quasi_steady

AGES = ("birth", "cycle", "id", "mother", "radius", "moves", "divides")
QUICK = {
    "tissue.cells": 12,
    "numerics.t_end": "1 h",
    "numerics.keep": "0.2 h",
    "rules.floor_rest_length": True,
    "daha.alpha": 1e-3,
    "daha.gamma": 1e-2,
}


def parameters(**changes):
    return preset("thesis").changed({**QUICK, **changes})


def same(one, other, names=Cells._fields):
    return all((getattr(one, name) == getattr(other, name)).all() for name in names)


@pytest.mark.parametrize(("end", "daughters"), [("15 h", 0.5), ("45 h", 1.0)])
def test_rules_and_divisions_are_those_of_the_first_order_model(end, daughters):
    changes = {"numerics.t_end": end, "numerics.keep": "3 h", "tissue.two_daughters": daughters, "daha.eps": 1e-3}
    chosen = parameters(**changes)
    minima, moving = simulate_quasi_steady(chosen, 3), simulate(chosen, 3)
    assert minima.status is Status.SUCCESS
    assert minima.stats["divisions"] == moving.stats["divisions"] > 0
    assert minima.stats["substeps"] == 0
    for a, b in zip(minima.frames, moving.frames, strict=True):
        assert a.t == b.t
        assert same(a.cells, b.cells, AGES)
        assert same(a.layers, b.layers, a.layers._fields)
    assert not same(minima.final.cells, moving.final.cells, "x")


def test_each_step_begins_with_the_noise_on_what_was_left(monkeypatch):
    seen = []

    def stays(self, cells, layers, numbers):
        seen.append(cells)
        return Stopped(cells, float(len(seen)), 0.1, len(seen), Status.SUCCESS, "")

    monkeypatch.setattr(TissueArrowHurwicz, "minimise", stays)
    run = simulate_quasi_steady(parameters(**{"tissue.two_daughters": 0.0}), 5)
    noise, deviation = streams(5).noise, np.sqrt(0.2 * 0.1)
    x, y = run.frames[0].cells.x.copy(), run.frames[0].cells.y.copy()
    for cells in seen:
        drawn = deviation * noise.standard_normal((12, 2))
        x, y = x + drawn[:, 0], y + drawn[:, 1]
        assert cells.x == pytest.approx(x, abs=1e-14)
        assert cells.y == pytest.approx(y, abs=1e-14)
    assert same(run.final.cells, seen[-1])
    assert same(run.final.cells, run.frames[0].cells, ("ax", "ay", "bx", "by"))
    assert run.iterations.tolist() == run.energy.tolist() == list(range(1, 11))


def test_numbers_of_daha_are_those_of_the_file():
    chosen, other = parameters(**{"daha.eps": 1e-5}), parameters()
    assert chosen.daha_numbers() == Daha(1e-3, 0.25, 1e-2, 2.0, 1.0, 1e-5, 100_000)
    run, finer = simulate_quasi_steady(chosen, 1), simulate_quasi_steady(other, 1)
    assert (run.iterations < finer.iterations).all()
    assert (run.energy > 0).all()
    assert run.violation.max() > 0
    assert max(run.energy - finer.energy) > 0


def test_same_bits_whatever_is_kept_in_two_threads_and_for_any_mu():
    every, ends = parameters(), parameters(**{"numerics.keep": "1 h", "numerics.mu": "2 h"})
    with ThreadPoolExecutor(2) as pool:
        runs = list(pool.map(lambda chosen: simulate_quasi_steady(chosen, 2), [every, ends, every]))
    assert [len(run.frames) for run in runs] == [6, 2, 6]
    for run in runs[1:]:
        assert same(run.final.cells, runs[0].final.cells)
        assert run.iterations.tolist() == runs[0].iterations.tolist()
        assert run.energy.tolist() == runs[0].energy.tolist()


def test_a_step_that_fails_ends_the_run():
    run = simulate_quasi_steady(parameters(**{"daha.most_iterations": 30}), 0)
    assert (run.status, run.iterations.tolist(), run.terminated.tolist()) == (Status.NOT_CONVERGED, [30], [False])
    assert run.final.t == pytest.approx(0.1)
    assert "t = 0.1 h: DAHA did not terminate in 30 iterations" in run.detail
    run = simulate_quasi_steady(parameters(**{"daha.alpha": 2.0}), 0)
    assert run.status is Status.NON_FINITE
    assert run.energy.tolist() == run.violation.tolist() == [np.inf]
