"""Named types of cells in one tissue: their numbers, events and divisions, alone and in company."""

import math

import numpy as np
import pytest

from tests.tissue.bits import same
from tests.tissue.kernel_calls import aged, freed, generators, ruled, steps, with_emt
from tests.tissue.states import layers, numbers
from tissue.events.known import row
from tissue.files.parameters import preset
from tissue.files.sections import OWN_KEYS
from tissue.frames.observables import PHASES, phases
from tissue.runs.simulate import simulate
from tissue.runs.start import started
from tissue.state.cells import EMT, NAMED
from tissue.state.checkpoint import streams
from tissue.study.outcomes import outcomes

SHORT = preset("published").changed({"numerics.t_end": "6 h", "numerics.keep": "1 h"})
# Cells divide all the time, each type in its own way.
LIVELY = {"cell.min_cycle": "2 h", "cell.max_cycle": "5 h", "cell.g2": "0.4 h", "cell.mitosis": "0.4 h"}
MIXED = SHORT.changed(
    LIVELY
    | {
        "tissue.two_daughters": 0.5,
        "types.stiff.cells": 8,
        "types.stiff.place": 0.1,
        "types.stiff.alpha_ax": 10,
        "types.stiff.alpha_bx": 10,
        "types.quick.cells": 9,
        "types.quick.place": "scattered",
        "types.quick.min_cycle": "1 h",
        "types.quick.max_cycle": "1.5 h",
        "types.quick.g2": "0.2 h",
        "types.leaving.cells": 3,
        "types.leaving.place": 0.9,
        "types.leaving.divides": False,
        "types.leaving.inm": 0.5,
        "types.leaving.a": "2 h",
        "types.leaving.alpha_ax": 3,
    }
)
GIVEN = numbers(two_daughters=0.5, enlarge_in_g2=True, freed_stiffness=2.0, g2_stiffening=2.0)
OWN = (
    GIVEN._replace(alpha_aa=10.0, alpha_ax=4.0, alpha_bx=4.0, alpha_axb=30.0, rate_ax=1.0, rate_bx=2.0, rate_aa=0.3),
    GIVEN._replace(min_cycle=0.4, max_cycle=0.9, two_daughters=1.0, g2=0.2, mitosis=0.1, enlarged_radius=0.5),
    GIVEN._replace(max_cytoskeleton=3.0, hard_radius=0.2, rate_ax=3.0, alpha_bx=0.7),
)


def mixed(n, seed, layers_of=layers):
    """A random tissue of all ages and types, of which some cells of the last type undergo EMT."""
    kind = np.random.default_rng(seed + 100).integers(0, NAMED + len(OWN), n)
    kind[kind == EMT] = 0
    state = aged(n, seed, layers_of, kind=kind)
    state.cells.cycle[kind == NAMED + 1] = 0.6
    state.cells.birth[kind == NAMED + 1] = -0.3
    return with_emt(state, np.flatnonzero(kind == NAMED + 2)[:4], a=0.25, b=0.35, s=0.25, p=0.45)


# Rules


@pytest.mark.parametrize("network", [layers, freed])
@pytest.mark.parametrize("seed", range(3))
def test_each_cell_has_the_numbers_of_its_type(network, seed):
    """After the rules it is what it is in a tissue where all have these numbers; daughters are of her type."""
    state = mixed(24, seed, network)
    cells = state.cells._replace(kind=np.zeros(24, np.int64))
    after = ruled(state, 0.25, GIVEN._replace(variance=0.0, two_daughters=0.0), seed, OWN).cells
    for kind, own in enumerate((GIVEN, GIVEN, *OWN)):
        numbers_of_all = own._replace(variance=0.0, two_daughters=0.0)
        alone = ruled(state._replace(cells=cells), 0.25, numbers_of_all, seed).cells
        mine = (state.cells.kind == kind) & (after.birth < 0.0)
        for name in set(after._fields) - {"kind", "rest_aa", "cycle"}:
            np.testing.assert_array_equal(getattr(after, name)[..., mine], getattr(alone, name)[..., mine], name)
    end = steps(state, 0, 8, GIVEN, *generators(seed), OWN)
    born = end.cells.id >= len(state.cells.x)
    assert born.any()
    kinds = dict(zip(end.cells.id, end.cells.kind, strict=True))
    assert all(kinds[end.cells.mother[i]] == end.cells.kind[i] for i in np.flatnonzero(born))
    assert (end.cells.events[end.cells.emt >= 0] > 0).all()
    quick = end.cells.cycle[born & (end.cells.kind == NAMED + 1)]
    assert (quick >= 0.4).all()
    assert (quick <= 0.9).all()


# Runs


def test_a_type_like_control_cells_changes_no_bit():
    plain = SHORT.changed(LIVELY | {"tissue.two_daughters": 0.5})
    tables = plain.as_dict()
    own = {f"types.same.{name}": tables[section][name] for name, section in OWN_KEYS.items()}
    for place in (0.3, "scattered"):
        like = plain.changed({"types.same.cells": 12, "types.same.place": place} | own)
        one, two = simulate(plain, 3), simulate(like, 3)
        assert (two.final.cells.kind == NAMED).sum() > 12
        for a, b in zip(one.frames, two.frames, strict=True):
            assert same(a._replace(cells=a.cells._replace(kind=b.cells.kind)), b)


