"""Chapter 3, section 2.2.8: the state of the quasi-steady model, and how unique its minima are."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize_scalar

from tissue.files.parameters import preset
from tissue.frames.frame import Frame
from tissue.model.cycle import adapt_rest_lengths
from tissue.model.energy import energy
from tissue.quasi_steady.frozen import constraints, particles
from tissue.rules.slice import in_plane
from tissue.runs.compiled_rules import rules_pointer
from tissue.runs.group import Group
from tissue.runs.simulate import simulate
from tissue.state.cells import COORDINATES, Cells
from tissue.state.numbers import numbers_pointer
from tissue.state.running import contents, new_state
from verification.claims import Evidence, Verdict, at_least, at_most
from verification.thesis.chapter3.terms import slope, spring
from verification.thesis.text.quoted import claim

TOL = 1e-6
# Rest lengths that are off by this [R_soft], as they are between G2 and the hour after.
OFF = 0.5
# A spring of the cytoskeleton: stiffness of Table 2, initial rest length of 1.5 R_soft.
STIFFNESS, REST = 2.0, 1.5
STARTS, WEIGHTS, STEPS = (1.8, 2.2, 3.0, 4.0), (0.3, 1.0, 3.0), 400


def next_state(frame: Frame, rest: float) -> Cells:
    """One step of the model without noise after all cytoskeleton springs are lengthened by ``rest``."""
    numbers = preset("thesis").numbers()._replace(variance=0.0)
    longer = frame.cells._replace(rest_ax=frame.cells.rest_ax + rest, rest_bx=frame.cells.rest_bx + rest)
    held = new_state(longer, frame.layers, capacity=len(longer.x), space=in_plane())
    adapt_rest_lengths(held, frame.t, numbers_pointer(numbers), rules_pointer([held]))
    Group([held], numbers).make_substeps()
    return contents(held)[0]


def apart(one: Cells, other: Cells) -> float:
    """Largest difference of a coordinate."""
    return max(float(np.abs(getattr(one, name) - getattr(other, name)).max()) for name in COORDINATES)


@claim(
    "c3.state",
    "The positions with the hard radii and desired rest lengths are the state, and the energy is a function of them.",
    "section 2.2 and Model 3.1",
    Verdict.CORRECTED,
)
def _state() -> Evidence:
    """Equal Z^k and P^k: both are functions of positions and ages, which the two states share."""
    numbers = preset("thesis").numbers()
    frame = simulate(preset("thesis").changed({"numerics.t_end": "1 h"}), 0).final
    cells = frame.cells
    printed = apart(next_state(frame, 0.0), next_state(frame, OFF))
    by_radius, by_rest = (
        abs(energy(changed, frame.layers, numbers) - energy(cells, frame.layers, numbers))
        for changed in (cells._replace(radius=2 * cells.radius), cells._replace(rest_ax=cells.rest_ax + OFF))
    )
    return Evidence(
        f"60 cells, twice with the same positions, radii and desired rest lengths, but with rest lengths {OFF} apart: "
        f"after one step the positions differ by {printed:.2f}. W changes by {by_radius:g} with all R^hard doubled, by "
        f"{by_rest:.0f} with η^ax: P must have the 3N − 1 present rest lengths",
        printed=(at_most("difference of two states after equal (Z, P) [R_soft]", printed, 0.0, 1e-9),),
        corrected=(
            at_most("change of W with the hard radii", by_radius, 0.0, 1e-9),
            at_least("change of W with the present rest lengths", by_rest, 1.0),
        ),
        seed=0,
    )


@claim(
    "c3.not-unique",
    "Minima of the energy over the feasible states need not be unique.",
    "Remark 3.2",
)
def _not_unique() -> Evidence:
    """The whole tissue moved along the basal layer: as low, and as feasible."""
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
        f"60 cells after 1 h, all moved by {by} R_soft along the basal layer: W changes by {change:.0e} of itself, the "
        f"largest violation of (C1) to (C4) by {abs(worse):.0e}: no minimum is unique",
        printed=(
            at_most("relative change of W", change, 0.0, TOL),
            at_most("growth of the violation [R_soft]", worse, 0.0, TOL),
        ),
        seed=0,
    )


def moving() -> tuple[str, ...]:
    """The coordinates that a shift along the basal layer moves."""
    return "x", "ax", "bx"


def regularised(d: float, weight: float, power: int) -> float:
    """One step of Remark 3.2 for the length d of a single spring (3.9), with |z − z^k|^power."""

    def total(z: float) -> float:
        return spring(z, REST, STIFFNESS) + weight * abs(z - d) ** power

    found = minimize_scalar(total, bounds=(1.0, 6.0), method="bounded", options={"xatol": 1e-10}).x
    return d if total(d) <= total(found) else float(found)


def at_rest(power: int) -> tuple[float, float]:
    """Where the steps stay from all starts: largest distance from the minimum of W, and largest force there."""
    distance, force = 0.0, 0.0
    for start in STARTS:
        for weight in WEIGHTS:
            d = start
            for _ in range(STEPS):
                after = regularised(d, weight, power)
                if abs(after - d) < TOL / STEPS:
                    break
                d = after
            distance = max(distance, abs(d - 1 - REST))
            force = max(force, abs(slope(lambda z: spring(z, REST, STIFFNESS), d)))
    return distance, force


def minima(power: int) -> float:
    """Extent of the set of minimisers of max(0, 1 − z) + |z|^power, a convex W with z^k = 0 and c = 1."""
    z = np.linspace(-1.0, 3.0, 4001)
    total = np.maximum(0.0, 1.0 - z) + np.abs(z) ** power
    return float(np.ptp(z[total <= total.min() + 1e-12]))


@claim(
    "c3.regularised",
    "A distance from the last state added to the energy makes the minimiser unique.",
    "Remark 3.2",
    Verdict.CORRECTED,
    chosen="a regularised step should have one minimiser for each convex W and c > 0, and rest at minima of W only",
)
def _regularised() -> Evidence:
    (printed, force), (right, _) = at_rest(1), at_rest(2)
    return Evidence(
        f"one spring (3.9), {len(STARTS) * len(WEIGHTS)} starts and weights c: with c ‖Z − Z^k‖ the steps stay up to "
        f"{printed:.1f} R_soft from its rest length, wherever |∇W| ≤ c, here {force:.1f}; with the square "
        f"{right:.0e}. For W = max(0, 1 − z), z^k = 0, c = 1 the minimisers fill an interval of {minima(1):.1f}, with "
        f"the square {minima(2):.0e}",
        printed=(
            at_most("largest distance from the minimum of W at rest [R_soft]", printed, 0.0, 1e-3),
            at_most("extent of the minimisers for a convex W", minima(1), 0.0, 1e-3),
        ),
        corrected=(
            at_most("distance with the square [R_soft]", right, 0.0, 1e-3),
            at_most("extent with the square", minima(2), 0.0, 1e-3),
        ),
    )
