"""Tension of new edges and free boundaries in space: what a tissue does in hours."""

import numpy as np
import pytest

import tissue
from tissue.frames.observables import layer_area

# A slice made a sheet, which is crowded.
CROWDED = tissue.preset("published").changed(
    {"tissue.dimension": 3, "tissue.cells": 196, "tissue.two_daughters": 1, "numerics.t_end": "6 h"}
)


def roughness(run):
    """Root mean square of the heights of apical points less the mean of their neighbours'."""
    heights, edges = run.final.cells.ay, run.final.sheets.apical.edges
    ends, others = np.concatenate((edges, edges[:, ::-1])).T
    around = np.bincount(ends, heights[others]) / np.bincount(ends)
    return np.sqrt(np.mean((heights - around) ** 2))


@pytest.mark.slow
def test_tension_that_is_forgotten_makes_the_apical_layer_rough():
    """About twice as rough as with the mean, in each of three crowded sheets."""
    given = CROWDED.changed({"numerics.t_end": "12 h", "numerics.keep": "12 h"})
    mean, distance = (
        np.array([roughness(tissue.simulate(given.changed({"space.new_rest": rule}), seed)) for seed in range(3)])
        for rule in ("mean", "distance")
    )
    assert (distance > 1.6 * mean).all()
    assert distance.mean() < 2.5 * mean.mean()


@pytest.mark.parametrize(("most", "least", "largest"), [("1/3 R_soft", 0.55, 0.7), ("1/2 R_soft", 0.8, 1.0)])
def test_a_free_basal_layer_draws_together(most, least, largest):
    """How far its basal neighbours may be apart says how far; the root of its area after three hours."""
    short = {"numerics.t_end": "3 h", "space.boundary": "open", "tissue.max_basal_distance": most}
    frames = tissue.simulate(CROWDED.changed(short), 1).frames
    first, last = (np.sqrt(layer_area(frame, "basal")) for frame in (frames[0], frames[-1]))
    assert least < last / first < largest
