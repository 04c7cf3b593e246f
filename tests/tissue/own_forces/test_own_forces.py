"""Forces that users add: they do what mechanics says, wherever they run, and cost nothing where there are none."""

import math

import numpy as np
import pytest

import tissue
from dincl.errors import FunctionFailed, InvalidProblem
from dincl.status import Status
from tests.tissue import kernel_calls as kernels
from tests.tissue import states
from tests.tissue.bits import same
from tests.tissue.own_forces.users import (
    EMT,
    LAYERS,
    POINT,
    SHORT,
    WALL,
    distance,
    named,
    nothing,
    published,
)
from tissue.plugins import registry
from tissue.rules.slice import in_plane
from tissue.runs.group import Group
from tissue.state.basal_curve import curve_numbers, ellipse
from tissue.state.cells import COORDINATES
from tissue.state.running import contents, new_state

each_layer = pytest.mark.parametrize("layer", LAYERS)


# What a force does


def test_points_without_other_forces_go_to_the_point_as_explicit_euler_does():
    """Z - P is (1 - h s / mu)^n of what it was; a basal point on the line stays there, a free one goes."""
    x, a, b = (np.array([[-40.0, y], [0.5, y], [50.0, y]]) for y in (4.0, 8.0, 0.0))
    free = {f"stiff_{name}": 0.0 for name in ("ax", "bx", "axb", "aa")}
    cells, numbers = states.tissue(x, a, b, radius=0.01, **free), states.numbers(repulsion=0.0, max_basal=1e3)
    held = new_state(cells, states.layers(3, basal=[0, 2]), capacity=5, space=in_plane())
    group = Group([held], numbers, forces=[(named("point"), 0.4)])
    assert group.make_substeps()
    found = contents(group.states[0])[0]
    left = (1 - 0.4 * numbers.dt / numbers.substeps / numbers.mu) ** numbers.substeps
    for name, target in zip(COORDINATES, POINT * 3, strict=True):
        expected = target + left * (getattr(cells, name) - target)
        if name == "by":
            expected[[0, 2]] = 0.0
        assert getattr(found, name) == pytest.approx(expected, abs=1e-12)


def test_a_wall_holds_a_cell_where_forces_are_in_balance():
    """The springs have their lengths at y = 8; k = 2 alpha / l is that of both in a row, halved."""
    state = kernels.upright(height=8.0, nucleus=4.0, rest_ax=3.0, rest_bx=3.0)
    group = Group(
        [kernels.held(state)], states.numbers(repulsion=0.0, dt=1.0, substeps=400), forces=[(named("wall"), 3.0)]
    )
    for _ in range(30):
        assert group.make_substeps()
    found = contents(group.states[0])[0]
    spring = 2 * states.THESIS.alpha_ax / 4.0 / 2
    assert found.ay[0] == pytest.approx((3.0 * WALL + spring * 8.0) / (3.0 + spring), abs=1e-9)
    assert found.y[0] == pytest.approx(found.ay[0] / 2, abs=1e-9)


@each_layer
@pytest.mark.parametrize("company", [1, 3])
def test_a_force_of_the_thesis_written_by_a_user_moves_all_points_alike(own, layer, company):
    """The bending energy, with free and running basal points: as the term of the model, to what rounding grows to."""
    given = published(own, **LAYERS[layer], **EMT, **{"numerics.t_end": "2.5 h", "numerics.keep": "2.5 h"})
    theirs = given.changed({"cell.alpha_axb": 0, "forces.straight": given.cell.alpha_axb})
    without = given.changed({"cell.alpha_axb": 0})
    runs = [tissue.simulate_many(one, range(company)) for one in (given, theirs, without)]
    for ours, mine, none in zip(*runs, strict=True):
        assert (ours.final.cells.by[ours.final.cells.emt >= 0] != 0).all()
        assert distance(ours.final.cells, mine.final.cells) < 1e-8
        assert distance(ours.final.cells, none.final.cells) > 0.1


