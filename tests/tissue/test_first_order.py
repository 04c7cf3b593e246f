"""A run is a function of (parameters, seed) alone, says how it ended, and does no more work than it needs."""

import numpy as np
import pytest

import dincl
from dincl.status import Status
from tests.tissue import kernel_calls as kernels
from tests.tissue.bits import same_cells
from tests.tissue.states import cells, layers
from tests.twins.tissue.state import Tissue
from tissue.files.parameters import preset
from tissue.kernels.workspace import LOST
from tissue.runs.group import Group
from tissue.runs.run import RunFailed
from tissue.runs.simulate import simulate
from tissue.runs.start import started
from tissue.state.cells import Forces
from tissue.state.checkpoint import streams
from tissue.state.running import COUNTERS
from tissue.step.advance import DONE

SHORT = {name: preset(name).changed({"numerics.t_end": "6 h"}) for name in ("thesis", "published")}
# Every cell divides in these hours, so that a run has many events.
LIVELY = {"cell.min_cycle": "1 h", "cell.max_cycle": "3 h", "cell.g2": "0.4 h", "cell.mitosis": "0.4 h"}
NO_FORCES = {f"cell.alpha_{name}": 0 for name in ("aa", "ax", "bx", "xx", "axb")}
SMALL_DISCS = {"cell.hard_radius": "1e-6 R_soft", "cell.enlarged_radius": "1e-6 R_soft"}
COORDINATES = Forces._fields
each_preset = pytest.mark.parametrize("name", SHORT)


def finite(frame):
    """Whether all coordinates are finite numbers."""
    return all(np.isfinite(getattr(frame.cells, name)).all() for name in COORDINATES)


# A function of (parameters, seed)


@pytest.mark.parametrize("seed", [-1, 1.5, "1", None, True])
def test_bad_seed(seed):
    with pytest.raises(dincl.InvalidProblem, match="seed"):
        simulate(SHORT["thesis"], seed)


# Streams do not depend on positions


def test_listed_times_are_kept_besides_start_and_end():
    changes = {"numerics.t_end": "3 h", "numerics.keep": ["30 min", "2 h"]}
    listed, every = (simulate(preset("thesis").changed(changes | more)) for more in ({}, {"numerics.keep": "0.5 h"}))
    assert [frame.t for frame in listed.frames] == pytest.approx([0.0, 0.5, 2.0, 3.0])
    for frame, k in zip(listed.frames, (0, 1, 4, 6), strict=True):
        assert same_cells(frame, every.frames[k])
    ends = simulate(preset("thesis").changed(changes | {"numerics.keep": ["3 h"]}))
    assert [frame.t for frame in ends.frames] == [0.0, listed.final.t]


def test_same_noise_whatever_the_steps():
    """Nuclei that nothing pushes go where the noise takes them."""
    still = SHORT["thesis"].changed({**NO_FORCES, **SMALL_DISCS, "tissue.two_daughters": 0})
    a, b = (simulate(still.changed({"numerics.substeps": count})) for count in (1, 50))
    np.testing.assert_array_equal(a.final.cells.x, b.final.cells.x)
    assert np.abs(a.final.cells.x - a.frames[0].cells.x).max() > 1.0


@each_preset
def test_draws_do_not_depend_on_positions(name):
    """After some hours the generators stand where they stand for a tissue of other places, forces and substeps."""
    n, numbers = 30, preset(name).numbers()._replace(min_cycle=1.0, max_cycle=3.0)
    states = []
    for seed, substeps, mu in ((0, 20, 0.2), (1, 7, 1.0)):
        state = cells(n, seed, birth=0.0, cycle=np.linspace(1.0, 3.0, n))
        kept, generators = kernels.held(Tissue(state, layers(n), n), 10 * n), kernels.generators(0)
        chosen = numbers._replace(substeps=substeps, mu=mu)
        assert Group([kept], chosen, [kernels.Random(*generators)]).call(0, 60) == (60, DONE)
        states.append([generator.bit_generator.state for generator in generators])
    assert states[0] == states[1]


# What is kept


@each_preset
def test_frames(name):
    run = simulate(SHORT[name].changed(LIVELY))
    dt = SHORT[name].numerics.dt.value
    steps_in_an_hour = round(1 / dt)
    assert [frame.t for frame in run.frames] == [steps_in_an_hour * k * dt for k in range(7)]
    assert run.status is Status.SUCCESS
    assert run.detail == ""
    assert run.final is run.frames[-1]
    assert run.final.cells.birth.max() <= 6.0
    births = run.final.cells.birth[run.final.cells.birth > 0]
    assert len(births) > 40
    assert set(births) <= {k * dt for k in range(steps_in_an_hour * 6 + 1)}
    sizes = [len(frame.cells.x) for frame in run.frames]
    assert sizes[-1] - sizes[0] == run.stats["divisions"] > 5
    assert all(finite(frame) for frame in run.frames)


def test_the_last_time_is_kept_although_it_is_no_multiple():
    run = simulate(SHORT["thesis"].changed({"numerics.keep": "0.7 h", "numerics.t_end": "1.6 h"}))
    np.testing.assert_allclose([frame.t for frame in run.frames], [0.0, 0.7, 1.4, 1.6], rtol=1e-15)
    once = simulate(SHORT["thesis"].changed({"numerics.keep": "5 h", "numerics.t_end": "1.6 h"}))
    assert [frame.t for frame in once.frames] == [0.0, 1.6]


@each_preset
def test_basal_points_are_one_number(name):
    run = simulate(SHORT[name].changed(LIVELY))
    for frame in run.frames:
        assert frame.cells.by.tobytes() == np.zeros(len(frame.cells.x)).tobytes()


