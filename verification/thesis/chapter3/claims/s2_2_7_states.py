"""Chapter 3, sections 2.2.7 and 2.2.8: feasible states, the state of the quasi-steady model, unique minima."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from tissue.files.parameters import preset
from tissue.model.energy import energy
from tissue.runs.simulate import simulate
from verification.claims import Correction, Effect, Evidence, at_least, at_most, claim, equal
from verification.thesis.chapter3.printed import ENLARGED, HARD, R_SOFT
from verification.thesis.quasi_steady.frozen import constraints, particles

# Of (3.7) [μm].
OFFSET = 0.05
ROUNDING, TOL = 1e-9, 1e-6


@claim(
    "c3.at-all-times",
    "The state is feasible at all times, also right after a cell event.",
    source="sections 2.2 and 3.2",
    quote=(
        "The forces of the system are −∇W(Z, P) with the additional constraint that Z ∈ S at all times. … We define "
        "the FO-PSE model as (3.33) together [with] the discontinuous cell events"
    ),
    correction=Correction(
        (
            "Z ∈ S but right after a division with two offspring and at the onset of mitosis; from there the state is "
            "first projected onto S, and then follows (3.33)"
        ),
        Effect.MODEL,
        (
            "(3.33), whose right side is empty outside of S, so that it cannot go on after such an event; Model 3.1 "
            "and Method 3.7 need no change, for minimisation and projections begin outside of S as well"
        ),
        why=(
            "(3.7) puts both nuclei 0.1 μm apart, (C1) asks for 3.32 μm; the radius of (3.4) jumps to 3.5 μm while "
            "nuclei touch"
        ),
        place=1680,
    ),
    rests_on=("c2.gauss-newton",),
)
def _at_all_times() -> Evidence:
    """Project two discs of radius R from the distance d to d + max(2R - d, 0), by Example 2.5."""
    born, asked = 2 * OFFSET, 2 * HARD
    return Evidence(
        printed=(
            at_least("distance of daughters after (3.7) [μm]", born, asked),
            at_least("distance of touching nuclei as one enters mitosis [μm]", asked, HARD + ENLARGED * R_SOFT),
        ),
        corrected=(
            at_least(
                "distance of daughters after the projection onto S [μm]",
                born + max(asked - born, 0.0),
                asked - ROUNDING,
            ),
        ),
    )


@claim(
    "c3.equal-radii",
    "The feasible set is the one of Proposition 1.22, hence prox-regular.",
    source="section 3.2",
    quote="Since the set S is uniformly prox-regular by Proposition 1.22",
    correction=Correction(
        (
            "… by Proposition 1.22 while no cell is in mitosis; with the two radii of (3.4) the proposition is needed "
            "for hard spheres of different radii"
        ),
        Effect.PROOF,
        "well-posedness while a cell is in mitosis; c3.well-posed has another gap of the same sentence",
        why="the proposition has one distance 2R for all pairs; (C1) has R_i^hard + R_j^hard with two values of R^hard",
        place=2145,
    ),
    rests_on=("c1.prox-constant", "c3.enlarged"),
    chosen="three cells; whether S is prox-regular with two radii is left open",
)
def _equal_radii() -> Evidence:
    mixed, alike = (
        [one + other for one, other in combinations(radii, 2)]
        for radii in ((HARD, HARD, ENLARGED * R_SOFT), (HARD, HARD, HARD))
    )
    what = "largest over smallest distance of (C1)"
    told = f"{what}, {max(mixed):.2f} over {min(mixed):.2f} μm, one in mitosis"
    return Evidence(
        printed=(equal(told, max(mixed) / min(mixed), 1.0, ROUNDING),),
        corrected=(equal(f"{what}, none in mitosis", max(alike) / min(alike), 1.0, ROUNDING),),
    )


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
