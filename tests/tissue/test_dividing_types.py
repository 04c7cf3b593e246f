"""Types with events whose cells divide: daughters have the events of their mother, at her times."""

import numpy as np
import pytest

from tests.tissue.kernel_calls import aged, freed, generators, steps, upright, with_emt
from tests.tissue.space.in_space import of_surface
from tests.tissue.states import layers, numbers
from tissue.events.known import bit
from tissue.files.parameters import preset
from tissue.runs.simulate import simulate
from tissue.study.outcomes import outcomes

GIVEN = numbers(two_daughters=1.0, min_cycle=0.4, max_cycle=0.6, g2=0.1, mitosis=0.1, freed_stiffness=0.5)
LIVELY = {
    "numerics.t_end": "6 h",
    "numerics.keep": "1 h",
    "tissue.two_daughters": 0.3,
    "cell.min_cycle": "2 h",
    "cell.max_cycle": "4 h",
    "cell.g2": "0.4 h",
    "cell.mitosis": "0.4 h",
    "types.early.cells": 4,
    "types.early.place": 0.2,
    "types.early.a": "1 h to 5 h",
    "types.early.two_daughters": 1,
    "types.late.cells": 5,
    "types.late.place": "scattered",
    "types.late.b": "1 h",
    "types.late.p": "2 h to 4 h",
    "types.late.two_daughters": 1,
    "emt.cells": 2,
    "emt.s": "3 h",
}
DIVIDING = preset("published").changed(LIVELY)


def dividing(n, seed, layers_of=layers):
    """A random tissue with eight EMT cells that divide, each with some events."""
    state = with_emt(aged(n, seed, layers_of), range(n // 4, n // 4 + 8), a=0.25, b=0.35, s=0.15, p=0.45)
    mine = state.cells.emt >= 0
    state.cells.divides[:], state.cells.cycle[mine] = True, 0.6
    state.cells.birth[mine] = -np.random.default_rng(seed).uniform(0.0, 0.6, 8)
    state.emt.at[:2, ::2] = np.inf
    return state


@pytest.mark.parametrize("network", [layers, freed])
@pytest.mark.parametrize("seed", range(3))
def test_all_cells_of_a_family_have_its_events(network, seed):
    state = dividing(24, seed, network)
    end = steps(state, 0, 8, GIVEN, *generators(seed))
    mine = np.flatnonzero(end.cells.emt >= 0)
    assert len(mine) > 12
    assert sorted(end.cells.emt[mine]) == list(range(len(mine))) == list(range(len(end.emt.side)))
    mothers = dict(zip(end.cells.id.tolist(), end.cells.mother.tolist(), strict=True))
    for i in mine:
        first = end.cells.id[i]
        while first >= 24:
            first = mothers[first]
        times = state.emt.at[:, state.cells.emt[first]]
        np.testing.assert_array_equal(end.emt.at[:, end.cells.emt[i]], times)
        assert end.cells.events[i] == sum(1 << k for k in np.flatnonzero(times <= 0.8))


def test_daughters_have_what_their_mother_has():
    """Before, between and after the events: whatever she has lost, and what she will."""
    state = with_emt(upright(4, birth=-11.9), [1, 2], a=0.1, b=0.3)
    state.cells.divides[:], state.cells.cycle[:] = True, [50.0, 12.0, 12.2, 50.0]
    end = steps(state, 0, 4, GIVEN._replace(variance=0.0, min_cycle=90.0, max_cycle=90.0), *generators(0))
    mine = np.flatnonzero(end.cells.emt >= 0)
    assert mine.tolist() == [1, 2, 3, 4]
    assert end.cells.mother[mine].tolist() == [-1, 1, -1, 2]
    assert end.cells.emt[mine].tolist() == [0, 2, 1, 3]
    assert (end.cells.events[mine] == bit("a") + bit("b")).all()
    assert end.layers.apical.tolist() == end.layers.basal.tolist() == [0, 5]
    np.testing.assert_array_equal(end.emt.at[:, :2], end.emt.at[:, 2:])
    np.testing.assert_array_equal(end.emt.onset_ab[[1, 3]], end.emt.onset_ab[1])
    assert end.emt.onset_ab[2] > 0


def test_studies_follow_the_cells_of_the_start():
    found = outcomes(DIVIDING.changed({"numerics.folded": "keep"}), range(3), range(3))
    rows, runs = found.cells.to_pandas(), found.runs.to_pandas()
    assert rows.groupby("replicate").size().tolist() == [11, 11, 11]
    for seed, mine in rows.groupby("replicate"):
        final = simulate(DIVIDING, seed).final
        start = np.argsort(np.where(final.cells.emt < 0, 99, final.cells.emt))[:11]
        assert mine["type"].tolist() == [DIVIDING.type_names[kind] for kind in final.cells.kind[start]]
        assert mine["inm"].tolist() == final.cells.moves[start].tolist()
        assert runs["controls_6h"][seed] == (final.cells.emt < 0).sum()


@pytest.mark.parametrize("name", ["plane", "cylinder", "sphere"])
def test_in_space(name):
    """What has left a layer has no neighbours there when it divides."""
    events = {"types__leaving__a": "0.3 h", "types__leaving__b": "0.5 h", "types__leaving__p": "1 h"}
    given = of_surface(name, types__leaving__cells=6, types__leaving__place="scattered", **events)
    quick = {"types__leaving__min_cycle": "1.1 h", "types__leaving__max_cycle": "1.5 h"}
    given = given.changed({key.replace("__", "."): value for key, value in quick.items()})
    run = simulate(given, 1)
    cells, mine = run.final.cells, np.flatnonzero(run.final.cells.emt >= 0)
    assert run.status
    assert len(mine) > 9
    assert sorted(cells.emt[mine]) == list(range(len(mine)))
    assert (cells.events[mine] == bit("a") + bit("b") + bit("p")).all()
    assert not np.isin(mine, run.final.layers.apical).any()
    assert not np.isin(mine, run.final.layers.basal).any()
    assert np.abs(run.final.heights(cells.bx[mine], cells.by[mine], cells.bz[mine])).min() > 1e-6
