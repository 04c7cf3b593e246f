"""Sets whose functions of time jump: contacts that are lost let go, what is outside moves to the nearest point."""

import numpy as np
import pytest

import dincl

RIGHT = dincl.drifts.constant((1.0,))
APART = dincl.drifts.constant([[-1.0], [1.0]])
TOGETHER = dincl.drifts.constant([[1.0], [-1.0]])


def jump(before, after, at=0.6):
    return lambda t: before if t <= at else after


# At t = 0.75, after a jump at 0.6 of a set in whose contact a point rests.
AWAY = {
    "ball that grows": ([[0.0]], RIGHT, dincl.InsideBall((0.0,), jump(0.5, 90.0)), [0.65]),
    "obstacle that shrinks": ([[0.0]], RIGHT, dincl.OutsideBall((1.5,), jump(1.0, 0.1)), [0.65]),
    "obstacle that moves": ([[0.0]], RIGHT, dincl.OutsideBall(jump((1.5,), (9.0,)), 1.0), [0.65]),
    "discs that shrink": ([[0.0], [1.2]], TOGETHER, dincl.NonOverlap(jump(0.5, 0.1)), [0.25, 0.95]),
    "one disc that shrinks": ([[0.0], [1.2]], TOGETHER, dincl.NonOverlap(jump([0.5, 0.5], [0.1, 0.5])), [0.25, 0.95]),
    "longer thread": ([[0.0], [0.8]], APART, dincl.MaxDistance([(0, 1)], jump(1.0, 50.0)), [-0.25, 1.05]),
    "radius at a wall": ([[0.0]], RIGHT, dincl.HalfSpace((-1.0,), -0.7, jump(0.2, 0.0)), [0.65]),
    "offset of a wall": ([[0.0]], RIGHT, dincl.HalfSpace((-1.0,), jump(-0.5, -100.5)), [0.65]),
    "wall on a path": ([[0.0]], RIGHT, dincl.Moving(dincl.HalfSpace((-1.0,), -0.5), jump((0.0,), (3.0,))), [0.65]),
    "function of time": ([[0.0]], RIGHT, dincl.Smooth(lambda t, x: jump(0.5, 100.0)(t) - x[:, 0]), [0.65]),
}
ONTO = {
    "ball that shrinks": ([[0.0]], RIGHT, dincl.InsideBall((0.0,), jump(9.0, 0.25)), [0.25]),
    "obstacle that grows": ([[0.0]], RIGHT, dincl.OutsideBall((1.5,), jump(0.1, 1.25)), [0.25]),
    "discs that grow": ([[0.0], [1.2]], dincl.drifts.constant((0.0,)), dincl.NonOverlap(jump(0.5, 1.0)), [-0.4, 1.6]),
    "shorter thread": ([[0.0], [0.8]], APART, dincl.MaxDistance([(0, 1)], jump(9.0, 0.4)), [0.2, 0.6]),
    "radius at a wall": ([[0.0]], RIGHT, dincl.HalfSpace((-1.0,), -2.0, jump(0.2, 1.75)), [0.25]),
    "offset of a wall": ([[0.0]], RIGHT, dincl.HalfSpace((-1.0,), jump(-5.0, -0.25)), [0.25]),
    "wall that catches up": ([[0.0]], RIGHT, dincl.HalfSpace((1.0,), jump(-5.0, 2.0)), [2.15]),
    "wall on a path": ([[0.0]], RIGHT, dincl.Moving(dincl.HalfSpace((-1.0,), -5.0), jump((0.0,), (-4.5,))), [0.5]),
    "function of time": ([[0.0]], RIGHT, dincl.Smooth(lambda t, x: jump(5.0, 0.25)(t) - x[:, 0]), [0.25]),
}


@pytest.mark.parametrize("name", [*(f"away: {name}" for name in AWAY), *(f"onto: {name}" for name in ONTO)])
def test_a_set_that_jumps(name):
    where, words = name.split(": ")
    x0, drift, one, exact = (AWAY if where == "away" else ONTO)[words]
    problem = dincl.Problem(x0, drift, [one])
    path = dincl.solve(problem, dincl.EventDriven(1e-7), [0.3, 0.6, 0.75])
    assert np.abs(path.final.ravel() - exact).max() <= min(path.error[-1], 1e-12)
    steps = dincl.solve(problem, dincl.PBD(1e-3), [0.3, 0.6, 0.75])
    # The last step of PBD before 0.75 begins at a time rounded.
    assert np.abs(path.x - steps.x).max() <= 2e-3
    assert path.violation().max() <= 1e-12
    if where == "away":
        assert [(event.kind, round(event.t, 12)) for event in path.events][-1] == ("release", 0.6)


@pytest.mark.parametrize("at", [0.6, 0.3, 0.75, 1.0 / 3.0])
def test_the_function_says_on_which_side_the_time_of_the_jump_lies(at):
    for onto in (False, True):
        after = -0.2 if onto else -9.0
        for function, jumped in (
            (lambda t, after=after: -0.25 if t <= at else after, False),
            (lambda t, after=after: -0.25 if t < at else after, True),
        ):
            wall = dincl.HalfSpace((-1.0,), function)
            path = dincl.solve(dincl.Problem([[0.0]], RIGHT, [wall]), dincl.EventDriven(1e-8), [at])
            assert path.final[0, 0] == pytest.approx(0.2 if onto and jumped else 0.25, abs=1e-12)
            path = dincl.solve(dincl.Problem([[0.0]], RIGHT, [wall]), dincl.EventDriven(1e-8), [at, 2 * at])
            assert path.x[0, 0, 0] == pytest.approx(0.2 if onto and jumped else 0.25, abs=1e-12)
            assert path.final[0, 0] == pytest.approx(0.2 if onto else 0.25 + at, abs=1e-12)


