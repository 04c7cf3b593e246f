"""The linear limits and the jitter of the tissue, and the limits of DAHA: predicted and found, seen by other means."""

import numpy as np
import pandas as pd
import pytest

from tests.tissue.states import THESIS, cells, layers, tissue
from tests.twins.tissue.steps import make_substeps
from tests.verification.thesis.simulated import simulated
from tissue.model.energy import energy, forces
from verification.site.store import shipped
from verification.thesis.chapter3 import frozen, growing, limits, linear, stability
from verification.thesis.chapter3.frozen import Frozen, substepped, swing
from verification.thesis.chapter3.growing import PRESETS, SUCCESS


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
    found = swing(Frozen(state, network, THESIS), scale)
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
        end = substepped(pushed, part * limit, 1000)
        assert (swing(state._replace(cells=end), part * limit).largest > 1e-4) == jitters


def test_far_above_the_limit_the_amplitude_depends_on_rounding(monkeypatch):
    """As the reason says that the page gives for maps whose reruns differ."""
    monkeypatch.setattr(frozen, "AGE", 1.0)
    state = frozen.at_rest(frozen.grown.__wrapped__("thesis"))
    limit, pushes = frozen.limit(state), (stability.PUSH, (1 + 1e-9) * stability.PUSH)
    for part, chaotic in ((0.9, False), (8.0, True)):
        found = []
        for push in pushes:
            pushed = frozen.disturbed(state, push)
            end = substepped(pushed, part * limit, stability.SUBSTEPS)
            found.append(swing(state._replace(cells=end), part * limit).nuclei.mean())
        assert (found[1] != pytest.approx(found[0], rel=1e-3)) == chaotic


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


def test_maps_tell_jitter_from_loss():
    assert stability.mitotic_limit("thesis") == pytest.approx(2 / (30 * (1 + 1 / 49 + 1 / 7)))
    fine, coarse = (stability.grow("published", dt=dt, substeps=40.0) for dt in (0.05, 0.4))
    assert (fine["outcome"], coarse["outcome"]) == ("bounded", "inaccurate")
    assert fine["amplitude"] < 1e-4 < stability.SEEN < coarse["amplitude"]
    lost = stability.grow("thesis", mu=0.0125, substeps=20.0)
    assert np.isnan(lost["amplitude"])
    assert lost["outcome"] == "unstable"
    assert lost["status"] != SUCCESS
    assert lost["scale"] == pytest.approx(0.4)


@pytest.mark.parametrize("name", stability.TITLED)
def test_limits_are_drawn_over_maps(name):
    found = stability.map_of(name, shipped(name))
    assert set(found.limits["method"]) == (set() if name == "tissue_daha_multipliers" else set(found.table["method"]))
    if name == "tissue_map_steps":  # dt = substeps mu limit
        mine = found.limits[found.limits["method"] == "Thesis"]
        np.testing.assert_allclose(mine["x"] / mine["y"], 0.15 * stability.mitotic_limit("thesis"))
    elif "limit" in found.table and not found.limits.empty:
        line = found.limits[found.limits["method"] == found.table["method"].iloc[0]]
        at = found.table[found.table["method"] == found.table["method"].iloc[0]]
        x, y = at[found.x].median(), at.loc[at[found.x] == at[found.x].median(), "limit"].iloc[0]
        assert np.interp(x, line["x"], line["y"]) == pytest.approx(y, rel=0.05)


def test_most_tissues_at_rest_jitter_where_the_hessian_says():
    found = stability.losses({name: shipped(name) for name in stability.TITLED}).set_index("preset")
    assert (found["predicted"] > 0.99).all()
    assert (found["mitosis"] < found["lost"]).all()


@pytest.mark.parametrize("c", [0.2, 2.0, 20.0])
def test_the_linear_limit_of_alpha_does_not_depend_on_c(c):
    def left(k):
        before = z = 1.0
        for _ in range(20_000):
            z, before = (2 * z - (1 - c / 2) * before - k * z) / (1 + c / 2), z
            if abs(z) > 1e6:
                break
        return abs(z)

    assert left(0.99 * stability.daha_limit()) < 1e-3
    assert left(1.01 * stability.daha_limit()) > 1e3


def test_outcomes_of_one_step():
    assert stability.stepped(0, alpha=1.0)["outcome"] == "converged"
    assert stability.stepped(0, alpha=1e-2)["outcome"] == "infeasible"
    wild = stability.stepped(0, alpha=1e3)
    assert wild["limit"] < 1e3
    assert wild["outcome"] in ("did not terminate", "unstable")


def test_held_is_the_range_around_table_4():
    good, bad, lost = "converged", "infeasible", "did not terminate"
    line = pd.DataFrame({"alpha": [0.01, 0.1, 1.0, 10.0, 100.0], "beta": 1.0, "outcome": [good, bad, good, good, lost]})
    table = pd.concat([line, pd.DataFrame({"alpha": 1.0, "beta": [0.1, 10.0], "outcome": good})])
    table = table.assign(method="Seed 0", limit=50.0)
    tables = dict(zip(stability.DAHA, (table, table.rename(columns={"alpha": "gamma", "beta": "c"})), strict=True))
    found = stability.held(tables).set_index("parameter")
    assert found.loc["alpha", ["from", "to", "below", "above", "limit"]].tolist() == [1.0, 10.0, bad, lost, 50.0]
    assert found.loc["beta", ["from", "to", "below"]].tolist() == [0.1, 10.0, "as far as tried"]
