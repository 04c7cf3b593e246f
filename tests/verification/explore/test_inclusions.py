"""The tab of inclusions without its page: what may be chosen, what goes wrong at large dt, and the pictures of it."""

import numpy as np
import pytest

import dincl
from tests.verification.explore.test_tissues import parsed
from verification.explore.inclusions.frames import pictures
from verification.explore.inclusions.runs import (
    METHODS,
    PICTURES,
    SCENES,
    InclusionRun,
    integrate,
    kept_times,
    reference,
    scene,
)

CORNER = "ten_disks_corner"


def run(name, method, steps):
    return InclusionRun(scene(name), method, steps)


def largest(what, one):
    """The largest error or overlap of a run at the times at which the reference is known."""
    return max(getattr(state, what) for state in integrate(one) if state.error is not None)


def messages(one, gone=lambda: False):
    """Headers and numbers of a stream, no piece of which is empty: that would be its end."""
    pieces = list(pictures(one, gone))
    assert all(pieces)
    return [(header, np.frombuffer(payload, "<f4")) for header, payload in parsed(pieces)]


@pytest.mark.parametrize("name", SCENES)
def test_scenes_have_a_reference(name):
    offered = scene(name)
    assert offered is scene(name)
    assert offered.problem.x0.shape[1] <= 2
    known = reference(offered)
    assert known.x.shape == (PICTURES + 1, *offered.problem.x0.shape)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("steps", [8, 512])
def test_a_run_is_that_of_solve(method, steps):
    kept = list(integrate(one := run(CORNER, method, steps)))
    path = dincl.solve(one.inclusion.problem, METHODS[method](one.dt), t=[state.t for state in kept])
    assert len(kept) == min(steps, PICTURES) + 1
    np.testing.assert_array_equal(path.x, [state.x for state in kept])
    np.testing.assert_array_equal(path.violation(), [state.overlap for state in kept])


@pytest.mark.parametrize(("method", "order"), [("PBD", 1), ("catch-up", 1), ("midpoint catch-up", 2)])
def test_error_goes_with_dt(method, order):
    errors = [largest("error", run("sliding_disc", method, steps)) for steps in (256, 4096)]
    assert np.log2(errors[0] / errors[1]) / 4 == pytest.approx(order, abs=0.15)


def test_what_overlaps_at_large_dt_and_by_how_much_each_particle():
    overlaps = {method: largest("overlap", run(CORNER, method, 32)) for method in METHODS}
    assert overlaps["PBD"] > overlaps["PBD, 16 sweeps"] > 1e-4
    assert overlaps["linearised catch-up"] < 1e-12
    assert overlaps["penalty 100"] > 0.1
    worst = max(integrate(run(CORNER, "PBD", 32)), key=lambda state: state.overlap)
    gaps = np.linalg.norm(worst.x[:, None] - worst.x, axis=-1) - 1.0 + 2 * np.eye(10)
    walls = np.stack((worst.x @ (1, 1), worst.x @ (-1, 1))) / np.sqrt(2) - 0.5
    deep = np.maximum(0.0, -np.minimum(gaps.min(axis=0), walls.min(axis=0)))
    np.testing.assert_allclose(worst.deep, deep, atol=1e-12)


@pytest.mark.parametrize("steps", [8, 1024])
def test_pictures_are_those_of_the_run(steps):
    head, *frames, end = messages(one := run(CORNER, "PBD", steps))
    assert head[0]["painter"] == "discs"
    assert head[0]["radius"] == [0.5] * 10
    np.testing.assert_allclose([frame[0]["t"] for frame in frames], kept_times(one.inclusion.end), atol=1e-12)
    assert end[0] == {"kind": "end", "status": "SUCCESS", "detail": ""}
    assert [len(frame[0].get("shapes", ())) for frame in frames] == [2, *[0] * PICTURES]
    last, columns = frames[-1][0], frames[-1][1].reshape(5, 10)
    kept = list(integrate(one))[-1]
    np.testing.assert_allclose(columns[:2].T, kept.x, rtol=1e-6)
    assert (last["overlap"], last["error"]) == (kept.overlap, kept.error)
    assert np.hypot(*(columns[:2] - columns[3:])).max() == pytest.approx(kept.error, rel=1e-4)
    left, right, low, high = head[0]["box"]
    shown = np.array([frame[1].reshape(5, 10)[3:] for frame in frames])
    assert left < shown[:, 0].min() - 0.5 < shown[:, 0].max() + 0.5 < right
    assert low < shown[:, 1].min() - 0.5 < shown[:, 1].max() + 0.5 < high


def test_pictures_of_a_line_of_what_blows_up_and_of_what_fails():
    head, *frames, _ = messages(run("sweeping_interval", "catch-up", 16))
    assert head[0]["box"][2] < 0 < head[0]["box"][3]
    assert not frames[5][1].reshape(5, 1)[1]
    assert [shape["normal"] for shape in frames[5][0]["shapes"]] == [[1, 0], [-1, 0]]
    assert frames[5][0]["shapes"] != frames[6][0]["shapes"]
    (head, _), *frames, _ = messages(run("sweeping_interval", "penalty 100", 32))
    size = head["box"][1] - head["box"][0]
    assert max(header["overlap"] for header, _ in frames) > 1e10
    assert 2 * size < max(abs(payload[0]) for _, payload in frames) < 4 * size
    (*_, (end, _)), (*_, state) = messages(run("four_disks", "PBD", 2)), integrate(run("four_disks", "PBD", 2))
    assert (end["status"], end["detail"], state.t) == ("COINCIDENT_CENTRES", state.fault, 0.0)
    assert "coincide" in state.fault
    assert "use a smaller dt" in state.fault


@pytest.mark.parametrize("allowed", [0, 3])
def test_stop_ends_the_work(allowed):
    asked = []

    def gone():
        asked.append(None)
        return len(asked) > allowed

    assert len(list(integrate(run(CORNER, "PBD", 64), gone))) == allowed
    asked.clear()
    assert [header["kind"] for header, _ in messages(run(CORNER, "PBD", 64), gone)][-1] != "end"
