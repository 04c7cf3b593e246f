"""A run goes on from each saved state with the bits that it has without a stop, or with other parameters from there."""

import numpy as np
import pytest

import tissue
from dincl.errors import InvalidProblem
from tests.tissue.bits import same, same_end
from tissue.events.known import bit, row
from tissue.files.parameters import preset
from tissue.frames.frame import Frame
from tissue.runs.simulate import simulate, simulate_many

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
SETTINGS = {
    "thesis": ("thesis", {}),
    "published": ("published", {}),
    "thesis, EMT": ("thesis", EVENTS),
    "published, EMT": ("published", EVENTS),
    "noise in substeps": ("published", {**EVENTS, "numerics.noise": "substep"}),
}
each_setting = pytest.mark.parametrize("setting", SETTINGS)


def parameters_of(setting):
    name, changes = SETTINGS[setting]
    return preset(name).changed({**LENGTHS, **LIVELY, **changes})


# The same bits


@each_setting
def test_abreast_the_same_bits(setting):
    """Three runs abreast, and one of them alone, go on from states made alone."""
    parameters = parameters_of(setting)
    whole = simulate_many(parameters, range(3))
    short = simulate_many(parameters.changed({"numerics.t_end": "1.5 h"}), range(3))
    rest = simulate_many(parameters, range(3), [run.final for run in short])
    assert all(map(same_end, whole, rest))
    assert same_end(whole[1], simulate(parameters, 1, short[1].final))


def test_stopping_twice_and_ending_at_once():
    parameters = parameters_of("published, EMT")
    whole, at = simulate(parameters, 3), None
    for end in ("1 h", "2.5 h", "4 h", "4 h"):
        at = simulate(parameters.changed({"numerics.t_end": end}), 3, at).final
    assert same(at, whole.final)
    assert [frame.t for frame in simulate(parameters, 3, at).frames] == [4.0]


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


def test_what_has_begun_stays_and_what_has_not_has_new_times():
    parameters = parameters_of("published").changed({"emt.cells": 3, "emt.a": "1 h", "emt.s": "3 h"})
    start = simulate(parameters, 3).frames[4]
    run = simulate(parameters.changed({"emt.a": "never", "emt.s": "never", "emt.b": "3.5 h"}), 3, start)
    ends = run.final.cells.emt >= 0
    assert (run.final.cells.events[ends] == bit("a") | bit("b")).all()
    assert (run.final.checkpoint.emt.at[row("a")] == 1.0).all()
    assert np.isinf(run.final.checkpoint.emt.at[row("s")]).all()


def test_stiffnesses_are_those_of_the_new_parameters():
    parameters = parameters_of("published").changed({"emt.cells": 1, "emt.a": "1 h", "emt.b": "1 h", "emt.s": "1 h"})
    start = simulate(parameters, 3).frames[4]
    stiff = {"cell.alpha_ax": 8, "cell.alpha_bx": 6, "cell.alpha_axb": 3, "events.bent_stiffness": 0.5}
    cells = simulate(parameters.changed(stiff), 3, start).frames[0].cells
    for name, freed, other in (("stiff_ax", 0.8, 8), ("stiff_bx", 0.1 * 6.0, 6), ("stiff_axb", 0.5, 3)):
        values = getattr(cells, name)
        np.testing.assert_allclose(values[cells.emt >= 0], freed, rtol=1e-15)
        assert (values[cells.emt < 0] == other).all()


def test_another_step_after_the_start():
    parameters = parameters_of("thesis")
    start = simulate(parameters, 3).frames[4]
    finer = simulate(parameters.changed({"numerics.dt": "0.05 h"}), 3, start)
    assert [frame.t for frame in finer.frames] == pytest.approx([2.0, 2.5, 3.0, 3.5, 4.0])


# What makes no sense


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"numerics.t_end": "2 h"}, r'numerics\.t_end = "2 h": must be at least the time of the start, t = 2\.5 h'),
        (
            {"numerics.dt": "0.2 h", "numerics.keep": "1 h", "numerics.substeps": 40},
            r"numerics\.dt = .* must divide the time of the start",
        ),
        ({"emt.cells": 4}, r"emt\.cells = 4: must be 3, as many as there are at the start"),
        ({"emt.b": "2 h"}, r'emt\.b = "2 h": must be after the time of the start, t = 2\.5 h, for cell \d+, in which'),
    ],
)
def test_changes_that_make_no_sense(changes, message):
    parameters = parameters_of("thesis").changed({"emt.cells": 3, "emt.a": "1 h"})
    start = simulate(parameters, 3).frames[5]
    with pytest.raises(InvalidProblem, match=message):
        simulate(parameters.changed(changes), 3, start)


@pytest.mark.parametrize("radius", ["5.001 um", "10 um", "4 um"])
def test_a_state_knows_its_unit(radius, tmp_path):
    """Lengths of a state are over R_soft: with another one 38.85 um would be 77.7 um at the same time."""
    parameters = parameters_of("thesis")
    run = simulate(parameters, 3)
    run.frames[2].save(tmp_path / "state")
    later = parameters.changed({"cell.soft_radius": radius, "numerics.substeps": 40})
    for start in (run.frames[2], Frame.load(tmp_path / "state")):
        with pytest.raises(InvalidProblem, match=rf'cell\.soft_radius = "{radius}": must be that of the start, 5 um'):
            simulate(later, 3, start)
    with pytest.raises(InvalidProblem, match=r'cell\.soft_radius = "6 um": must be that of the start'):
        simulate(preset("gastrulation"), 3, start)
    same = simulate(parameters, 3, Frame.load(tmp_path / "state"))
    assert same.summary().iloc[0].height_um == run.summary().iloc[2].height_um


def test_a_group_that_is_larger_than_the_tissue():
    start = simulate(parameters_of("thesis"), 3).frames[0]
    with pytest.raises(InvalidProblem, match=r"emt\.cells = 40: must be at most 28"):
        simulate(
            parameters_of("thesis").changed({"tissue.cells": 60, "tissue.width": "50 um", "emt.cells": 40}), 3, start
        )


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


def test_frames_of_the_quasi_steady_model_are_starts():
    parameters = parameters_of("thesis").changed({"numerics.t_end": "0.2 h", "numerics.keep": "0.1 h"})
    found = tissue_quasi_steady(parameters)
    assert simulate(parameters, 3, found.frames[1]).status


def tissue_quasi_steady(parameters):
    from tissue.quasi_steady.run import simulate_quasi_steady

    return simulate_quasi_steady(parameters, 3, throw=False)


def test_names():
    assert tissue.Frame is Frame