def test_a_tube_that_is_turned_moves_as_it_did():
    """A pull to the centre, and cells that are not alike: the result is turned as the state was."""
    n, angle = 24, 1.1
    curve = ellipse(30.0, 1.0, inside=True, ring=True)
    radius = curve.length / (2 * math.pi)
    centre = tissue.Force("centre", pull_to_centre, "springs to the centre of a circle")
    found = []
    for turned in (0.0, angle):
        s = curve.length / n * np.arange(n)
        points = [np.column_stack(curve.above(s, height + 0.3 * np.sin(3 * s))) for height in (2.0, 3.5, 0.0)]
        points[2] = np.column_stack(curve.above(s, np.zeros(n)))
        points = [_turned(part, turned, radius) for part in points]
        cells = states.tissue(*points, along=s + radius * turned, rest_ax=0.5 + 0.2 * np.sin(s), rest_bx=0.5)
        held = new_state(cells, capacity=n, curve=curve_numbers(curve), space=in_plane())
        group = Group([held], states.numbers(max_basal=2.0), forces=[(centre, 0.7 / radius)])
        assert group.make_substeps()
        found.append(contents(group.states[0])[0])
    for x, y in (("x", "y"), ("ax", "ay"), ("bx", "by")):
        before, after = (np.column_stack((getattr(one, x), getattr(one, y))) for one in found)
        assert after == pytest.approx(_turned(before, angle, radius), abs=1e-11)
    assert np.hypot(found[0].x, found[0].y - radius).max() < radius


def _turned(points, angle, radius):
    """Points turned around the centre (0, radius)."""
    c, s = math.cos(angle), math.sin(angle)
    return (points - [0.0, radius]) @ np.array([[c, s], [-s, c]]) + [0.0, radius]


def pull_to_centre(store, on, strength, numbers):
    """For 30 / (2 pi) = R: the centre of the circle is (0, R)."""
    cells = store.cells
    for i in range(store.sizes[0]):
        on.x[i] -= strength * cells.x[i]
        on.y[i] -= strength * (cells.y[i] - 15.0 / math.pi)
        on.bx[i] -= strength * cells.bx[i]
        on.by[i] -= strength * (cells.by[i] - 15.0 / math.pi)


# The same bits


def test_strength_0_is_none(own):
    given = published(own)
    for seed in range(2):
        one, other = (tissue.simulate(one, seed) for one in (given, given.changed({"forces.wall": 0})))
        assert same(one.final, other.final)
        assert not same(one.final, tissue.simulate(given.changed({"forces.wall": 0.1}), seed).final)


def test_the_order_of_registration_does_not_matter(own, kept):
    given = published(own, **{"forces.wall": 2.0, "forces.straight": 3.0, "forces.point": 0.1})
    before = tissue.simulate(given, 1).final
    order = list(registry(tissue.Force).values())
    registry(tissue.Force).clear()
    tissue.register(*reversed(order))
    assert [force.name for force, _ in given.forces.acting()] == ["point", "straight", "wall"]
    assert same(tissue.simulate(given, 1).final, before)


def test_two_forces_add_up(own):
    """Twice the wall is one of twice the strength."""
    double = tissue.Force("wall_too", named("wall").push, "the same wall")
    given = published(own)
    ends = []
    for forces in ([(named("wall"), 2.0)], [(named("wall"), 1.0), (double, 1.0)]):
        held = new_state(*tissue.simulate(given, 0).final[1:3], capacity=40, space=in_plane())
        group = Group([held], states.numbers(), forces=forces)
        assert group.make_substeps()
        ends.append(contents(group.states[0])[0])
    assert distance(*ends) < 1e-13


# A force against its energy


@pytest.mark.parametrize("layer", ["line", "tube"])
@pytest.mark.parametrize("strength", [1.0, 40.0])
def test_forces_are_minus_the_slope_of_the_energy(own, layer, strength):
    run = tissue.simulate(published(own, **SHORT | LAYERS[layer] | {"numerics.t_end": "1 h"}), 0)
    for name in ("wall", "straight"):
        assert tissue.force_error(named(name), run, strength) < 1e-6


