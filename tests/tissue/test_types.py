"""Named types of cells in one tissue: their numbers, events and divisions, alone and in company."""

import math

import numpy as np
import pytest

from tests.tissue.bits import same
from tests.tissue.kernel_calls import aged, freed, generators, ruled, steps, taken, upright, with_emt
from tests.tissue.kernel_calls import held as held_of
from tests.tissue.space.in_space import of_surface
from tests.tissue.states import layers, numbers
from tissue.events.known import bit, row
from tissue.files.parameters import preset
from tissue.files.sections import OWN_KEYS
from tissue.frames.observables import PHASES, phases
from tissue.runs.group import Group
from tissue.runs.simulate import simulate
from tissue.runs.start import started
from tissue.state.basal_curve import curve_numbers, ellipse
from tissue.state.cells import EMT, NAMED
from tissue.state.checkpoint import streams
from tissue.study.outcomes import outcomes

SHORT = preset("published").changed({"numerics.t_end": "6 h", "numerics.keep": "1 h"})
# Cells divide all the time, each type in its own way.
LIVELY = {"cell.min_cycle": "2 h", "cell.max_cycle": "5 h", "cell.g2": "0.4 h", "cell.mitosis": "0.4 h"}
STIFF = {"cells": 8, "place": 0.1, "alpha_ax": 10, "alpha_bx": 10}
QUICK = {"cells": 9, "place": "scattered", "min_cycle": "1 h", "max_cycle": "1.5 h", "g2": "0.2 h"}
LEAVING = {"cells": 3, "place": 0.9, "divides": False, "inm": 0.5, "a": "2 h", "alpha_ax": 3}


def of_types(**types):
    """Changes that make these types."""
    return {f"types.{name}.{key}": value for name, one in types.items() for key, value in one.items()}


MIXED = SHORT.changed(LIVELY | {"tissue.two_daughters": 0.5} | of_types(stiff=STIFF, quick=QUICK, leaving=LEAVING))
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


each_network = pytest.mark.parametrize(("network", "seed"), [(one, k) for one in (layers, freed) for k in range(3)])


@each_network
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
    held = started(MIXED, streams(2))
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
    rest = started(longer, streams(2)).cells.rest_bx[:n]
    assert (rest == np.where(kind == NAMED, 1.0, MIXED.start_numbers().initial_rest_length)).all()


# Events


