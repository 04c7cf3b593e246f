"""Contact forces: exact multipliers, columns that carry their weight, rows in words, dependent contacts."""

import numpy as np
import pytest

import dincl
from dincl import scenes

FLOOR = dincl.HalfSpace((0, 1), radius=0.5)
DOWN = dincl.drifts.constant((0.0, -1.0))
# Schemes, and how far their multipliers may be from the exact ones: sweeps and penalties meet contacts only nearly.
SCHEMES = {
    "EventDriven": (dincl.EventDriven(1e-9), 1e-9),
    "Auto": (dincl.Auto(1e-3), 1e-9),
    "AdaptiveCatchUp": (dincl.AdaptiveCatchUp(1e-6), 1e-9),
    "CatchUp": (dincl.CatchUp(0.01, dincl.Daqp(1e-12)), 1e-8),
    "LinearisedCatchUp": (dincl.LinearisedCatchUp(0.01, dincl.ActiveSet(1e-12)), 1e-8),
    "MidpointCatchUp": (dincl.MidpointCatchUp(0.01, dincl.ActiveSet(1e-12)), 1e-8),
    "PBD": (dincl.PBD(0.01, sweeps=200), 1e-8),
    "XPBD": (dincl.XPBD(0.01, sweeps=300), 1e-8),
    "SecondOrderPBD": (dincl.SecondOrderPBD(0.01, sweeps=200), 1e-6),
    "Penalty": (dincl.Penalty(2e-4, 1000.0), 1e-6),
}


@pytest.mark.parametrize(("scheme", "tol"), SCHEMES.values(), ids=SCHEMES)
def test_a_column_carries_the_weight_above(scheme, tol):
    column = dincl.Problem([(0.0, 0.5 + k) for k in range(5)], DOWN, [dincl.NonOverlap(0.5), FLOOR])
    path = dincl.solve(column, scheme, t=[0.5, 1.0])
    for forces in path.forces([0.323, 0.5, 1.0]):
        found = dict(zip(zip(forces.constraint.tolist(), forces.row, strict=True), forces.multiplier, strict=True))
        exact = {(0, f"particle {k + 1} and {k}"): 4.0 - k for k in range(4)} | {(1, "particle 0"): 5.0}
        assert found == pytest.approx(exact, abs=tol)
        assert forces.force == pytest.approx(np.tile([0.0, 1.0], (5, 1)), abs=tol)
        assert forces.load(1) == pytest.approx([0.0, 5.0], abs=tol)
        assert forces.load(0) == pytest.approx([0.0, 0.0], abs=tol)


@pytest.mark.parametrize("scheme", [dincl.EventDriven(1e-10), dincl.MidpointCatchUp(1e-3, dincl.ActiveSet(1e-12))])
def test_a_disc_that_slides_is_pushed_as_its_exact_solution_says(scheme):
    tol = 1e-9 if isinstance(scheme, dincl.EventDriven) else 2e-3
    slide, pair = scenes.sliding_disc(), scenes.two_disks()
    for t in (1.2, 1.9):
        (multiplier,) = dincl.solve(slide, scheme, t=2.0).forces(t).multiplier
        assert multiplier == pytest.approx(slide.exact(t)[0, 1], abs=tol)
        forces = dincl.solve(pair, scheme, t=2.0).forces(t)
        normal = (pair.exact(t)[0] - pair.exact(t)[1]) / 1.25
        assert forces.multiplier == pytest.approx([-normal @ (0.5, -0.125)], abs=tol)
        assert forces.particles == ((0, 1),)
    assert len(dincl.solve(slide, scheme, t=2.0).forces(0.3).row) == 0


def test_a_moving_wall_pushes_with_the_velocity_it_gives():
    wall = dincl.Moving(dincl.HalfSpace((1, 0)), lambda t: (2.0 * t, 0.0))
    problem = dincl.Problem([(0.0, 0.0)], lambda t, x: np.full_like(x, -0.5), [wall])
    for scheme in (dincl.EventDriven(1e-9), dincl.CatchUp(0.01, dincl.ActiveSet(1e-12)), dincl.AdaptiveCatchUp(1e-3)):
        assert dincl.solve(problem, scheme, t=1.0).forces(0.5).load(0) == pytest.approx([2.5, 0.0], abs=1e-8)
        at_break = dincl.solve(problem, scheme, t=[0.5, 1.0], breaks=[0.5])
        assert at_break.forces([0.5, 1.0])[0].load(0) == pytest.approx([2.5, 0.0], abs=1e-8)


