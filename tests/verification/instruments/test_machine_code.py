"""Making and loading machine code belongs to no method: such a run is made again, and costs nothing of its budget."""

import time

import numba
import numpy as np
import pytest

import dincl
import verification as v
from verification.instruments.machine_code import machine_code
from verification.instruments.measure import measure

SLIDE = dincl.scenes.sliding_disc()
T = np.array([1.0])
KNOWN = v.Known(T, SLIDE.exact(T), np.zeros(1))


def fresh():
    """A function that is compiled when it is called first."""
    return numba.njit(lambda a: a + 1.0)


def test_only_a_first_call_makes_machine_code():
    function = fresh()
    with machine_code() as first:
        function(1.0)
    with machine_code() as second:
        function(1.0)
    assert first
    assert not second


def test_a_timed_run_that_compiles_is_made_again():
    seen, coarse, fine = [], fresh(), fresh()

    def run(problem, dt, t):
        seen.append(dt)
        (coarse if dt == 0.1 else fine)(1.0)
        return SLIDE.exact(t)

    rows = measure(SLIDE, v.Method("own", run=run), (0.1, 0.05), KNOWN, ("final",), None, repeats=0)
    assert seen == [0.1, 0.1, 0.1, 0.05, 0.05]  # two to warm up; then the finer setting compiles in its timed run
    assert [row["repeats"] for row in rows] == [1, 1]


@pytest.mark.slow
def test_a_program_that_compiles_in_every_run_is_measured_all_the_same():
    method = v.Method("own", run=lambda problem, dt, t: SLIDE.exact(t) * fresh()(0.0))
    rows = measure(SLIDE, method, (0.1,), KNOWN, ("final",), None, repeats=0)
    assert rows[0]["status"] == "SUCCESS"
    assert rows[0]["repeats"] == 1


def test_compiling_spends_no_budget():
    budget, calls, function = v.CpuSeconds(0.05), [], fresh()

    def slow_once(t, x):
        """As slow as compiling may be, in the first run of the finer step only."""
        calls.append(t)
        if len(calls) == 21:  # after two runs of ten steps
            function(1.0)
            began = time.process_time()
            while time.process_time() - began < 2 * budget.limit():
                pass
        return -x

    problem = dincl.Problem([[1.0]], slow_once, [dincl.HalfSpace(normal=(1,))])
    known = v.Known(T, np.exp(-T)[:, None, None], np.zeros(1))
    rows = measure(problem, v.Method("PBD", scheme=dincl.PBD), (0.1, 0.05), known, ("final",), budget, repeats=0)
    assert [row["status"] for row in rows] == ["SUCCESS", "SUCCESS"]
    assert len(calls) > 40
