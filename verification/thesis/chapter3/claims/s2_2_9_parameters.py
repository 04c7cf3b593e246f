"""Chapter 3, section 2.2.9: how the parameters were found, and what their values mean."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from itertools import pairwise

from tissue.files.parameters import preset
from tissue.frames.observables import nuclear_layers
from tissue.runs.simulate import simulate
from verification.claims import Evidence, Verdict, at_least, proved
from verification.formal.algebra import identity, library
from verification.formal.reals import implication
from verification.thesis.chapter3.claims.s1_3_model import runs_for
from verification.thesis.chapter3.intervals import over_seeds
from verification.thesis.text.quoted import claim

SEEDS = tuple(range(4))
# Table 1 in μm and μm²/h, Table 3 in h.
R_SOFT, D = 5.0, 2.5


def layers(distance: str) -> list[float]:
    """Layers of nuclei after 8 h with such a distance of apical and basal points [R_soft]."""
    places = ("tissue.basal_spacing", "tissue.max_basal_distance", "tissue.apical_spacing")
    parameters = preset("thesis").changed({"numerics.t_end": "8 h"} | dict.fromkeys(places, distance))
    return [nuclear_layers(simulate(parameters, seed).final) for seed in SEEDS]


@claim(
    "c3.layers",
    "The number of layers of nuclei tells the distance of neighbouring apical and basal points.",
    "section 2.2.9",
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


@claim(
    "c3.relative",
    "Only the ratios of the stiffnesses matter for the minima of the energy.",
    "section 2.2.9",
    Verdict.PROVED,
)
def _relative() -> Evidence:
    """Energies v, w of two states, multiplied by c; and a minimiser of c v + w that is none of v + w."""
    return proved(
        implication(
            "W(z) ≤ W(z′) gives cW(z) ≤ cW(z′) for every common factor c > 0: the minima are the same",
            lambda s, v, w, c: ([c > 0, v <= w], s * c * v <= s * c * w),
            "c < 0",
        )
    )


@claim(
    "c3.diffusion",
    "Noise of variance 2DΔt in each coordinate makes free nuclei diffuse with the coefficient D.",
    "Table 1, (3.17)",
    Verdict.PROVED,
)
def _diffusion() -> Evidence:
    """One coordinate and one step from x: independent steps add their variances, so n of them have 2 D n dt."""
    sp = library()
    x, u = sp.symbols("x u", real=True)
    D, h = sp.symbols("D h", positive=True)
    density = sp.exp(-(u**2) / (4 * D * h)) / sp.sqrt(4 * sp.pi * D * h)
    return proved(
        identity(
            "E[(x + u)²] = x² + 2DΔt and E[x + u] = x for u ∼ N(0, 2DΔt): in the plane the mean square "
            "displacement is 4Dt",
            lambda s: [
                sp.integrate((x + u) ** 2 * density, (u, -sp.oo, sp.oo)) - x**2 - s * 2 * D * h,
                sp.integrate((x + u) * density, (u, -sp.oo, sp.oo)) - x,
            ],
            "−2DΔt",
        )
    )
