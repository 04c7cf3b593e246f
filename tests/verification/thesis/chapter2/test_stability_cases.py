"""Every failure that theory predicts is found where it is expected; the cheap ones in full, the others in short."""

import math

import numpy as np
import pytest

import dincl
from verification.thesis.chapter2.stability import (
    box,
    crowd,
    decades,
    drift,
    jaws,
    pacman,
    penalty,
    radius,
    rows,
    saddle,
)
from verification.thesis.chapter2.stability.catalogue import CASES
from verification.thesis.chapter2.stability.contestants import CONTESTANTS

# Found in short form by the tests below, or slow.
LONG = {
    "penalty-row-2",
    "penalty-row-4",
    "penalty-row-8",
    "penalty-dense",
    "penalty-printed",
    "penalty-pair",
    "collapse",
    "sweep-limit",
    "pbd-sweeps",
    "decades-pbd",
    "decades-springs",
    "saddle-uzawa",
    "closing-catch_up_ipopt",
}


@pytest.mark.slow_with("limits", "saddle-alpha", "saddle-beta", "saddle-damped", "saddle-weight")
@pytest.mark.parametrize("case", [case for case in CASES if case.id not in LONG], ids=lambda case: case.id)
def test_case(case):
    found = case.find()
    assert found.agrees, found


@pytest.mark.xslow
@pytest.mark.parametrize("case", [case for case in CASES if case.id in LONG], ids=lambda case: case.id)
def test_long_case(case):
    found = case.find()
    assert found.agrees, found


@pytest.mark.parametrize("n", [1, 2, 3, 8])
def test_penalty_limit_of_a_row(n):
    # The formula against the matrix of the scene, and the program just inside and just outside.
    assert penalty.row_limit(n) == pytest.approx(penalty.limit(rows.pressed(n)), rel=1e-12)
    assert penalty.rests(rows.pressed(n), 0.98 * penalty.row_limit(n) / penalty.DT)
    assert not penalty.rests(rows.pressed(n), 1.02 * penalty.row_limit(n) / penalty.DT)


@pytest.mark.parametrize("scene", [penalty.pair, penalty.hexagon])
def test_penalty_limit_of_discs(scene):
    limit = penalty.limit(scene()) / penalty.DT
    assert penalty.rests(scene(), 0.98 * limit)
    assert not penalty.rests(scene(), 1.02 * limit)


@pytest.mark.parametrize("dt", [1e-1, 1e-3])
def test_printed_penalty_never_rests(dt):
    strength = 10 * math.sqrt(2)
    assert 0.95 < penalty.chatter(dt, strength) / (dt * strength) <= 1 + 1e-9


@pytest.mark.parametrize("rows_", [2, 3, 7, 30])
def test_contraction_of_dual_sweeps(rows_):
    # Young: the spectral radius of the Gauss-Seidel matrix itself, by dense linear algebra.
    matrix = 2 * np.eye(rows_) - np.eye(rows_, k=1) - np.eye(rows_, k=-1)
    sweep = np.eye(rows_) - np.linalg.solve(np.tril(matrix), matrix)
    radius_ = float(np.abs(np.linalg.eigvals(sweep)).max())
    assert rows.predicted_contraction(rows_) == pytest.approx(radius_, rel=1e-6)
    assert rows.contraction(rows_) == pytest.approx(radius_, rel=1e-6)


def test_sweeps_of_pbd_grow_as_the_square():
    few, many = rows.sweeps_needed(8), rows.sweeps_needed(16)
    assert 3.5 < many / few < 4.5
    assert rows._overlap_after(rows_problem(8), few) <= rows.SORTED < rows._overlap_after(rows_problem(8), few - 1)


def rows_problem(n):
    start = (0.9 * np.arange(n) + 0.5)[:, None]
    return dincl.Problem(rows.packed(n), lambda _t, _x: start - rows.packed(n), rows.pressed(n).constraints)