def test_a_wrong_force_is_found(own):
    run = tissue.simulate(published(own, **{"numerics.t_end": "1 h"}), 0)
    wall, straight = named("wall"), named("straight")
    assert tissue.force_error(tissue.Force("w", half_a_wall, "", "", wall.energy), run) == pytest.approx(0.5, rel=1e-6)
    assert tissue.force_error(tissue.Force("w", nothing, "", "", wall.energy), run) == pytest.approx(1.0)
    assert tissue.force_error(tissue.Force("w", wall.push, "", "", no_energy), run) == pytest.approx(1.0)
    assert tissue.force_error(tissue.Force("w", wall.push, "", "", straight.energy), run) > 0.1


def test_a_state_is_not_changed_by_the_comparison(own):
    run = tissue.simulate(published(own, **{"numerics.t_end": "1 h"}), 0)
    before = tissue.simulate(run.parameters, 0).final
    tissue.force_error(named("wall"), run)
    assert same(run.final, before)


@pytest.mark.parametrize(
    ("energy", "push", "message"),
    [
        (None, "push_down", "Force f: energy = None: must be a function to compare push with"),
        ("no_energy", "nothing", "Force f at t = 1 h: must act on a point, to be compared"),
        ("no_number", "nothing", "Force f at t = 1 h: must give finite forces and energies"),
        ("no_energy", "not_finite", "Force f at t = 1 h: must give finite forces and energies"),
    ],
)
def test_what_cannot_be_compared_is_named(own, energy, push, message):
    run = tissue.simulate(published(own, **{"numerics.t_end": "1 h"}), 0)
    force = tissue.Force("f", globals().get(push, nothing), "", "", energy and globals()[energy])
    with pytest.raises(InvalidProblem, match=message):
        tissue.force_error(force, run)
    with pytest.raises(InvalidProblem, match="strength = 0: must be a finite number > 0"):
        tissue.force_error(named("wall"), run, 0)


# Failures


@each_layer
@pytest.mark.parametrize("strength", [1.0, 1e3, 1e12])
def test_what_is_not_finite_or_huge_ends_the_run_and_no_other(own, layer, strength):
    """1: no number; 1e3: out of bounds within a few substeps; 1e12: beyond all doubles."""
    given = published(own, **SHORT | LAYERS[layer] | {"numerics.t_end": "1 h", "emt.cells": 0})
    exploding = given.changed({"forces.explosive": strength})
    runs = tissue.simulate_many(exploding, range(8), throw=False)
    lost = [run.frames[0].cells.cycle[0] > 15.0 for run in runs]
    assert 0 < sum(lost) < 8
    for seed, (run, is_lost) in enumerate(zip(runs, lost, strict=True)):
        if is_lost:
            assert run.status is Status.NON_FINITE
            assert "has a coordinate that is not finite, or beyond" in run.detail
            with pytest.raises(tissue.RunFailed):
                tissue.simulate(exploding, seed)
        else:
            assert same(run.final, tissue.simulate(given, seed).final)


def test_what_does_not_compile_is_said_by_numba(own, kept):
    """As for events: the cause has the line."""
    tissue.register(tissue.Force("wordy", say, "no code for kernels"))
    message = r"Force wordy: push\(state, on, strength, numbers\) cannot be compiled: TypingError"
    with pytest.raises(FunctionFailed, match=message) as caught:
        tissue.simulate(published(own, **{"forces.wordy": 1}), 0)
    assert "def say(store, on, strength, numbers)" in str(caught.value.__cause__)


def half_a_wall(store, on, strength, numbers):
    for i in range(store.sizes[0]):
        on.ay[i] -= 0.5 * strength * max(0.0, store.cells.ay[i] - WALL)
        on.y[i] -= 0.5 * strength * max(0.0, store.cells.y[i] - WALL)


def not_finite(store, on, strength, numbers):
    on.x[0] += math.inf


def say(store, on, strength, numbers):
    on.x[0] += "a word"


def no_energy(store, strength, numbers):
    return 0.0


def no_number(store, strength, numbers):
    return math.nan
