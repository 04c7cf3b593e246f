"""The page of limits: its numbers are those of the code, and what it says is refused is refused."""

import numpy as np
import pytest

import dincl
import meanfield
import tissue
import verification
from dincl.events import run as events
from dincl.schemes import event_driven
from dincl.steps import grid
from meanfield.model import model
from meanfield.solvers import characteristics, dae
from meanfield.transport import discrete
from tests.pages import ROOT
from tissue.files import cell_types, fields
from tissue.quasi_steady.run import simulate_quasi_steady
from tissue.runs import registration

TEXT = " ".join((ROOT / "docs" / "explain" / "limits.md").read_text("utf-8").split())
NUMBERS = {
    "at most {:,} particles": event_driven.MOST_PARTICLES,
    "{:,} changes of contacts": events.MOST_EVENTS,
    "At most {} coordinates": model.MAX_DIMENSIONS,
    "and {} macroscopic": model.MAX_MACROSCOPIC,
    "{} coordinates in `solve_dae`": dae.MAX_INTERACTING_COORDINATES,
    "{:,} nodes in `solve_characteristics`": characteristics.MAX_INTERACTING_NODES,
    "up to {:,} different points": discrete.MAX_TRANSPORT_POINTS,
    "{:,} cells,": fields.MOST_CELLS,
    "{} types of cells": cell_types.MOST_TYPES,
    "{} registered functions": registration.MOST,
}
ROW = np.stack([3.0 * np.arange(1001.0), np.zeros(1001)], axis=1)
SMOOTH = dincl.Problem([[1.0, 0.0]], drift=lambda t, x: -x, constraints=[dincl.Smooth(lambda x: x[:, 0] - 0.5)])
SHEET = {"tissue.dimension": 3}
REFUSED = {
    "more particles": lambda: dincl.solve(
        dincl.Problem(ROW, lambda t, x: -x, [dincl.NonOverlap(0.5)]), dincl.EventDriven(1e-6), [0.1]
    ),
    "formulas for pairs": lambda: dincl.solve(dincl.scenes.four_disks(), dincl.CatchUp(0.1, dincl.ClosedForm()), [0.1]),
    "a proof for Smooth": lambda: verification.prove(SMOOTH, [0.1]),
    "four coordinates": lambda: meanfield.Model(
        g=lambda X: X[0], W0=lambda y: y[0] ** 2, W1=lambda X: X[0] ** 2, m=1.0, nx=4, ny=1
    ),
    "constriction in three dimensions": lambda: tissue.preset("published").changed({**SHEET, "emt.ac": "6 h"}),
    "the quasi-steady model in three dimensions": lambda: simulate_quasi_steady(
        tissue.preset("published").changed(SHEET)
    ),
}


@pytest.mark.parametrize("words", NUMBERS)
def test_its_numbers_are_those_of_the_code(words):
    assert words.format(NUMBERS[words]) in TEXT


def test_the_most_steps_are_those_of_the_code():
    assert "10⁹ steps" in TEXT
    assert grid.MOST_STEPS == 10**9


@pytest.mark.parametrize("what", REFUSED)
def test_what_it_says_is_refused_is_refused(what):
    with pytest.raises(dincl.InvalidProblem):
        REFUSED[what]()
