"""The linear limit and the jitter of the tissue: predicted and found, seen by other means."""

import numpy as np
import pytest

from tests.tissue.states import THESIS, cells, layers, tissue
from tests.twins.tissue.steps import make_substeps
from tests.verification.thesis.shortened_tissue import simulated
from tissue.files.parameters import preset
from tissue.model.energy import energy, forces
from verification.thesis.chapter3 import beyond, frozen, growing, limits, linear, maps
from verification.thesis.chapter3.growing import PRESETS, SUCCESS
from verification.thesis.chapter3.jitter import substepped, swing


def test_hessian_is_that_of_the_energy():
    state, network = cells(6, 2), layers(6)
    found = linear.hessian(state, network, THESIS)
    np.testing.assert_allclose(found, found.T)
    step = 1e-5
    rng = np.random.default_rng(5)
    for _ in range(3):
        along = rng.standard_normal(30)
        moved = [
            state._replace(
                **{
                    name: getattr(state, name) + sign * step * along[6 * k : 6 * k + 6]
                    for k, name in enumerate(linear.UNKNOWNS)
                }
            )
            for sign in (1, 0, -1)
        ]
        values = [energy(one, network, THESIS) for one in moved]
        second = (values[0] - 2 * values[1] + values[2]) / step**2
        assert along @ found @ along == pytest.approx(second, rel=1e-4)


def test_hessians_of_single_cells_are_blocks_of_that_of_cells_far_apart():
    far = tissue([[0, 3], [40, 2.5]], [[0.3, 8], [40.2, 7]], [[0, 0], [41, 0]])
    whole, own = linear.hessian(far, layers(2, apical=[]), THESIS), linear.own_hessians(far, THESIS)
    for i in range(2):
        np.testing.assert_allclose(whole[i::2, i::2], own[i], atol=1e-12)


def test_bending_of_a_straight_cell():
    state = limits.standing(0.7, 7.3, stiff_axb=15.0, stiff_ax=2.0, stiff_bx=2.0)
    values = np.linalg.eigvalsh(linear.own_hessians(state.cells, state.numbers)[0])
    assert values[-1] == pytest.approx(linear.bending(15.0, 0.7, 7.3), rel=1e-12)


def test_swing_is_the_period_two_part_of_the_substeps():
    state, network = cells(8, 1), layers(8)
    scale = 1 / 30
    h = THESIS._replace(dt=scale * THESIS.mu, substeps=1)
    path = [state]
    for _ in range(2):
        path.append(make_substeps(path[-1], network, h, np.random.default_rng(0)))
    x = [growing.nuclei(growing.Frame(0.0, one, network)) for one in path]
    found = swing(state, network, THESIS, scale)
    assert found.nuclei == pytest.approx(np.hypot(*(x[2] - 2 * x[1] + x[0])) / 4, abs=1e-9)
    assert found.largest >= np.abs(x[2] - 2 * x[1] + x[0]).max() / 4 - 1e-9
    assert found.middle.x == pytest.approx((x[2] + 2 * x[1] + x[0])[0] / 4, abs=1e-9)


@pytest.mark.slow_with("case1", "case2")
@pytest.mark.parametrize(
    "case", [case for case in limits.CASES if case.id in {"bend-apical", "springs-2", "junctions"}]
)
def test_limits_are_found_where_they_are_predicted(case):
    found = case.find()
    assert found.agrees
    assert found.found == pytest.approx(found.expected, rel=1e-3)


@pytest.mark.slow
def test_the_prediction_for_junctions_is_that_of_their_energy():
    state = limits.standing(2.5, 2.5, 10, stiff_aa=5.0)
    junctions = next(case for case in limits.CASES if case.id == "junctions")
    assert frozen.limit(state) == pytest.approx(junctions.find().expected, rel=1e-9)


