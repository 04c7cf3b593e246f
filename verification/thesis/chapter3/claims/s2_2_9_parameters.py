"""Chapter 3, section 2.2.9: how the parameters were found, and what their values mean."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from tissue.files.parameters import preset
from tissue.model.observables import nuclear_layers
from tissue.quasi_steady.judge import local_minimum
from tissue.runs.simulate import simulate
from tissue.state.cells import COORDINATES
from verification.claims import claim
from verification.evidence import Evidence, Kind, at_least, at_most, equal
from verification.thesis.chapter3.claims.s1_3_model import runs_for
from verification.thesis.chapter3.intervals import over_seeds

SEEDS = tuple(range(4))
# Table 1 in μm and μm²/h, Table 3 in h.
R_SOFT, D, DT = 5.0, 2.5, 0.1
WALKERS = 20_000
TOL = 1e-6
# z of a 99.9 % interval.
Z = 3.29


def layers(distance: str) -> list[float]:
    """Layers of nuclei after 8 h with such a distance of apical and basal points [R_soft]."""
    places = ("tissue.basal_spacing", "tissue.max_basal_distance", "tissue.apical_spacing")
    parameters = preset("thesis").changed({"numerics.t_end": "8 h"} | dict.fromkeys(places, distance))
    return [nuclear_layers(simulate(parameters, seed).final) for seed in SEEDS]


@claim(
    "c3.layers",
    "The number of layers of nuclei tells the distance of neighbouring apical and basal points.",
    source="section 2.2.9",
    quote=(
        "by counting the number of layers that the cells form in vivo, one can estimate values for d^init-apical,"
        " d^max-basal depending on the number of cells"
    ),
    chosen="one distance for both kinds of points; layers are soft discs on a vertical line, on average",
)
def _layers() -> Evidence:
    counted = {distance: layers(f"{distance} R_soft") for distance in ("1/3", "1/2", "2/3", "1")}
    found = {distance: over_seeds(values) for distance, values in counted.items()}
    told = ", ".join(f"{there.mean:.1f} for {distance}" for distance, there in found.items())
    drops = [(a.mean - b.mean, a.low - b.high, a.high - b.low) for a, b in pairwise(found.values())]
    mean, low, high = (min(part) for part in zip(*drops, strict=True))
    return Evidence(
        f"60 cells, 8 h: layers of nuclei {told} R_soft between neighbouring points; each distance has its own number "
        f"of layers, {mean:.1f} apart at least",
        printed=(at_least("least drop of the layers with the distance", mean, 0.0, interval=(low, high)),),
        seed=SEEDS[0],
        runs_needed=max(runs_for(values, mean / 2) for values in counted.values()),
    )


def scaled(factors: tuple[float, ...]) -> np.ndarray:
    """The minimum of 8 cells after the stiffnesses ax, bx, axb, aa, xx are multiplied by these."""
    parameters = preset("thesis").changed({"tissue.cells": 8, "numerics.t_end": "1 h"})
    frame, numbers = simulate(parameters, 0).final, parameters.numbers()
    ax, bx, axb, aa, xx = factors
    cells = frame.cells
    of_cells = {"stiff_aa": aa, "stiff_ax": ax, "stiff_bx": bx, "stiff_axb": axb}
    stiff = cells._replace(**{name: factor * getattr(cells, name) for name, factor in of_cells.items()})
    scaled_numbers = numbers._replace(repulsion=xx * numbers.repulsion)
    found = local_minimum(stiff, frame.layers, scaled_numbers, TOL)
    return np.concatenate([getattr(found.cells, name) for name in COORDINATES])


def all_by(factor: float) -> tuple[float, ...]:
    """All stiffnesses multiplied alike."""
    return (factor,) * 5


@claim(
    "c3.relative",
    "Only the ratios of the stiffnesses matter for the minima of the energy.",
    source="section 2.2.9",
    quote="The stiffness coefficients are relative to each other",
    recorded=Kind.NOT_REFUTED,
    tried_on="8 cells",
)
def _relative() -> Evidence:
    plain = scaled(all_by(1.0))
    alike = max(float(np.abs(scaled(all_by(factor)) - plain).max()) for factor in (0.2, 5.0))
    alone = float(np.abs(scaled((1.0, 1.0, 1.0, 1.0, 2.0)) - plain).max())
    return Evidence(
        f"the minimum of 8 cells moves by {alike:.0e} R_soft if all stiffnesses are multiplied by 0.2 or 5, and by "
        f"{alone:.2f} if only α^xx is doubled",
        printed=(
            at_most("move of the minimum by a common factor [R_soft]", alike, 0.0, 1e-4),
            at_least("move by a factor of one stiffness [R_soft]", alone, 0.01),
        ),
        seed=0,
    )


@claim(
    "c3.diffusion",
    "Noise of variance 2DΔt in each coordinate makes free nuclei diffuse with the coefficient D.",
    source="Table 1, (3.17)",
    quote="D = 2.5 μm²/h diffusion coefficient; X_i^k+1 − X_i^k ∼ N_2(0, 2DΔt)",
    recorded=Kind.NOT_REFUTED,
    tried_on="free nuclei for one hour",
)
def _diffusion() -> Evidence:
    """Free nuclei that make the steps (3.17) for an hour: mean square displacement = 4 D t."""
    rng, steps = np.random.default_rng(0), round(1 / DT)
    walk = rng.normal(0.0, math.sqrt(variance(DT)), (WALKERS, steps, 2)).sum(axis=1)
    square = (walk**2).sum(axis=1)
    found = float(square.mean()) / 4
    half = Z * float(square.std()) / 4 / math.sqrt(WALKERS)
    return Evidence(
        f"{WALKERS:,} free nuclei with the steps of (3.17) for 1 h: D = {found:.2f} ± {half:.2f} μm²/h from their mean "
        f"square displacement 4Dt",
        printed=(equal("D of free nuclei [μm²/h]", found, D, 0.1, (found - half, found + half)),),
        seed=0,
        runs_needed=1,
    )


def variance(dt: float) -> float:
    """(3.17): of each coordinate in a step [μm²]."""
    return 2 * D * dt
