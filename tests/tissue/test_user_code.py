"""Functions of users are looked at before they are compiled: fields that there are not, changes that are lost."""

import re

import numpy as np
import pytest

import tissue
from dincl.errors import InvalidProblem
from tests.pages import ROOT
from tissue.files.parameters import preset
from tissue.model.cycle import adapt_rest_lengths, set_phases
from tissue.rules.slice import in_plane
from tissue.runs.compiled_rules import rules_pointer
from tissue.runs.user_code import OVERWRITTEN, PAGE, check_code
from tissue.state.cells import KINDS, Cells, empty
from tissue.state.numbers import numbers_pointer
from tissue.state.running import new_state

ROWS = re.findall(r"^\| (`.*?) \|.*\| (.*?) \|$", (ROOT / PAGE).read_text("utf-8"), re.MULTILINE)


def misspelt(state, i, bit, numbers):
    state.cells.radios[i] = 1.0


def misspelt_number(state, i, bit, given):
    state.cells.rest_ax[i], _ = given.hard_radus, bit


def misspelt_part(held, i, numbers):
    cells = held.cels
    cells.x[i] += 1.0


def lost(state, i, bit, numbers):
    radius, cells = 0.5, state.cells
    cells.radius[i] *= radius


def lost_behind(state, i, numbers):
    stiffness = state.cells.stiff_aa
    stiffness[i + 1] = 0.0


def moving(state, on, strength, numbers):
    state.cells.y[0] = 0.0


def third(state, on, strength, numbers):
    on.z[0] += strength


def kept(state, i, rest_ax, rest_bx, numbers):
    cells = state.cells
    cells.radius[i] = cells.stiff_aa[i] = 0.5 * numbers.hard_radius


def right(state, i, bit, numbers):
    for points in (state.cells.x, state.cells.ax):
        points[i] += state.motion.held[i] * numbers.dt
    state.cells.rest_bx[i] = state.emt.at.shape[0] + state.layers.apical[0]


def splits(state, i, number, numbers):
    return True


@pytest.mark.parametrize(
    ("thing", "message"),
    [
        (
            tissue.EmtEvent("one", "", "", misspelt),
            r"begin in test_user_code.py, line \d+: state.cells.radios is unknown",
        ),
        (tissue.EmtEvent("one", "", "", misspelt), "the nearest is radius of x, y, ax, .*, az, bz; see docs"),
        (tissue.EmtEvent("one", "", "", misspelt_number), "given.hard_radus is unknown; the nearest is hard_radius of"),
        (tissue.DivisionRule("one", "", "", splits, misspelt_part), "place in .* held.cels is unknown; .* is cells of"),
        (tissue.EmtEvent("one", "", "", lost), r"changes state.cells.radius: must be in last, .* in each dt; see docs"),
        (tissue.DivisionRule("one", "", "", splits, lost_behind), "changes state.cells.stiff_aa: must be in last"),
        (tissue.Force("one", moving, ""), "push in .* changes state.cells.y: must change nothing of the state"),
        (tissue.Force("one", third, ""), "on.z is unknown; the nearest is y of x, y, ax, ay, bx, by; see"),
    ],
)
def test_what_is_wrong_is_said_before_it_is_compiled(thing, message):
    with pytest.raises(InvalidProblem, match=f"{type(thing).__name__} one: .*{message}"):
        tissue.register(thing)


@pytest.mark.parametrize("thing", [tissue.EmtEvent("one", "", "", right, kept)])
def test_what_is_right_is_not_refused(thing):
    check_code(thing)


def after_rules(changes):
    """The cells behind the rules of one dt, from cells that ``changes`` are made to."""
    numbers = preset("thesis").numbers()
    cells = empty(3)
    for name, k in ((name, k) for name in ("x", "ax", "bx") for k in range(3)):
        getattr(cells, name)[k] = float(k)
    cells.y[:], cells.ay[:], cells.cycle[:], cells.stiff_aa[:] = 3.0, 8.0, 10.0, 5.0
    for name, value in changes.items():
        getattr(cells, name)[1] = value
    state = new_state(cells, capacity=3, space=in_plane())
    given, rules = numbers_pointer(numbers), rules_pointer([state])
    set_phases(state, 5.0, given)
    adapt_rest_lengths(state, 5.0, given, rules)
    return Cells._make(array.copy() for array in state.cells)


def test_two_fields_are_overwritten():
    """Of a cell that an event changes, behind the rules of the same dt."""
    same = after_rules({})
    lost = set()
    for name in (name for name in Cells._fields if KINDS.get(name) is None):
        found = after_rules({name: 0.125})
        if np.array_equal(getattr(found, name), getattr(same, name)):
            lost.add(f"state.cells.{name}")
    assert lost == OVERWRITTEN


def test_the_page_has_all_fields():
    fields = [name for names, _ in ROWS for name in re.findall(r"`(\w+)`", names) if name in Cells._fields]
    assert sorted(fields) == sorted(Cells._fields)
    late = [name for names, change in ROWS if change == "in `last` only" for name in re.findall(r"`(\w+)`", names)]
    assert {f"state.cells.{name}" for name in late} == OVERWRITTEN