@pytest.mark.parametrize("n", [1, 2, 4, 6])
def test_equilibrium_of_pbd_in_a_row(n):
    # All discs, not only the last: overlap of pair k, from the balance of a step.
    dt = 1e-3
    overlaps = [n - k - 1 + (n if k == 1 else 0) for k in range(1, n)]
    assert rows.equilibrium(n, dt) == pytest.approx(dt * np.concatenate(([0], np.cumsum(overlaps))), abs=1e-10)
    assert rows.sunk(n) == sum(overlaps)
    # More sweeps help, and smaller steps.
    if n > 1:
        assert rows.equilibrium(n, dt, sweeps=4)[-1] < rows.equilibrium(n, dt)[-1] / 2


def test_gauss_seidel_reports_its_limit(monkeypatch):
    from dincl.projection import gauss_seidel

    monkeypatch.setattr(gauss_seidel, "ROUNDS", 1)
    scheme = CONTESTANTS["linearised_gauss_seidel"].scheme(1.0)
    path = dincl.solve(rows.pressed(60), scheme, t=1.0, throw=False)
    assert path.status is dincl.Status.NOT_CONVERGED
    assert "500 sweeps" in path.detail


def test_crowd_collapses_under_a_single_sweep():
    path = {n: dincl.solve(crowd.crowd(300), dincl.PBD(dt=0.1, sweeps=n), t=3.0) for n in (1, 16)}
    true = crowd.densest(300)
    assert crowd.gyration(path[1].final) < 0.5 * true < 0.85 * true < crowd.gyration(path[16].final)
    assert path[1].violation()[-1] > 0.9


def test_densest_heap():
    # Four discs: a rhombus; seven: a disc and its ring; ten: a double hexagon around a bond, sum |x|^2 = 13.5. A heap
    # of many is a round disc, R / sqrt(2).
    assert crowd.densest(4) == pytest.approx(math.sqrt(0.5))
    assert crowd.densest(10) == pytest.approx(math.sqrt(1.35))
    assert crowd.densest(7) == pytest.approx(math.sqrt(6 / 7))
    assert crowd.densest(4000) == pytest.approx(crowd.radius(4000) / math.sqrt(2), rel=1e-3)


@pytest.mark.parametrize("name", ["pbd_16", "catch_up_ipopt", "linearised_daqp"])
def test_gap(name):
    height = radius.opening(0.6)[1]
    assert height == pytest.approx(0.8)
    passed = [radius.stays(0.6, CONTESTANTS[name].scheme, part * height) for part in (0.95, 1.9, 2.1)]
    assert passed == {"pbd_16": [True, False, False], "catch_up_ipopt": [True, True, False]}.get(name, [True] * 3)


@pytest.mark.parametrize("half", [pacman.NARROW, pacman.WIDE, 0.2])
def test_nearest_point_of_pacman(rng, half):
    side = np.linspace(-1, 1, 401)
    grid = np.array([z for z in np.stack(np.meshgrid(side, side), -1).reshape(-1, 2) if pacman.inside(z, half)])
    for x in rng.uniform(-1.5, 1.5, (30, 2)):
        found = pacman.nearest(x, half)
        # On S up to rounding: the point half a rounding further in is inside.
        assert any(
            pacman.inside(found * (1 - 1e-12) + shift, half) for shift in 1e-12 * np.array([[-1, 0], [0, 1], [0, -1]])
        )
        nearest = np.sqrt(((grid - x) ** 2).sum(axis=1)).min()
        assert np.linalg.norm(found - x) <= nearest + 1e-12
        assert np.linalg.norm(found - x) >= nearest - 0.005


def test_linearised_height_of_the_jaws():
    # By brute force: the least z_2 with both rows, over z_1.
    travel = 0.08
    a, y = jaws.APART - travel, jaws.LOW
    rho = math.hypot(a, y)
    z1 = np.linspace(-1, 1, 2001)
    need = np.max([y + (rho * (1 - rho) + side * a * z1) / y for side in (1, -1)], axis=0)
    assert need.min() == pytest.approx(jaws.linearised_height(travel), abs=1e-12)
    path = dincl.solve(jaws.jaws(1.0), CONTESTANTS["linearised_daqp"].scheme(travel), t=travel)
    assert path.final[0, 1] == pytest.approx(jaws.linearised_height(travel), abs=1e-9)


