"""Forces that users add: they do what mechanics says, wherever they run, and cost nothing where there are none."""

import math
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

import tissue
from dincl.errors import InvalidProblem
from dincl.status import Status
from tests.tissue import kernel_calls as kernels
from tests.tissue import states
from tests.tissue.bits import same
from tests.tissue.own_forces.users import (
    EMT,
    LAYERS,
    NAME,
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
from tissue.state.cells import COORDINATES
from tissue.state.running import contents, new_state

each_layer = pytest.mark.parametrize("layer", LAYERS)


@pytest.fixture(scope="module", autouse=True)
def own(tmp_path_factory):
    """The module of a user; nothing of it is left."""
    before = dict(registry(tissue.Force))
    registry(tissue.Force).clear()
    file = tmp_path_factory.mktemp("own") / f"{NAME}.py"
    shutil.copy(Path(__file__).with_name("module.py"), file)
    tissue.preset("thesis").changed({"own.modules": [str(file)]})
    yield file
    sys.modules.pop(NAME, None)
    registry(tissue.Force).clear()
    registry(tissue.Force).update(before)


@pytest.fixture
def kept():
    """What a test registers is gone after it."""
    before = dict(registry(tissue.Force))
    yield
    registry(tissue.Force).clear()
    registry(tissue.Force).update(before)


# What a force does


def test_points_without_other_forces_go_to_the_point_as_explicit_euler_does():
    """Z - P is (1 - h s / mu)^n of what it was; a basal point on the line stays there, a free one goes."""
    x, a, b = (np.array([[-40.0, y], [0.5, y], [50.0, y]]) for y in (4.0, 8.0, 0.0))
    free = {f"stiff_{name}": 0.0 for name in ("ax", "bx", "axb", "aa")}
    cells, numbers = states.tissue(x, a, b, radius=0.01, **free), states.numbers(repulsion=0.0, max_basal_distance=1e3)
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


# The same bits


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


# Parameters


def test_the_strength_is_a_key(own):
    given = published(own, **{"forces.wall": "1/2"})
    assert dict(given.forces) == {"wall": 0.5}
    assert given.changed({"forces.point": 3}).as_dict()["forces"] == {"point": 3.0, "wall": 0.5}
    assert [(force.name, strength) for force, strength in given.forces.acting()] == [("wall", 0.5)]
    text = given.as_toml()
    assert "[forces]\nwall = 0.5  # nothing is above a height\n" in text
    again = own.with_name("again.toml")
    again.write_text(text, "utf-8")
    assert tissue.load(again) == given


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"forces.wall": -1}, "forces.wall = -1: must be a number >= 0, without unit"),
        ({"forces.wall": "1 um"}, "forces.wall = '1 um': must be a number >= 0, without unit"),
        ({"forces.wall": math.nan}, "forces.wall = nan: must be a number >= 0"),
        ({"forces.walls": 1}, "forces.walls = 1: unknown key; the nearest known one is forces.wall$"),
    ],
)
def test_what_is_wrong_is_named(own, changes, message):
    with pytest.raises(InvalidProblem, match=message):
        published(own, **changes)


def test_without_any_force_the_section_is_empty(tmp_path, kept):
    registry(tissue.Force).clear()
    with pytest.raises(
        InvalidProblem, match=r"wall = 1: unknown key; no force is registered, as files in own.modules do"
    ):
        tissue.preset("thesis").changed({"forces.wall": 1})
    file = tmp_path / "bad.toml"
    for text, message in (
        ("forces.wall = 1", "bad.toml: forces.wall = 1: unknown key; no force is registered"),
        ("forces = 3", r"forces = 3: must be a section \[forces\] with names of registered forces"),
    ):
        file.write_text(f'base = "thesis"\n{text}\n', "utf-8")
        with pytest.raises(InvalidProblem, match=message):
            tissue.load(file)
    file.write_text('base = "thesis"\n[forces]\n', "utf-8")
    assert tissue.load(file) == tissue.preset("thesis")


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
            assert ("Force explosive: push is not finite on cell 0; cell" in run.detail) == (strength == 1.0)
            with pytest.raises(tissue.RunFailed):
                tissue.simulate(exploding, seed)
        else:
            assert same(run.final, tissue.simulate(given, seed).final)


def half_a_wall(store, on, strength, numbers):
    for i in range(store.sizes[0]):
        on.ay[i] -= 0.5 * strength * max(0.0, store.cells.ay[i] - WALL)
        on.y[i] -= 0.5 * strength * max(0.0, store.cells.y[i] - WALL)


def not_finite(store, on, strength, numbers):
    on.x[0] += math.inf


def no_energy(store, strength, numbers):
    return 0.0


def no_number(store, strength, numbers):
    return math.nan
