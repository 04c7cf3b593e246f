"""The same study on a quiet machine and beside two busy loops: no method wins here and another one there."""

import subprocess
import sys

import pytest

import dincl
import verification as v

UNDECIDED = {"tie", "at the limit"}
METHODS = {
    "PBD": dincl.PBD,
    "catch-up": lambda dt: dincl.CatchUp(dt, dincl.Daqp(tol=1e-12)),
    "midpoint": lambda dt: dincl.MidpointCatchUp(dt, dincl.ProjectedCG(tol=1e-12)),
    "springs": lambda dt: dincl.Penalty(dt, 0.3 / dt),
    "events": dincl.EventDriven,
}


def verdicts():
    four = dincl.scenes.four_disks()
    steps = [0.1 / 4**k for k in range(8)]
    chart = v.work_precision(four, METHODS, steps, [1.0, 2.0], v.reference(four, 1e-11), v.CpuSeconds(0.4))
    return chart.cheapest()["cheapest"].tolist()


@pytest.mark.xslow
def test_load_changes_no_winner():
    quiet = verdicts()
    loops = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2)]
    try:
        loud = verdicts()
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()
    assert len(set(quiet) - UNDECIDED) >= 2
    assert [pair for pair in zip(quiet, loud, strict=True) if len(set(pair)) > 1 and not UNDECIDED & set(pair)] == []