@pytest.mark.parametrize("name", PRESETS)
def test_a_tissue_at_rest_jitters_above_its_limit_only(name, monkeypatch):
    monkeypatch.setattr(frozen, "AGE", 1.0)
    state = frozen.at_rest(frozen.grown.__wrapped__(name))
    residual = forces(*state)
    held = max(np.abs(getattr(residual, part)).max() for part in ("ax", "ay"))  # of what nothing else holds
    assert held < 0.01
    limit = frozen.limit(state)
    for part, jitters in ((0.9, False), (1.3, True)):
        pushed = frozen.disturbed(state, 1e-5)
        end = substepped(pushed.cells, pushed.layers, pushed.numbers, part * limit, 1000)
        assert (swing(end, state.layers, state.numbers, part * limit).largest > 1e-4) == jitters


def test_far_above_the_limit_the_amplitude_depends_on_rounding(monkeypatch):
    """As the reason says that the page gives for maps whose reruns differ."""
    monkeypatch.setattr(frozen, "AGE", 1.0)
    state = frozen.at_rest(frozen.grown.__wrapped__("thesis"))
    limit, pushes = frozen.limit(state), (maps.PUSH, (1 + 1e-9) * maps.PUSH)
    for part, chaotic in ((0.9, False), (8.0, True)):
        found = []
        for push in pushes:
            pushed = frozen.disturbed(state, push)
            end = substepped(pushed.cells, pushed.layers, pushed.numbers, part * limit, maps.SUBSTEPS)
            found.append(swing(end, state.layers, state.numbers, part * limit).nuclei.mean())
        assert (found[1] != pytest.approx(found[0], rel=1e-3)) == chaotic


def test_what_the_text_says_of_jitter():
    # By the twins, and without the Hessian: the thesis preset jitters, the published one does not.
    mean, least = {}, {}
    for name in PRESETS:
        frame, numbers = simulated(name, 1, 6).final, preset(name).numbers()
        one = numbers._replace(dt=numbers.dt / numbers.substeps, substeps=1)
        path = [frame.cells]
        for _ in range(2):
            path.append(make_substeps(path[-1], frame.layers, one, np.random.default_rng(0)))
        x, a, b = (
            [np.stack((getattr(state, end + "x"), getattr(state, end + "y"))) for state in path]
            for end in ("", "a", "b")
        )
        mean[name] = (np.hypot(*(x[2] - 2 * x[1] + x[0])) / 4).mean()
        calm_x, *ends = ((point[2] + 2 * point[1] + point[0]) / 4 for point in (x, a, b))
        least[name] = min(np.hypot(*(calm_x - end)).min() for end in ends)
        row = beyond.watched({"preset": name, "seed": 1, "substeps": numbers.substeps}, (6.0,))[0]
        assert row["mean"] == pytest.approx(mean[name], rel=1e-6)
        assert row["least"] == pytest.approx(least[name], rel=1e-6)
        assert (row["beyond"] > 0) == (name == "thesis")
    assert mean["thesis"] > 0.003
    assert mean["published"] < 1e-4
    assert least["thesis"] < 0.75


def test_the_least_distance_is_that_of_the_step():
    least = {}
    for count in (20, 80):
        frame = simulated("thesis", 0, 6, **{"numerics.substeps": count}).final
        state = frame.cells
        least[count] = min(
            np.hypot(state.x - state.ax, state.y - state.ay).min(),
            np.hypot(state.x - state.bx, state.y - state.by).min(),
        )
        assert least[count] == pytest.approx(np.sqrt(15 * 0.1 / count / 0.15), rel=0.15)


def test_maps_tell_jitter_from_loss(monkeypatch):
    numbers = preset("thesis").numbers()
    assert maps.mitotic_limit(numbers, 8.0) == pytest.approx(2 / (30 * (1 + 1 / 49 + 1 / 7)))
    fine, coarse = (maps.grown_with_step("published", dt, 40) for dt in (0.05, 0.4))
    assert fine["amplitude"] < 1e-4 < coarse["amplitude"]
    assert (
        fine["limit"]
        == coarse["limit"]
        == pytest.approx(40 * 0.2 * maps.mitotic_limit(preset("published").numbers(), 8.0))
    )
    lost = maps.grown_with_damping("thesis", 0.0125, 20)
    assert np.isnan(lost["amplitude"])
    assert lost["status"] != SUCCESS
    assert lost["scale"] == pytest.approx(0.4)
    assert lost["limit"] == pytest.approx(0.1 / 20 / maps.mitotic_limit(numbers, 8.0))
