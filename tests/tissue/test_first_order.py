"""A run is a function of (parameters, seed) alone, says how it ended, and does no more work than it needs."""

import numpy as np
import pytest

import dincl
from dincl.status import Status
from tests.tissue import kernel_calls as kernels
from tests.tissue.bits import same_cells
from tests.tissue.kernel_calls import Tissue
from tests.tissue.states import cells, layers
from tissue.files.parameters import preset
from tissue.kernels.workspace import LOST
from tissue.runs.group import Group
from tissue.runs.run import RunFailed
from tissue.runs.simulate import simulate, simulate_many
from tissue.runs.start import started
from tissue.state.cells import Forces
from tissue.state.checkpoint import streams
from tissue.step.advance import DONE

SHORT = {name: preset(name).changed({"numerics.t_end": "6 h"}) for name in ("thesis", "published")}
# Every cell divides in these hours, so that a run has many events.
LIVELY = {"cell.min_cycle": "1 h", "cell.max_cycle": "3 h", "cell.g2": "0.4 h", "cell.mitosis": "0.4 h"}
NO_FORCES = {f"cell.alpha_{name}": 0 for name in ("aa", "ax", "bx", "xx", "axb")}
SMALL_DISCS = {"cell.hard_radius": "1e-6 R_soft", "cell.enlarged_radius": "1e-6 R_soft"}
COORDINATES = Forces._fields
each_preset = pytest.mark.parametrize("name", SHORT)


# A function of (parameters, seed)


@pytest.mark.parametrize("seed", [-1, 1.5, "1", None, True])
def test_bad_seed(seed):
    with pytest.raises(dincl.InvalidProblem, match="seed"):
        simulate(SHORT["thesis"], seed)
    with pytest.raises(dincl.InvalidProblem, match="seeds"):
        simulate_many(SHORT["thesis"], [0, seed])
    assert simulate_many(SHORT["thesis"], []) == ()


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


# Failure


def failing(name, diffusion):
    """A run whose noise throws nuclei out of all bounds."""
    noise = {"tissue.diffusion": f"{diffusion} um^2/h", "numerics.keep": "0.1 h"}
    return simulate(SHORT[name].changed(noise), throw=False)


@pytest.mark.parametrize("diffusion", [5e11, 1e12])
def test_a_run_that_leaves_all_bounds(diffusion):
    """Every saved state before the last is sound; the words name the time and the first cell that is lost."""
    run = failing("thesis", diffusion)
    points = np.array([getattr(run.final.cells, name) for name in COORDINATES])
    lost = run.final.cells.id[~(np.abs(points).sum(axis=0) < LOST)]
    assert run.status is Status.NON_FINITE
    assert run.detail.startswith(
        f"t = {run.final.t:g} h: cell {lost[0]} has a coordinate that is not finite, or beyond"
    )
    assert all(np.isfinite(getattr(frame.cells, name)).all() for frame in run.frames[:-1] for name in COORDINATES)
    np.testing.assert_allclose([frame.t for frame in run.frames], 0.1 * np.arange(len(run.frames)), rtol=1e-12)
    with pytest.raises(RunFailed, match=r"finite numbers.* t = \d\.\d+ h: cell \d+ has a coordinate") as caught:
        simulate(run.parameters)
    assert len(caught.value.run.frames) == len(run.frames) > 2
    assert all(map(same_cells, caught.value.run.frames, run.frames))


# Work


@each_preset
@pytest.mark.parametrize("company", [1, 3])
def test_pairs_looked_at_grow_linearly(name, company):
    """Nuclei as wide as the apical layer, so that tissues of both sizes are equally crowded and stay so."""
    counted = []
    for n in (60, 240):
        given = SHORT[name].changed({"tissue.cells": n, "tissue.width": f"{n / 3} R_soft"})
        random = [streams(seed) for seed in range(company)]
        group = Group([started(given, one) for one in random], given.numbers(), random)
        group.advance(0, 10)
        counted.append(group.pairs / (10 * given.numerics.substeps))
    assert 2 * 60 < counted[0] < 14 * 60
    assert counted[1] < 4.4 * counted[0]


@pytest.mark.parametrize("company", [1, 3])
def test_repulsion_that_is_off_looks_at_no_pair(company):
    random = [streams(seed) for seed in range(company)]
    given = SHORT["thesis"].changed({"rules.repulsion_factor": 0})
    group = Group([started(given, one) for one in random], given.numbers(), random)
    group.advance(0, 1)
    assert group.pairs == 0


# Without hard cores nuclei overlap as they like, in all of a tissue or in one type

NONE = {"cell.hard_radius": "0 um", "cell.enlarged_radius": "0 um"}
SOFT = {"types.soft.cells": 20, "types.soft.hard_radius": "0 um", "types.soft.enlarged_radius": "0 um"}
# Without soft repulsion nothing else parts nuclei.
NO_REPULSION = {"numerics.t_end": "2 h", "numerics.keep": "1 h", "cell.alpha_xx": 0}


def gaps(cells, mine):
    """Distances of the nearest nuclei among some cells."""
    x, y = cells.x[mine], cells.y[mine]
    apart = np.hypot(x[:, None] - x, y[:, None] - y)
    return apart[np.triu_indices(len(x), 1)].min()


@pytest.mark.parametrize("name", ["thesis", "published", "chick", "gastrulation"])
def test_no_pair_is_corrected(name):
    given = preset(name).changed(NONE | NO_REPULSION)
    runs = simulate_many(given, range(2))
    for run in runs:
        assert run.status
        assert run.stats["corrections"] == 0
    hard = simulate(preset(name).changed(NO_REPULSION), 0).final
    assert gaps(runs[0].final.cells, slice(None)) < 0.5 * gaps(hard.cells, slice(None))


def test_a_type_without_cores_among_others():
    """Its nuclei overlap one another, but not the cores of others."""
    final = simulate(preset("thesis").changed(SOFT | NO_REPULSION), 1).final
    soft = final.cells.kind == 2
    assert gaps(final.cells, soft) < 0.4
    assert gaps(final.cells, ~soft) > 0.5
    assert (final.cells.radius[soft] == 0).all()