def test_exact_states_of_the_maps():
    fine = 1e-3
    path = dincl.solve(jaws.jaws(1.0), CONTESTANTS["linearised_daqp"].scheme(fine), t=jaws.TRAVEL)
    assert path.final[0] == pytest.approx([0, jaws.height(jaws.TRAVEL)], abs=5e-3)
    for fraction in (0.5, 0.8, 1.0):
        path = dincl.solve(box.box(fraction), CONTESTANTS["linearised_daqp"].scheme(0.05), t=1.0)
        assert path.final == pytest.approx(box.exact(fraction), abs=1e-8)
    assert np.isnan(box.exact(1.1)).all()
    t = np.array([0.5])
    for method in ("pbd", "second_order"):
        path = dincl.solve(drift.drawn(2.0), CONTESTANTS[method].scheme(fine), t=t)
        assert path.x == pytest.approx(drift.exact(method, 2.0, t), abs=2e-3)


@pytest.mark.parametrize("dt", [1e-2, 1.0, 100.0])
def test_pbd_stays_bounded(dt):
    for method in ("pbd", "pbd_16"):
        row = decades.run(method, dt)
        assert row["bounded"]
        assert row["growth"] < 1.05
    assert decades.run("penalty_100", dt)["bounded"] == (dt < 0.1)


def test_printed_penalty_throws_discs_by_its_step():
    # Up by 10 dt at once and down again by dt a step: looking at every tenth step would see nothing.
    assert decades.run("penalty_printed", 10.0)["growth"] > 10


def test_cells_say_what_happened():
    assert rows.cell("pbd", 1 / 64, 2)["outcome"] == "inaccurate"
    assert rows.cell("pbd", 1 / 64, 8)["outcome"] == "infeasible"
    assert rows.cell("linearised_gauss_seidel", 1 / 64, 8)["outcome"] == "converged"
    assert crowd.by_number("pbd", 1.0, 16)["outcome"] == "refused"
    assert crowd.by_number("pbd", 2.2, 16)["outcome"] == "unstable"
    assert crowd.by_sweeps("pbd", 0.3, 1)["outcome"] == "infeasible"
    assert penalty.cell("penalty_springs", 0.01, 300.0)["outcome"] == "unstable"
    assert penalty.cell("penalty_springs", 0.01, 100.0)["outcome"] == "converged"
    assert penalty.cell("penalty_springs", 0.01, 5.0)["outcome"] == "infeasible"
    assert penalty.cell("penalty_push", 0.01, 300.0)["outcome"] == "infeasible"
    assert radius.cell("catch_up_daqp", 3.0, 0.5)["outcome"] == "inaccurate"
    assert radius.cell("linearised_daqp", 3.0, 0.5)["outcome"] == "converged"
    assert jaws.cell("linearised_daqp", 0.1, 2.0)["outcome"] == "refused"
    assert jaws.cell("linearised_daqp", 0.01, 2.0)["outcome"] == "converged"
    assert box.cell("linearised_daqp", 0.1, 1.1)["outcome"] == "refused"
    assert box.cell("pbd", 0.02, 1.1)["outcome"] == "infeasible"
    assert drift.cell("pbd", 0.5, 4.5)["outcome"] == "unstable"
    assert drift.cell("second_order", 0.5, 4.5)["outcome"] == "inaccurate"
    assert saddle.cell("arrow_hurwicz", 0.5, 0.5)["outcome"] == "converged"
    assert saddle.cell("arrow_hurwicz", 0.5, 20.0)["outcome"] in {"unstable", "did not terminate"}
    assert saddle.cell("uzawa", 1.0, 1.5)["outcome"] == "converged"
    assert saddle.cell("uzawa", 1.0, 2.5)["outcome"] != "converged"
