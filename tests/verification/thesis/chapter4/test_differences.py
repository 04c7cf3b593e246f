"""Each row in which the presets differ is a factor of the design, or is reached by no printed ratio."""

from itertools import combinations

import numpy as np
import pytest

import tissue
from tissue.files.parameter_files import flat
from verification.thesis.chapter4 import differences
from verification.thesis.chapter4.ensembles import ENERGIES

# Written in other units, and equal.
SAME = ("cell.initial_rest_length", "tissue.diffusion", "tissue.height", "tissue.width")


def values(name: str) -> dict[str, object]:
    return flat(tissue.preset(name).as_dict())


def test_the_rows_are_all_in_which_the_presets_differ() -> None:
    thesis, published = values("thesis"), values("published")
    rows = [key for row in differences.ROWS.values() for key in row.keys]
    known = [*rows, *differences.UNREACHED, *differences.COUNTED, *SAME]
    assert len(known) == len(set(known))
    assert set(known) == {key for key in thesis if thesis[key] != published[key]}


def test_what_is_written_in_other_units_is_equal() -> None:
    thesis = tissue.preset("thesis").changed({"numerics.t_end": "1 h"})
    other = thesis.changed({key: values("published")[key] for key in SAME})
    assert tissue.simulate(thesis, 0).table().equals(tissue.simulate(other, 0).table())


def test_the_corrected_preset_differs_from_the_thesis_in_the_energies_alone() -> None:
    thesis, corrected = values("thesis"), values("corrected")
    assert {key for key in thesis if thesis[key] != corrected[key]} == set(ENERGIES)


@pytest.mark.parametrize("scenario", differences.SCENARIOS)
def test_what_no_printed_ratio_reaches_changes_no_run(scenario: str) -> None:
    given = differences.Swap("", frozenset()).parameters(scenario)
    given = given.changed({"numerics.t_end": "20 h"})
    other = given.changed({key: values("published")[key] for key in differences.UNREACHED})
    one, two = (tissue.simulate(parameters, 3).table() for parameters in (given, other))
    assert one.equals(two)


def test_no_product_of_fewer_than_six_rows_is_constant() -> None:
    signs = np.array([[row in setting.published for row in differences.ROWS] for setting in differences.design()])
    signs = np.where(signs, 1, -1)
    assert len({tuple(row) for row in signs}) == len(signs) == 2**differences.FREE
    for size in range(1, 6):
        for rows in combinations(range(signs.shape[1]), size):
            assert signs[:, rows].prod(axis=1).sum() == 0


def test_effects_are_those_of_a_known_law() -> None:
    """Ratios 0.5 + 0.2 s_1 - 0.1 s_2 s_3, with as many hits as that."""
    signs = np.array([[row in setting.published for row in differences.ROWS] for setting in differences.design()])
    signs = np.where(signs, 1.0, -1.0)
    p = 0.5 + 0.2 * signs[:, 0] - 0.1 * signs[:, 1] * signs[:, 2]
    hits = (np.arange(10) < np.round(10 * p)[:, None]).astype(float)
    found = {names: differences.effect(hits, sign)[0] for names, sign in differences.contrasts(signs)}
    names = list(differences.ROWS)
    assert found.pop((names[0], "")) == pytest.approx(0.4)
    assert found.pop((names[1], names[2])) == pytest.approx(-0.2)
    assert max(map(abs, found.values())) < 1e-12
