"""A tissue of several types goes on from a saved state, as it is or with other parameters."""

import numpy as np
import pytest

from dincl.errors import InvalidProblem
from tests.tissue.bits import same_cells
from tests.tissue.test_types import LIVELY, MIXED, SHORT
from tissue.events.known import bit
from tissue.runs.simulate import simulate
from tissue.state.cells import NAMED


def test_types_are_known_by_their_names():
    tables = MIXED.as_dict()
    plain = SHORT.changed(LIVELY | {"tissue.two_daughters": 0.5})
    swapped = {name: tables["types"][name] for name in ("leaving", "stiff", "quick")}
    other = plain.changed({f"types.{name}.{key}": value for name, one in swapped.items() for key, value in one.items()})
    half = simulate(MIXED.changed({"numerics.t_end": "3 h"}), 7).final
    assert half.past.types == ("stiff", "quick", "leaving")
    one, two = simulate(MIXED, 7, start=half).final, simulate(other, 7, start=half).final
    np.testing.assert_array_equal(np.array([0, 1, 3, 4, 2])[one.cells.kind], two.cells.kind)
    assert same_cells(one._replace(cells=one.cells._replace(kind=two.cells.kind)), two)


def test_parameters_of_a_type_may_change_from_a_state_on():
    half = simulate(MIXED.changed({"numerics.t_end": "3 h"}), 7).final
    changes = {"types.stiff.alpha_ax": 2, "types.stiff.divides": False, "types.leaving.s": "4 h"}
    end = simulate(MIXED.changed(changes), 7, start=half).final
    kind = end.cells.kind
    assert (end.cells.stiff_ax[kind == NAMED] == 2.0).all()
    assert not end.cells.divides[kind == NAMED].any()
    assert (kind == NAMED).sum() == (half.cells.kind == NAMED).sum()
    assert (end.cells.events[kind == NAMED + 2] == bit("a") + bit("s")).all()


def test_control_cells_become_types():
    half = simulate(SHORT.changed({"numerics.t_end": "3 h"}), 7).final
    end = simulate(SHORT.changed({"types.new.cells": 5, "types.new.alpha_ax": 1}), 7, start=half)
    first = np.flatnonzero(end.frames[0].cells.kind == NAMED)
    n = len(half.cells.x)
    assert first.tolist() == list(range((n - 5) // 2, (n - 5) // 2 + 5))
    assert (end.final.cells.stiff_ax == np.where(end.final.cells.kind == NAMED, 1.0, SHORT.cell.alpha_ax)).all()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"types.leaving.cells": 2}, r"types\.leaving\.cells = 2: must be 3, as many as there are at the start"),
        ({"types.more.cells": 2, "types.more.place": 0.7}, r"types\.more\.cells = 2: must be 0, as many as there are"),
        ({"types.leaving.b": "1 h"}, r'types\.leaving\.b = "1 h": must be after the time of the start, t = 3 h, for'),
    ],
)
def test_a_start_that_does_not_go_with_the_types(changes, message):
    half = simulate(MIXED.changed({"numerics.t_end": "3 h"}), 7).final
    with pytest.raises(InvalidProblem, match=message):
        simulate(MIXED.changed(changes), 7, start=half)
    fewer = simulate(MIXED.changed({"types.stiff.cells": 1}), 7, start=half).final  # they divide: any number will do
    assert (fewer.cells.kind == NAMED).sum() >= 8


def test_a_start_of_types_that_are_missing():
    half = simulate(MIXED.changed({"numerics.t_end": "3 h"}), 7).final
    with pytest.raises(
        InvalidProblem, match=r"types\.stiff is missing: must be there, \d+ cells of the start are of it"
    ):
        simulate(SHORT, 7, start=half)


def test_more_types_than_there_are_cells_at_the_start():
    control = simulate(SHORT.changed({"numerics.t_end": "0.4 h"}), 7).final
    many = {"emt.cells": 1, "tissue.cells": 60, "types.new.cells": 45, "types.new.place": "scattered"}
    with pytest.raises(InvalidProblem, match=r"types\.new\.cells = 45: must be at most 44: other groups have 1 of 45"):
        simulate(SHORT.changed(many), 7, start=control)