def test_dependent_contacts_share_their_load_evenly():
    problem = dincl.Problem([(0.0, 0.5)], DOWN, [FLOOR, dincl.HalfSpace((0, 1), radius=0.5), FLOOR])
    for scheme in (dincl.EventDriven(1e-9), dincl.CatchUp(0.01, dincl.Daqp(1e-12))):
        forces = dincl.solve(problem, scheme, t=1.0).forces(1.0)
        assert forces.multiplier == pytest.approx([1 / 3] * 3, abs=1e-9)


def test_the_table_of_a_pile_adds_up():
    pile = scenes.pile(100)
    path = dincl.solve(pile, dincl.MidpointCatchUp(0.01, dincl.ActiveSet(1e-9)), t=[1.0])
    forces = path.forces(1.0)
    table = forces.to_frame()
    assert list(table) == ["t", "constraint", "row", "particles", "gap", "multiplier"]
    assert table["row"][0] == "particle {} and {}".format(*sorted(table["particles"][0], reverse=True))
    assert (table["multiplier"] >= 0).all()
    assert sum(forces.load(k) for k in range(4)) == pytest.approx(forces.force.sum(axis=0))
    reaction = path.between.reactions(path.t)[0].value.reshape(100, 2)
    assert abs(forces.force - reaction).max() <= 2 * path.normal_cone_residual()[0]


def test_times_without_forces_are_refused():
    path = dincl.solve(scenes.sliding_disc(), dincl.PBD(0.1), t=[1.0, 2.0])
    for t, message in (
        (2.1, r"must lie in \[0, 2.0\]"),
        (0.0, "no step"),
        ([2.0, 1.0], "increasing"),
        ("1", "t = '1'"),
    ):
        with pytest.raises(dincl.InvalidProblem, match=message):
            path.forces(t)
    with pytest.raises(dincl.InvalidProblem, match="constraint = -1"):
        path.forces(1.0).load(-1)


@pytest.mark.parametrize("scheme", [dincl.EventDriven(1e-9), dincl.CatchUp(0.01, dincl.Daqp(1e-12))])
def test_forces_with_mobilities_are_forces_and_a_fixed_particle_bears_them(scheme):
    sets = [dincl.NonOverlap(0.5), FLOOR]
    column = dincl.Problem([(0.0, 0.5), (0.0, 1.5), (0.0, 2.5)], DOWN, sets, mobility=[0.0, 0.5, 2.0])
    forces = dincl.solve(column, scheme, t=1.0).forces(0.7)
    assert forces.multiplier == pytest.approx([2.0, 1.0, 0.0], abs=1e-9)
    assert forces.force[:, 1] == pytest.approx([-2.0, 1.0, 1.0], abs=1e-9)


@pytest.mark.parametrize("scheme", [dincl.EventDriven(1e-9), dincl.CatchUp(0.01, dincl.ActiveSet(1e-12))])
def test_a_rod_has_one_row_of_either_sign(scheme):
    for pull in (1.0, -1.0):
        drift = dincl.drifts.constant([(0.0, 0.0), (pull, 0.0)])
        rod = dincl.Problem([(0.0, 0.0), (1.0, 0.0)], drift, [dincl.Distance([(0, 1)], 1.0)])
        forces = dincl.solve(rod, scheme, t=1.0).forces(0.5)
        assert forces.multiplier == pytest.approx([-pull / 2], abs=1e-9)
        assert forces.particles == ((0, 1),)


@pytest.mark.parametrize("scheme", [dincl.EventDriven(1e-9), dincl.PBD(0.01), dincl.SecondOrderPBD(0.01)])
def test_until_sees_positions_and_paths_go_on_with_mobilities(scheme):
    falling = dincl.Problem([(0.0, 0.5), (0.0, 3.5)], DOWN, [dincl.NonOverlap(0.5)], mobility=[0.0, 0.5])
    end = 3.0 if not isinstance(scheme, dincl.SecondOrderPBD) else 12**0.5 / 2**0.5
    path = dincl.solve(falling, scheme, t=9.0, until=lambda t, x: x[1, 1] - 2.0)
    assert path.t[-1] == pytest.approx(end, abs=0.02)
    assert path.final == pytest.approx(np.array([(0.0, 0.5), (0.0, 2.0)]), abs=1e-12)
    rest = dincl.solve(path, scheme, t=path.t[-1] + [0.1])
    if path.velocity is not None:
        assert path.velocity[1, 1] == pytest.approx(-end / 2, abs=0.02)
        assert rest.final[1, 1] == pytest.approx(2.0 - 0.1 * end / 2, abs=0.01)
    else:
        assert rest.final[1, 1] == pytest.approx(1.95)
