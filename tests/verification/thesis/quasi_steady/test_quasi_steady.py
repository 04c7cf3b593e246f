"""The quasi-steady model: the rules and the randomness of the first-order model around any minimiser."""

from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
import pytest

import dincl
from dincl.status import Status
from tissue.files.parameters import preset
from tissue.runs.run import RunFailed
from tissue.runs.simulate import simulate
from tissue.state.cells import Cells
from tissue.state.checkpoint import streams
from tissue.state.numbers import Daha
from verification.thesis.quasi_steady.daha import TissueArrowHurwicz
from verification.thesis.quasi_steady.minimiser import Judge
from verification.thesis.quasi_steady.run import QuasiSteadyRun, simulate_quasi_steady

COORDINATES = Cells._fields[:6]
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


class Stub(NamedTuple):
    cells: Cells
    energy: float = 0.0
    violation: float = 0.0
    iterations: int = 1
    status: Status = Status.SUCCESS
    detail: str = ""


class Stays:
    """A minimiser that moves nothing and remembers what it was given; it fails at the given call."""

    def __init__(self, fails_at=None):
        self.seen = []
        self.fails_at = fails_at

    def minimise(self, cells, layers, numbers):
        self.seen.append((cells, layers))
        if len(self.seen) == self.fails_at:
            return Stub(cells, status=Status.NOT_CONVERGED, detail="Enough.")
        return Stub(cells, energy=float(len(self.seen)), violation=0.1 * len(self.seen), iterations=len(self.seen))


def same(one, other, names=Cells._fields):
    return all((getattr(one, name) == getattr(other, name)).all() for name in names)


def test_rules_and_divisions_are_those_of_the_first_order_model():
    chosen = parameters(**{"numerics.t_end": "15 h", "tissue.two_daughters": 0.5})
    still, moving = simulate_quasi_steady(chosen, 3, Stays()), simulate(chosen, 3)
    assert len(still.final.cells.x) > 15
    assert [frame.t for frame in still.frames] == [frame.t for frame in moving.frames]
    for a, b in zip(still.frames, moving.frames, strict=True):
        assert same(a.cells, b.cells, AGES)
        assert same(a.layers, b.layers, a.layers._fields)
    assert not same(still.final.cells, moving.final.cells, "x")


def test_each_step_begins_with_the_noise_on_what_the_minimiser_left():
    chosen, stays = parameters(**{"tissue.two_daughters": 0.0}), Stays()
    run = simulate_quasi_steady(chosen, 5, stays)
    assert len(stays.seen) == 10
    noise, deviation = streams(5).noise, np.sqrt(0.2 * 0.1)
    x, y = run.frames[0].cells.x.copy(), run.frames[0].cells.y.copy()
    for cells, _ in stays.seen:
        drawn = deviation * noise.standard_normal((12, 2))
        x, y = x + drawn[:, 0], y + drawn[:, 1]
        assert cells.x == pytest.approx(x, abs=1e-14)
        assert cells.y == pytest.approx(y, abs=1e-14)
    assert same(run.final.cells, stays.seen[-1][0])
    assert same(run.final.cells, run.frames[0].cells, ("ax", "ay", "bx", "by"))


def test_what_the_minimiser_says_is_kept():
    run = simulate_quasi_steady(parameters(), 0, Stays())
    assert isinstance(run, QuasiSteadyRun)
    assert run.iterations.tolist() == list(range(1, 11))
    assert run.energy.tolist() == list(range(1, 11))
    assert run.violation == pytest.approx(0.1 * np.arange(1, 11))
    assert run.terminated.all()
    assert run.status is Status.SUCCESS
    assert run.stats["substeps"] == 0


def test_arrays_grow_with_the_tissue():
    chosen = parameters(**{"tissue.two_daughters": 1.0, "numerics.t_end": "45 h", "numerics.keep": "45 h"})
    run = simulate_quasi_steady(chosen, 0, Stays())
    assert len(run.final.cells.x) > 48
    assert run.stats["divisions"] == len(run.final.cells.x) - 12
    assert same(run.final.cells, simulate(chosen, 0).final.cells, AGES)


def test_daha_is_the_default_with_the_numbers_of_the_file():
    chosen = parameters(**{"daha.eps": 1e-5})
    run = simulate_quasi_steady(chosen, 1)
    again = simulate_quasi_steady(chosen, 1, TissueArrowHurwicz(Daha(1e-3, 0.25, 1e-2, 2.0, 1.0, 1e-5, 100_000)))
    other = simulate_quasi_steady(parameters(), 1)
    assert same(run.final.cells, again.final.cells)
    assert run.iterations.tolist() == again.iterations.tolist()
    assert (run.iterations < other.iterations).all()
    assert (run.energy > 0).all()
    assert run.violation.max() > 0
    assert max(run.energy - other.energy) > 0