# Failure


def failing(name, diffusion):
    """A run whose noise throws nuclei out of all bounds."""
    noise = {"tissue.diffusion": f"{diffusion} um^2/h", "numerics.keep": "0.1 h"}
    return simulate(SHORT[name].changed(noise), throw=False)


@pytest.mark.parametrize("diffusion", [5e11, 7e11, 1e12])
def test_a_run_that_leaves_all_bounds(diffusion):
    """Every saved state before the last is sound; the words name the time and the first cell that is lost."""
    run = failing("thesis", diffusion)
    assert run.status is Status.NON_FINITE
    assert run.final.t == (len(run.frames) - 1) * SHORT["thesis"].numerics.dt.value
    points = np.array([getattr(run.final.cells, name) for name in COORDINATES])
    lost = run.final.cells.id[~(np.abs(points).sum(axis=0) < LOST)]
    assert run.detail.startswith(
        f"t = {run.final.t:g} h: cell {lost[0]} has a coordinate that is not finite, or beyond"
    )
    assert all(finite(frame) for frame in run.frames[:-1])


def test_a_failed_run_raises_with_all_frames_so_far():
    quiet = failing("thesis", 1e12)
    with pytest.raises(RunFailed, match=r"finite numbers.* t = \d\.\d+ h: cell \d+ has a coordinate") as caught:
        simulate(quiet.parameters)
    run = caught.value.run
    assert len(run.frames) == len(quiet.frames) > 2
    assert all(map(same_cells, run.frames, quiet.frames))
    np.testing.assert_allclose([frame.t for frame in run.frames], 0.1 * np.arange(len(run.frames)), rtol=1e-12)


def test_a_tissue_that_collapses_is_followed():
    """Sixty nuclei without repulsion, pulled to the middle of cells a hundredth apart: every pair is near."""
    collapse = {
        **SMALL_DISCS,
        "start.nuclei": "own_basal",
        "tissue.basal_spacing": "0.01 R_soft",
        "tissue.apical_spacing": "0.01 R_soft",
        "cell.alpha_xx": 0,
        "cell.rate_ax": "0 1/h",
        "cell.rate_bx": "0 1/h",
        "numerics.mu": "2 h",
    }
    run = simulate(preset("thesis").changed(collapse), throw=False)
    assert run.status is Status.SUCCESS
    assert finite(run.final)
    assert np.ptp(run.final.cells.x) < 2.0


# Work


@each_preset
def test_counters(name):
    run = simulate(SHORT[name])
    steps = round(6 / SHORT[name].numerics.dt.value)
    assert tuple(run.stats) == COUNTERS
    assert run.stats["substeps"] == steps * SHORT[name].numerics.substeps
    assert run.stats["corrections"] > 0
    assert run.stats["basal_corrections"] > 0


@each_preset
@pytest.mark.parametrize("company", [1, 3])
def test_pairs_looked_at_grow_linearly(name, company):
    """Nuclei as wide as the apical layer, so that tissues of both sizes are equally crowded and stay so."""
    counted = []
    for n in (60, 240):
        given = SHORT[name].changed({"tissue.cells": n, "tissue.width": f"{n / 3} R_soft"})
        random = [streams(seed) for seed in range(company)]
        group = Group([started(given, one)[0] for one in random], given.numbers(), random)
        group.advance(0, 10)
        counted.append(group.pairs / (10 * given.numerics.substeps))
    assert 2 * 60 < counted[0] < 14 * 60
    assert counted[1] < 4.4 * counted[0]


def test_nothing_is_corrected_where_nothing_touches():
    free = SHORT["thesis"].changed({**SMALL_DISCS, "tissue.max_basal_distance": "1000 R_soft", "cell.alpha_bx": 0})
    stats = simulate(free.changed({"cell.alpha_axb": 0, "tissue.two_daughters": 0})).stats
    assert stats["corrections"] == 0
    assert stats["basal_corrections"] == 0
    assert stats["divisions"] == 0


def test_noise_once_per_dt_is_drawn_once_per_dt():
    """The generator stands where 2 n draws for each dt leave it; with noise in substeps, where two for a key do."""
    n, numbers = 10, preset("thesis").numbers()._replace(two_daughters=0.0)
    draws = {False: lambda other: other.standard_normal(2 * n * 3), True: lambda other: other.random(2 * 3)}
    for in_substeps, draw in draws.items():
        kept = kernels.held(Tissue(cells(n, 0), layers(n), n))
        cycle, noise = kernels.generators(0)
        Group([kept], numbers._replace(noise_in_substeps=in_substeps), [kernels.Random(cycle, noise)]).call(0, 3)
        other = kernels.generators(0)[1]
        draw(other)
        assert noise.bit_generator.state == other.bit_generator.state


@pytest.mark.parametrize("company", [1, 3])
def test_repulsion_that_is_off_looks_at_no_pair(company):
    random = [streams(seed) for seed in range(company)]
    given = SHORT["thesis"].changed({"rules.repulsion_factor": 0})
    group = Group([started(given, one)[0] for one in random], given.numbers(), random)
    group.advance(0, 1)
    assert group.pairs == 0


def test_noise_that_is_off_draws_nothing():
    kept, numbers = kernels.held(Tissue(cells(5, 0), layers(5), 5)), preset("thesis").numbers()
    cycle, noise = kernels.generators(0)
    before = noise.bit_generator.state
    Group([kept], numbers._replace(variance=0.0), [kernels.Random(cycle, noise)]).call(0, 3)
    assert noise.bit_generator.state == before