def test_what_the_start_has_of_each_type():
    held, _ = started(MIXED, streams(2))
    cells, n = held.cells, MIXED.tissue.cells
    kind = cells.kind[:n]
    assert np.bincount(kind).tolist() == [25, 0, 8, 9, 3]
    assert np.flatnonzero(kind == NAMED).tolist() == list(range(8))
    assert np.flatnonzero(kind == NAMED + 2).tolist() == [39, 40, 41]
    assert (cells.stiff_ax[:n] == np.array([2.0, 2.0, 10.0, 2.0, 3.0])[kind]).all()
    quick = kind == NAMED + 1
    assert (cells.cycle[:n][quick] <= 1.5).all()
    assert (cells.cycle[:n][~quick] >= 2.0).all()
    assert (cells.divides[:n] == (kind != NAMED + 2)).all()
    assert (cells.moves[:n] | (kind == NAMED + 2)).all()
    scattered = np.flatnonzero(quick)
    assert np.ptp(scattered) > len(scattered)
    longer = MIXED.changed({"types.stiff.initial_rest_length": "1 R_soft"})
    rest = started(longer, streams(2))[0].cells.rest_bx[:n]
    assert (rest == np.where(kind == NAMED, 1.0, MIXED.start_numbers().initial_rest_length)).all()


# Events


def test_types_have_events_of_their_own():
    both = SHORT.changed(
        {"emt.cells": 4, "emt.b": "3 h", "emt.s": "1 h to 5 h"}
        | {"types.early.cells": 3, "types.early.place": 0.1, "types.early.a": "2 h", "types.early.divides": False}
        | {"types.late.cells": 2, "types.late.place": "scattered", "types.late.a": "4 h", "types.late.divides": False}
    )
    run = simulate(both, 5)
    table = run.table().query("emt >= 0")
    assert table.groupby("time_h")["emt"].agg(list).map(lambda found: found == list(range(9))).all()
    begun = table.assign(a=table["events"].str.contains("A")).groupby(["type", "time_h"])["a"].agg(["all", "any"])
    for name, time in {"early": 2.0, "late": 4.0, "emt": math.inf}.items():
        mine = begun.loc[name]
        assert mine["all"].eq(mine["any"]).all()
        assert mine.index[mine["all"]].tolist() == [t for t in range(7) if t >= time]
    own = run.final.past.emt.at[:, table.query("time_h == 0")["type"] == "emt"]
    alone = simulate(both.changed({"types.early.cells": 0, "types.late.cells": 0}), 5).final.past.emt.at
    np.testing.assert_array_equal(own, alone)
    rows = outcomes(both, [0], [5]).cells.to_pandas()
    assert rows["t_a_h"].tolist() == run.final.past.emt.at[row("a")].tolist()
    assert rows["type"].tolist() == table.query("time_h == 0")["type"].tolist()


def test_what_a_type_is_drawn_is_its_own():
    """Whatever other types there are, and whatever else it has."""
    timed = {"types.b.cells": 5, "types.b.a": "1 h to 9 h, 50 %", "types.b.divides": False, "types.b.inm": 0.5}
    one = SHORT.changed(timed)
    two = SHORT.changed({"types.a.cells": 4, "types.a.place": 0.1, "emt.cells": 3, "types.b.place": 0.8} | timed)
    (first, _), (second, _) = started(one, streams(1)), started(two, streams(1))
    np.testing.assert_array_equal(
        first.emt.at, second.emt.at[:, second.cells.kind[:45][second.cells.emt[:45] >= 0] == 3]
    )
    moves = [held.cells.moves[:45][held.cells.kind[:45] == k] for held, k in ((first, 2), (second, 3))]
    np.testing.assert_array_equal(*moves)
    other, _ = started(one, streams(2))
    assert not np.array_equal(first.emt.at, other.emt.at)


# What is measured


def test_tables_and_phases_know_the_types():
    run = simulate(MIXED, 7)
    last = run.table().query("time_h == 6")
    assert (last["type"] == np.array(MIXED.type_names)[run.final.cells.kind]).all()
    found = phases(run.final, MIXED.numbers(), MIXED.named_numbers())
    g2 = np.array([0.4, 0.4, 0.4, 0.2, 0.4])[run.final.cells.kind]
    age, cycle = 6.0 - run.final.cells.birth, run.final.cells.cycle
    assert (found == (age >= cycle - g2 - 0.4).astype(int) + (age >= cycle - 0.4)).all()
    assert (last["phase"] == np.array(PHASES)[found]).all()


def test_a_group_that_is_apart_is_spread_evenly():
    far = {"types.far.cells": 3, "types.far.place": "apart"}
    held, _ = started(preset("published").changed(far), streams(1))
    assert np.flatnonzero(held.cells.kind[:45] == NAMED).tolist() == [7, 22, 37]
    after = preset("published").changed({"types.first.cells": 15, "types.first.place": 0} | far)
    held, _ = started(after, streams(1))
    assert np.flatnonzero(held.cells.kind[:45] == NAMED + 1).tolist() == [19, 30, 40]
