"""A run goes on from each saved state with the bits that it has without a stop, or with other numbers from there."""

import numpy as np
import pytest

from dincl.errors import InvalidProblem
from tests.tissue.bits import same_end
from tests.tissue.test_types import MIXED
from tissue.events.known import bit
from tissue.files.parameters import preset
from tissue.frames.frame import Frame
from tissue.runs.simulate import simulate, simulate_many
from tissue.state.cells import NAMED

# A run that goes on later may end before an event.
pytestmark = pytest.mark.filterwarnings("ignore:.* never begins")

# Every cell divides in these hours; one event after the other begins, some before and some after each saved state.
LIVELY = {"cell.min_cycle": "1 h", "cell.max_cycle": "3 h", "cell.g2": "0.4 h", "cell.mitosis": "0.4 h"}
EVENTS = {
    "emt.cells": 5,
    "emt.inm": 0.5,
    "emt.a": "0 h to 3 h",
    "emt.b": "0.5 h to 2 h",
    "emt.s": "1 h",
    "emt.p": "2 h",
}
LENGTHS = {"numerics.t_end": "4 h", "numerics.keep": "0.5 h", "tissue.cells": 30, "tissue.width": "8 R_soft"}


def parameters_of(name, changes=()):
    return preset(name).changed({**LENGTHS, **LIVELY, **dict(changes)})


# The same bits


def test_abreast_the_same_bits():
    """Three runs abreast, and one of them alone, go on from states made alone."""
    parameters = parameters_of("published", EVENTS)
    whole = simulate_many(parameters, range(3))
    short = simulate_many(parameters.changed({"numerics.t_end": "1.5 h"}), range(3))
    rest = simulate_many(parameters, range(3), [run.final for run in short])
    assert all(map(same_end, whole, rest))
    assert same_end(whole[1], simulate(parameters, 1, short[1].final))


# Branches


def test_one_state_and_many_seeds():
    """Seeds part from the state on; that of the run before goes on; each branch goes on from its own states."""
    parameters = parameters_of("published")
    run = simulate(parameters, 3)
    branches = simulate_many(parameters, [3, 4, 5], run.frames[4])
    assert same_end(run, branches[0])
    finals = [branch.final.cells.y[:30] for branch in branches]
    assert not np.array_equal(finals[0], finals[1])
    assert not np.array_equal(finals[1], finals[2])
    assert all(np.array_equal(branch.frames[0].cells.x, run.frames[4].cells.x) for branch in branches)
    assert same_end(branches[1], simulate(parameters, 4, branches[1].frames[2]))