def test_same_bits_whatever_is_kept_and_in_two_threads_at_once():
    every, ends = parameters(), parameters(**{"numerics.keep": "1 h"})
    with ThreadPoolExecutor(2) as pool:
        runs = list(pool.map(lambda chosen: simulate_quasi_steady(chosen, 2), [every, ends, every]))
    assert [len(run.frames) for run in runs] == [6, 2, 6]
    for run in runs[1:]:
        assert same(run.final.cells, runs[0].final.cells)
        assert run.iterations.tolist() == runs[0].iterations.tolist()
        assert run.energy.tolist() == runs[0].energy.tolist()


def test_mu_and_substeps_do_not_matter():
    one, other = (simulate_quasi_steady(parameters(**{"numerics.mu": mu}), 2).final.cells for mu in ("0.1 h", "2 h"))
    assert same(one, other)


def test_a_step_that_fails_ends_the_run():
    run = simulate_quasi_steady(parameters(), 0, Stays(fails_at=5), throw=False)
    assert run.status is Status.NOT_CONVERGED
    assert run.detail == "t = 0.5 h: Enough."
    assert [frame.t for frame in run.frames] == pytest.approx([0.0, 0.2, 0.4, 0.5])
    assert run.terminated.tolist() == [True] * 4 + [False]
    assert len(run.energy) == len(run.iterations) == len(run.violation) == 5
    with pytest.raises(RunFailed, match="Enough") as caught:
        simulate_quasi_steady(parameters(), 0, Stays(fails_at=5))
    assert isinstance(caught.value.run, QuasiSteadyRun)
    assert len(caught.value.run.frames) == 4


def test_daha_that_does_not_terminate():
    run = simulate_quasi_steady(parameters(**{"daha.most_iterations": 30}), 0, throw=False)
    assert run.status is Status.NOT_CONVERGED
    assert run.iterations.tolist() == [30]
    assert run.final.t == pytest.approx(0.1)
    assert "did not terminate in 30 iterations" in run.detail


def test_daha_that_diverges():
    run = simulate_quasi_steady(parameters(**{"daha.alpha": 2.0}), 0, throw=False)
    assert run.status is Status.NON_FINITE
    assert run.energy.tolist() == [np.inf]
    assert run.violation.tolist() == [np.inf]


def test_watch_is_told_of_each_kept_time():
    times = []
    simulate_quasi_steady(parameters(), 0, Stays(), watch=times.append)
    assert times == pytest.approx([0.2, 0.4, 0.6, 0.8, 1.0])


def test_daha_of_small_eps_follows_the_judge():
    """Minima, step after step; at eps/alpha as in the thesis the tissue stays behind."""
    quick = {"daha.alpha": 1e-2, "daha.gamma": 1e-1, "daha.most_iterations": 1_000_000}
    chosen = parameters(**quick, **{"numerics.t_end": "0.3 h", "tissue.cells": 6})
    judged = simulate_quasi_steady(chosen, 4, Judge(1e-8))
    assert judged.violation.max() < 1e-8
    off = {}  # of heights: W does not know where along the line a tissue is
    for eps in (1e-4, 1e-8):
        found = simulate_quasi_steady(chosen.changed({"daha.eps": eps}), 4)
        off[eps] = max(
            abs(getattr(found.final.cells, name) - getattr(judged.final.cells, name)).max() for name in ("y", "ay")
        )
    assert off[1e-8] < 1e-3
    assert off[1e-4] > 10 * off[1e-8]


@pytest.mark.parametrize("tol", [0.0, -1e-6, np.nan])
def test_bad_tolerance_of_the_judge(tol):
    with pytest.raises(dincl.InvalidProblem, match="tol"):
        Judge(tol)


TYPE = {"types.mine.cells": 3}
REFUSED = {
    "dimension": ({"tissue.dimension": 3, "tissue.cells": 182}, r"tissue\.dimension = 3: must be 2"),
    "noise": ({"numerics.noise": "substep"}, '"substep": must be "step"'),
    "layer": ({"layer.shape": "circle"}, r'layer\.shape = "circle": must be "line"'),
    "EMT": ({"emt.cells": 1}, r"emt\.cells = 1: must be 0, the quasi-steady model has no EMT events"),
    "events of a type": (TYPE | {"types.mine.a": "1 h"}, r"types\.mine\.cells = 3: must be 0, .* has no EMT"),
    "no cores": ({"cell.hard_radius": "0 um"}, r"cell\.hard_radius = 0: must be > 0, .* has hard discs"),
    "a type without cores": (TYPE | {"types.mine.hard_radius": "0 um"}, r"types\.mine\.hard_radius = 0: must be > 0"),
}
OWN = {"soft_radius": "7 um", "alpha_xx": 4, "max_basal_distance": "2/3 R_soft"}
REFUSED |= {
    key: (TYPE | {f"types.mine.{key}": value}, rf"types\.mine\.{key}: must be left out, .* has one of all cells")
    for key, value in OWN.items()
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_the_model_does_not_have_is_refused(name):
    changes, message = REFUSED[name]
    with pytest.raises(dincl.InvalidProblem, match=message):
        simulate_quasi_steady(preset("thesis").changed(changes))
