"""The linear limit of substeps where theory is sharp: found by bisection, without the formula, and by the formula."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import math
from functools import partial
from typing import TypedDict

import numpy as np

from dincl.study import Study
from tissue.files.parameters import preset
from tissue.state.cells import CellLayers, empty
from tissue.state.numbers import Numbers
from verification.instruments.predicted import Case, Found, boundary, cases_study, within
from verification.thesis.chapter3 import frozen, linear
from verification.thesis.chapter3.frozen import Frozen, substepped, swing

# A swing that is a hundred times the disturbance has grown; one part in a thousand above the limit it does so by 1.002
# in each substep. It is looked for all along: once large, it may end in another state, bent or turned over. With
# contacts the sweeps themselves leave something that swings, so the disturbance has to be larger [R_soft].
SIZE, ROUGH, GREW = 1e-8, 1e-5, 100.0
# Substeps after which it is looked for: often enough to find it before it is of the size of a cell.
LOOKS = tuple(2**k for k in range(3, 14))
PRECISION, AGREEMENT, CONTACTS = 2e-4, 1e-3, 0.05
# Where the search for a step that is too large begins [h/mu].
SMALL = 1e-3


def standing(u: float, v: float, count: int = 1, spacing: float = 4.0, **stiffness: float) -> Frozen:
    """Return straight cells side by side at rest, nuclei ``u`` below the apical and ``v`` above the basal points.

    Stiffnesses that are not given are 0. There are no hard discs; junctions are at rest.
    """
    numbers: Numbers = preset("thesis").numbers()._replace(max_basal_distance=2 * spacing, hard_radius=0.0)
    cells = empty(count)
    place = spacing * np.arange(count)
    given = {"x": place, "y": v, "ax": place, "ay": u + v, "bx": place, "rest_ax": u - 1, "rest_bx": v - 1}
    for name, value in (given | {"rest_aa": spacing} | stiffness).items():
        getattr(cells, name)[:] = value
    return Frozen(cells, CellLayers(np.arange(count), np.arange(count)), numbers)


def holds(state: Frozen, scale: float, size: float = SIZE) -> bool:
    """Return whether no swing grows out of a disturbance of ``size`` with substeps of h/mu = ``scale``."""
    now = frozen.disturbed(state, size)
    for more in np.diff((0, *LOOKS)).tolist():
        cells = substepped(now, scale, more)
        found = None if cells is None else swing(now._replace(cells=cells), scale)
        if cells is None or found is None or found.largest > GREW * size:
            return False
        now = now._replace(cells=cells)
    return True


def found_limit(state: Frozen, size: float = SIZE) -> float:
    """Return the largest h/mu that ``holds``."""
    high = SMALL
    while holds(state, high, size):
        high *= 2
    return boundary(lambda scale: holds(state, scale, size), high / 2, high, PRECISION)


class Stiffness(TypedDict):
    """Of the springs of a cell and of its angle."""

    stiff_ax: float
    stiff_bx: float
    stiff_axb: float


def _stiffness() -> Stiffness:
    """Return the stiffness of cells in the thesis."""
    numbers = preset("thesis").numbers()
    return {"stiff_ax": numbers.alpha_ax, "stiff_bx": numbers.alpha_bx, "stiff_axb": numbers.alpha_axb}


def _bending(u: float, v: float) -> Found:
    given = _stiffness()
    expected = linear.LIMIT / linear.bending(given["stiff_axb"], u, v)
    words = f"h/μ, u = |A − X| = {u:g}, v = |B − X| = {v:g}"
    return within(expected, found_limit(standing(u, v, **given)), AGREEMENT, words)


def _springs(power: int) -> Found:
    given, length = _stiffness() | {"stiff_axb": 0.0}, 2.5
    state = standing(length, length, **given)
    state = state._replace(numbers=state.numbers._replace(spring_power=power))
    # Moves of A and X along the cell: [[k, -k], [-k, 2k]].
    expected = linear.LIMIT / (2 * given["stiff_ax"] / length**power * (3 + math.sqrt(5)) / 2)
    return within(expected, found_limit(state), AGREEMENT, f"h/μ, l = {length:g}, p = {power}")


def _junctions() -> Found:
    count, alpha = 10, preset("thesis").numbers().alpha_aa
    state = standing(2.5, 2.5, count, stiff_aa=alpha)
    k = state.numbers.junction_factor * alpha
    expected = linear.LIMIT / (2 * k * (1 + math.cos(math.pi / count)))
    return within(expected, found_limit(state), AGREEMENT, f"h/μ, {count} cells, k = {k:g}")


def crowd() -> Frozen:
    """Return twelve cells with all forces, too thin to touch; soft discs overlap, springs are under tension."""
    state = standing(4.0, 4.0, 12, 1.5, stiff_aa=preset("thesis").numbers().alpha_aa, **_stiffness())
    state.cells.y[:] += 0.5 * np.cos(2.0 * np.arange(12))
    state.cells.rest_aa[:] = 1.4
    return frozen.at_rest(state)


def _crowd() -> Found:
    state = crowd()
    return within(frozen.limit(state), found_limit(state), AGREEMENT, "h/μ, 12 cells, all forces, no contact")


def _grown(name: str) -> Found:
    """Compare limits with contacts to two digits, not three: projections may hold the swing back."""
    state = frozen.at_rest(frozen.grown(name))
    words = f"h/μ, {len(state.cells.x)} cells after {frozen.AGE:g} h, {name} parameters"
    return within(frozen.limit(state), found_limit(state, ROUGH), CONTACTS, words)


STRAIGHT = "h/μ · 2α(1/u² + 1/v² + 1/(uv)) = 2"
CASES = (
    Case("bend-apical", "A straight cell, nucleus at its apical end", STRAIGHT, partial(_bending, 0.7, 7.3)),
    Case("springs-1", "The springs of a cell, p = 1", "h/μ · (2α/l)(3 + √5)/2 = 2", partial(_springs, 1)),
    Case("bend-middle", "A straight cell, nucleus in the middle", STRAIGHT, partial(_bending, 2.5, 2.5)),
    Case("springs-2", "The springs of a cell, p = 2", "h/μ · (2α/l²)(3 + √5)/2 = 2", partial(_springs, 2)),
    Case("junctions", "The apical layer", "h/μ · 2k(1 + cos(π/n)) = 2", _junctions),
    Case("crowd", "Cells at rest, no contact", "h/μ · λ_max of the Hessian of W = 2", _crowd),
    Case("thesis", "A grown tissue at rest, thesis", "the same, contacts left out", partial(_grown, "thesis")),
    Case("published", "A grown tissue at rest, published", "the same, contacts left out", partial(_grown, "published")),
)


def study(smallest: bool = False) -> Study:
    """Return the limits by bisection beside those by the formula, one run for each case."""
    return cases_study(CASES[:2] if smallest else CASES, "tissue_limits", "Tissue: linear limits")