def test_a_control_tissue_gets_its_emt_cells_in_the_middle_when_it_branches():
    parameters = parameters_of("published")
    start = simulate(parameters, 3).frames[4]
    emt = {"emt.cells": 3, "emt.a": "2.5 h", "emt.b": "3 h", "emt.inm": 0}
    run = simulate(parameters.changed(emt), 3, start)
    n = len(start.cells.x)
    mine = np.flatnonzero(run.frames[0].cells.emt >= 0)
    assert mine.tolist() == [(n - 3) // 2 + k for k in range(3)]
    ends = run.final.cells.emt >= 0
    assert (run.final.cells.events[ends] == bit("a") | bit("b")).all()
    assert not run.final.cells.moves[ends].any()
    assert not run.final.cells.divides[ends].any()
    assert start.cells.emt.max() == -1


def test_stiffnesses_are_those_of_the_new_parameters():
    parameters = parameters_of("published").changed({"emt.cells": 1, "emt.a": "1 h", "emt.b": "1 h", "emt.s": "1 h"})
    start = simulate(parameters, 3).frames[4]
    stiff = {"cell.alpha_ax": 8, "cell.alpha_bx": 6, "cell.alpha_axb": 3, "events.bent_stiffness": 0.5}
    cells = simulate(parameters.changed(stiff), 3, start).frames[0].cells
    for name, freed, other in (("stiff_ax", 0.8, 8), ("stiff_bx", 0.1 * 6.0, 6), ("stiff_axb", 0.5, 3)):
        values = getattr(cells, name)
        np.testing.assert_allclose(values[cells.emt >= 0], freed, rtol=1e-15)
        assert (values[cells.emt < 0] == other).all()


def test_numbers_of_a_type_may_change_from_a_state_on():
    half = simulate(MIXED.changed({"numerics.t_end": "3 h"}), 7).final
    assert half.past.types == ("stiff", "quick", "leaving")
    assert same_end(simulate(MIXED, 7), simulate(MIXED, 7, half))
    cells = simulate(MIXED.changed({"types.stiff.alpha_ax": 2}), 7, half).final.cells
    assert (cells.stiff_ax[cells.kind == NAMED] == 2.0).all()


# What makes no sense

GROUPED = {"emt.cells": 3, "emt.a": "1 h"}
SAME = "must be that of the start, "


@pytest.mark.parametrize(
    ("before", "changes", "message"),
    [
        ({}, {"numerics.t_end": "2 h"}, r'numerics\.t_end = "2 h": must be at least the time of the start, t = 2\.5 h'),
        (
            {},
            {"numerics.dt": "0.2 h", "numerics.keep": "1 h", "numerics.substeps": 40},
            r"numerics\.dt = .* must divide the time of the start",
        ),
        (
            {},
            {"emt.cells": 1, "emt.b": "2 h"},
            r'emt\.b = "2 h": must be after the time of the start, t = 2\.5 h; this',
        ),
        (
            {},
            {"emt.cells": 190, "tissue.cells": 200, "tissue.width": "300 um"},
            r"emt\.cells = 190: must be at most \d+",
        ),
        (GROUPED, {"emt.cells": 4}, rf"emt\.cells = 4: {SAME}3"),
        (GROUPED, {"emt.b": "3 h"}, rf"emt\.b = '3 h': {SAME}'never'"),
        (GROUPED, {"types.more.cells": 1, "types.more.place": 0.9}, rf"types\.more\.cells = 1: {SAME}left out"),
        (GROUPED, {"cell.soft_radius": "4 um"}, rf"cell\.soft_radius = '4 um': {SAME}'5 um'"),
        ({}, {"cell.soft_radius": "5.001 um"}, rf"cell\.soft_radius = '5.001 um': {SAME}'5 um'"),
        ({}, {"layer.shape": "circle", "layer.perimeter": "600 um"}, rf"layer\.shape = 'circle': {SAME}'line'"),
    ],
)
def test_changes_that_make_no_sense(before, changes, message, tmp_path):
    parameters = parameters_of("thesis").changed(before)
    start = simulate(parameters.changed({"numerics.t_end": "2.5 h"}), 3).final
    start.save(tmp_path / "state")
    for one in (start, Frame.load(tmp_path / "state")):
        with pytest.raises(InvalidProblem, match=message):
            simulate(parameters.changed(changes), 3, one)


def test_a_state_that_failed_is_no_start(tmp_path):
    failing = parameters_of("thesis").changed({"tissue.diffusion": "1e12 um^2/h"})
    run = simulate(failing, throw=False)
    assert not run.status
    run.final.save(tmp_path / "failed.npz")
    for start in (run.final, Frame.load(tmp_path / "failed.npz")):
        with pytest.raises(InvalidProblem, match=r"start at t = .* h: cell \d+ has a coordinate that is not finite"):
            simulate(parameters_of("thesis"), start=start)


def test_only_states_of_runs_are_starts(tmp_path):
    parameters = parameters_of("thesis")
    run = simulate(parameters)
    bare = run.final._replace(checkpoint=None)
    for start, what in (
        (bare, "a frame at t = 4 h that no run"),
        (run, "start = Run"),
        (run.final.cells, "start = Cells"),
    ):
        with pytest.raises(InvalidProblem, match=rf"^{what}.*must be a saved state of a run"):
            simulate(parameters, start=start)
    with pytest.raises(InvalidProblem, match="no run has made"):
        bare.save(tmp_path / "bare.npz")


def test_starts_of_many_runs_are_one_for_each_and_of_one_time():
    parameters = parameters_of("thesis")
    frames = simulate(parameters).frames
    for starts in (frames[1:3], frames[1:2]):
        with pytest.raises(
            InvalidProblem, match=r"start = \d frames at t = .* h: must be 2, one for each seed, of one time"
        ):
            simulate_many(parameters, range(2), starts)