def test_types_have_events_of_their_own():
    both = SHORT.changed(
        {"emt.cells": 4, "emt.b": "3 h", "emt.s": "1 h to 5 h"}
        | of_types(early={"cells": 3, "place": 0.1, "a": "2 h", "divides": False})
        | of_types(late={"cells": 2, "place": "scattered", "a": "4 h", "divides": False})
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
    first, second = started(one, streams(1)), started(two, streams(1))
    np.testing.assert_array_equal(
        first.emt.at, second.emt.at[:, second.cells.kind[:45][second.cells.emt[:45] >= 0] == 3]
    )
    moves = [held.cells.moves[:45][held.cells.kind[:45] == k] for held, k in ((first, 2), (second, 3))]
    np.testing.assert_array_equal(*moves)
    other = started(one, streams(2))
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
    held = started(preset("published").changed(far), streams(1))
    assert np.flatnonzero(held.cells.kind[:45] == NAMED).tolist() == [7, 22, 37]
    after = preset("published").changed({"types.first.cells": 15, "types.first.place": 0} | far)
    held = started(after, streams(1))
    assert np.flatnonzero(held.cells.kind[:45] == NAMED + 1).tolist() == [19, 30, 40]


# Types with events whose cells divide: daughters have the events of their mother, at her times.

DIVIDED = numbers(two_daughters=1.0, min_cycle=0.4, max_cycle=0.6, g2=0.1, mitosis=0.1, freed_stiffness=0.5)
EARLY = {"cells": 4, "place": 0.2, "a": "1 h to 5 h", "two_daughters": 1}
LATE = {"cells": 5, "place": "scattered", "b": "1 h", "p": "2 h to 4 h", "two_daughters": 1}
DIVIDING = SHORT.changed(
    LIVELY
    | {"cell.max_cycle": "4 h", "tissue.two_daughters": 0.3, "emt.cells": 2, "emt.s": "3 h"}
    | of_types(early=EARLY, late=LATE)
)


def dividing(n, seed, layers_of=layers):
    """A random tissue with eight EMT cells that divide, each with some events."""
    state = with_emt(aged(n, seed, layers_of), range(n // 4, n // 4 + 8), a=0.25, b=0.35, s=0.15, p=0.45)
    mine = state.cells.emt >= 0
    state.cells.divides[:], state.cells.cycle[mine] = True, 0.6
    state.cells.birth[mine] = -np.random.default_rng(seed).uniform(0.0, 0.6, 8)
    state.emt.at[:2, ::2] = np.inf
    return state


@each_network
def test_all_cells_of_a_family_have_its_events(network, seed):
    state = dividing(24, seed, network)
    end = steps(state, 0, 8, DIVIDED, *generators(seed))
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
    end = steps(state, 0, 4, DIVIDED._replace(variance=0.0, min_cycle=90.0, max_cycle=90.0), *generators(0))
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


# What two cells of different types have together: R_i + R_j, the mean of repulsions and of basal distances.

# Only nuclei push each other, once.
PUSHES = numbers(substeps=1, variance=0.0, hard_radius=0.0, junction_factor=0.0, two_daughters=0.0)
STILL = dict.fromkeys(("stiff_ax", "stiff_bx", "stiff_axb"), 0.0)


def kinds(power):
    """The numbers of control cells and of two types, by their power of the springs."""
    given = PUSHES._replace(spring_power=power, repulsion=0.8)
    named = given._replace(soft_radius=1.6, repulsion=2.0), given._replace(soft_radius=0.4, repulsion=0.5)
    return given, named


def crowd(n, seed):
    """Cells of all types in a crowd, which do not move but by the repulsion."""
    kind = np.random.default_rng(seed).choice([0, NAMED, NAMED + 1], n)
    return aged(n, seed, kind=kind, radius=0.0, **STILL)


def moved_by_pairs(cells, given, named):
    """Where one step brings the nuclei, pair by pair."""
    of = [(given, given, *named)[k] for k in cells.kind]
    x, scale = np.stack((cells.x, cells.y)), given.dt / given.mu
    for i, one in enumerate(of):
        for j, other in enumerate(of):
            arrow = np.array((cells.x[i] - cells.x[j], cells.y[i] - cells.y[j]))
            d, reach = np.hypot(*arrow), one.soft_radius + other.soft_radius
            if 0 < d < reach:
                k = (one.repulsion + other.repulsion) / 2 * (2 / reach) ** given.spring_power
                x[:, i] += scale * k * (reach - d) * arrow / d
    return x


@pytest.mark.parametrize("power", [1, 2])
@pytest.mark.parametrize("bent", [False, True])
def test_pairs_of_different_soft_discs(power, bent):
    """Alone and side by side, on a line and on a curve, as pair by pair."""
    (given, named), curve = kinds(power), curve_numbers(ellipse(300.0, 1.0, inside=True, ring=False)) if bent else None
    states_of = [crowd(n, n) for n in (40, 9, 24, 1, 33, 17, 28, 12)]
    for chosen in (states_of[:1], states_of):
        held = [held_of(one, **({"curve": curve} if bent else {})) for one in chosen]
        group = Group(held, given, named=named)
        group.make_substeps()
        for one, kept in zip(chosen, group.states, strict=True):
            cells = taken(kept).cells
            expected = moved_by_pairs(one.cells, given, named)
            np.testing.assert_allclose((cells.x, cells.y), expected, atol=1e-11)
            assert np.abs(expected - (one.cells.x, one.cells.y)).max() > 0.1 or len(cells.x) == 1


@pytest.mark.parametrize("closed", [False, True])
def test_basal_neighbours_are_at_most_the_mean_of_both_apart(closed):
    """One cell of each pair is far away: by half of the excess each, one pair after the other."""
    named = [PUSHES._replace(max_basal_distance=2.0)]
    given = PUSHES._replace(repulsion=0.0, max_basal_distance=1.0)
    kind = np.array([0, NAMED, NAMED, 0, 0, NAMED])
    allowed = [1.5, 2.0, 1.5, 1.0, 1.5]
    b = np.cumsum([0.0, 1.6, 1.9, 1.7, 0.9, 3.0])
    state = upright(6, kind=kind, **STILL)
    cells = state.cells._replace(bx=b.copy(), along=b.copy())
    length = b[-1] + 1.8
    curve = curve_numbers(ellipse(length, 1.0, inside=False, ring=True)) if closed else None
    group = Group([held_of(state._replace(cells=cells), **({"curve": curve} if closed else {}))], given, named=named)
    group.make_substeps()
    found = taken(group.states[0]).cells
    for k, most in enumerate(allowed):
        half = max(0.0, (b[k + 1] - b[k] - most) / 2)
        b[k : k + 2] += (half, -half)
    if closed:
        half = max(0.0, (b[0] + length - b[-1] - 1.5) / 2)
        b[[0, -1]] += (-half, half)
    np.testing.assert_allclose(found.along if closed else found.bx, b, atol=1e-12)


def test_springs_and_rest_lengths_have_the_radius_of_the_type():
    """l = R_soft + eta, and eta tends to d - R_soft; in G2 the basal one to |A - B| - 2 R_soft."""
    given = numbers(dt=20.0, floor_rest_length=False)
    named = [given._replace(soft_radius=1.6)]
    state = upright(2, kind=NAMED, birth=[0.0, -11.3], rest_ax=0.5, rest_bx=0.5)
    after = ruled(state, 0.0, given, named=named).cells
    np.testing.assert_allclose(after.rest_ax, [3.0 - 1.6, 0.0], atol=1e-12)
    np.testing.assert_allclose(after.rest_bx, [5.0 - 1.6, 8.0 - 3.2], atol=1e-12)
    once = given._replace(dt=0.1, substeps=1, repulsion=0.0, junction_factor=0.0)
    group = Group([held_of(state)], once, named=[once._replace(soft_radius=1.6)])
    group.make_substeps()
    rest = 1.6 + 0.5
    pull = 0.1 / once.mu * 2 * 2.0 * (3.0 - rest) / rest
    np.testing.assert_allclose(taken(group.states[0]).cells.ay, 8.0 - pull, rtol=1e-12)
