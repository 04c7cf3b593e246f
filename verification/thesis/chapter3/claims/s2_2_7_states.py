"""Chapter 3, sections 2.2.7 and 2.2.8: feasible states, the state of the quasi-steady model, unique minima."""

from __future__ import annotations

import numpy as np

from tissue.files.parameters import preset
from tissue.model.energy import energy
from tissue.runs.simulate import simulate
from verification.claims import Evidence, at_most, claim
from verification.thesis.quasi_steady.frozen import constraints, particles

TOL = 1e-6


def moving() -> tuple[str, ...]:
    """Return the coordinates that a shift along the basal layer moves."""
    return "x", "ax", "bx"


@claim(
    "c3.not-unique",
    "Minima of the energy over the feasible states need not be unique.",
    source="Remark 3.2",
    quote="The local minimisation in the QSS model might not be unique in some circumstances",
    chosen="60 cells after 1 h, all moved by 0.7 R^soft along the basal layer",
)
def _not_unique() -> Evidence:
    """Move the whole tissue along the basal layer."""
    parameters = preset("thesis").changed({"numerics.t_end": "1 h"})
    frame, numbers = simulate(parameters, 0).final, parameters.numbers()
    cells, by = frame.cells, 0.7
    moved = cells._replace(**{name: getattr(cells, name) + by for name in moving()})
    change = abs(energy(moved, frame.layers, numbers) / energy(cells, frame.layers, numbers) - 1)
    before, after = (
        np.concatenate([part.select(z, 0.0).values(z) for part in constraints(at, frame.layers, numbers)])
        for at in (cells, moved)
        for z in (particles(at),)
    )
    worse = float(np.minimum(before, 0.0).min() - np.minimum(after, 0.0).min())
    return Evidence(
        printed=(
            at_most("relative change of W by the move", change, 0.0, TOL),
            at_most("growth of the largest violation of (C1) to (C4) by the move [R_soft]", worse, 0.0, TOL),
        ),
        seed=0,
    )