def test_a_column_follows_a_floor_that_rises_and_falls_at_once():
    """Three discs on a floor that jumps to 0.3, then to -1; they fall together and land again."""
    floor = dincl.HalfSpace((1.0,), lambda t: 0.0 if t < 0.2 else 0.3 if t < 0.5 else -1.0, 0.5)
    z = 0.5 + np.arange(3.0)[:, None]
    problem = dincl.Problem(z, dincl.drifts.constant((-2.0,)), [dincl.NonOverlap(0.5), floor])
    path = dincl.solve(problem, dincl.EventDriven(1e-9), [0.1, 0.3, 0.6, 1.0, 2.0])
    low = np.array([0.0, 0.3, 0.3 - 0.2, 0.3 - 1.0, -1.0])
    assert np.abs(path.x - z - low[:, None, None]).max() <= 1e-12
    assert path.violation().max() <= 1e-12


def test_sets_that_jump_at_the_same_time():
    """A disc that slides on a floor leaves it, and a wall moves away, as discs shrink; then all come back."""
    gone = lambda t: 0.4 < t <= 1.2  # noqa: E731
    sets = [
        dincl.HalfSpace((0.0, 1.0), lambda t: -7.0 if gone(t) else 0.0),
        dincl.HalfSpace((-1.0, 0.0), lambda t: -7.0 if gone(t) else -0.5),
        dincl.InsideBall((0.0, 0.0), lambda t: 20.0 if gone(t) else 3.0),
    ]
    problem = dincl.Problem([[0.25, 0.0]], dincl.drifts.constant((1.0, -2.0)), sets)
    path = dincl.solve(problem, dincl.EventDriven(1e-9), [0.2, 0.4, 0.5, 1.2, 1.3])
    exact = [[0.45, 0.0], [0.5, 0.0], [0.6, -0.2], [1.3, -1.6], [0.5, 0.0]]
    assert np.abs(path.x[:, 0] - exact).max() <= 1e-12


def test_walls_that_jump_past_each_other_leave_no_point():
    walls = [dincl.HalfSpace((1.0,), jump(0.0, 2.0)), dincl.HalfSpace((-1.0,), -1.0)]
    problem = dincl.Problem([[0.5]], lambda t, x: 0 * x, walls)
    path = dincl.solve(problem, dincl.EventDriven(1e-9), [0.5, 1.0], throw=False)
    assert path.status is dincl.Status.INFEASIBLE
    assert path.x[0, 0, 0] == 0.5
    assert path.t[-1] == pytest.approx(0.6, abs=1e-12)


def _switch(breaks, values, right):
    return lambda t: values[int(np.searchsorted(breaks, t, side="right" if right else "left"))]


@pytest.mark.parametrize("seed", range(12))
def test_jumps_agree_with_short_steps(seed):
    """Discs in a box and a ball whose walls jump away and onto them, with a drift of time that jumps, too."""
    rng = np.random.default_rng(seed)
    n, d = int(rng.integers(2, 5)), int(rng.integers(1, 3))
    breaks = np.sort(rng.uniform(0.1, 0.9, int(rng.integers(1, 4))))
    first = np.eye(d)[0]
    x0 = 0.8 * np.arange(n)[:, None] * first + 0.3 + rng.uniform(-0.05, 0.05, (n, d))

    def numbers(start, low, high):
        return _switch(breaks, np.append(start, rng.uniform(low, high, len(breaks))), bool(seed % 2))

    ways, rate = numbers(1.0, -2.0, 2.0), rng.normal(size=(n, d))
    sets = [
        dincl.HalfSpace(first, numbers(0.0, -1.0, 0.6)),
        dincl.HalfSpace(-first, numbers(-x0[-1, 0] - 0.2, -x0[-1, 0] - 0.5, 0.1 - x0[-1, 0])),
        dincl.NonOverlap(0.25),
        dincl.InsideBall(x0.mean(axis=0), numbers(3.0, 1.5, 4.0)),
    ]
    problem = dincl.Problem(x0, lambda t, x: rate * ways(t) - 0.5 * x, sets)
    times = [*breaks, 1.0]
    path = dincl.solve(problem, dincl.EventDriven(1e-8), times)
    steps = [dincl.solve(problem, dincl.CatchUp(dt, dincl.ActiveSet(1e-11)), times).x for dt in (2e-3, 1e-3)]
    # Steps of order one: the state at a jump lies on either side, so that only the end is compared.
    apart = np.abs(steps[1][-1] - steps[0][-1]).max()
    assert np.abs(path.final - steps[1][-1]).max() <= 3 * apart + 5e-3
    assert path.violation().max() <= 1e-11


def test_a_contact_at_the_end_of_a_run_needs_no_motion_behind_it():
    """A wall closes on two discs until they fill the room, at the very end: behind it there would be no point."""
    wall = dincl.HalfSpace((-1.0,), lambda t: -(3.0 - t), 0.5)
    problem = dincl.Problem(
        [[0.5], [2.0]], lambda t, x: 0 * x, [dincl.NonOverlap(0.5), dincl.HalfSpace((1.0,), 0.0, 0.5), wall]
    )
    path = dincl.solve(problem, dincl.EventDriven(1e-8), t=[0.75, 1.0])
    assert np.abs(path.final.ravel() - [0.5, 1.5]).max() <= path.error[-1]
