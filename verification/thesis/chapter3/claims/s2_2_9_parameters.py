"""Chapter 3, section 2.2.9: how parameters were found; entries of Tables 1 and 2 that other places contradict."""

from __future__ import annotations

from itertools import pairwise

from tissue.files.parameters import preset
from tissue.frames.observables import extents
from tissue.runs.simulate import simulate
from verification.claims import Evidence, at_least, claim
from verification.thesis.chapter3.intervals import over_seeds
from verification.thesis.chapter3.sampled import MODEL, SEEDS, runs_for


def layers(distance: str) -> list[float]:
    """Return the layers of nuclei after 8 h with such a distance of apical and basal points [R_soft]."""
    places = ("tissue.basal_spacing", "tissue.max_basal_distance", "tissue.apical_spacing")
    parameters = preset("thesis").changed({"numerics.t_end": "8 h"} | dict.fromkeys(places, distance))
    return [extents(simulate(parameters, seed).final).nuclear_layers for seed in SEEDS]


@claim(
    "c3.layers",
    "The number of layers of nuclei tells the distance of neighbouring apical and basal points.",
    source="section 2.2.9",
    quote=(
        "by counting the number of layers that the cells form in vivo, one can estimate values for d^init-apical, "
        "d^max-basal depending on the number of cells"
    ),
    rests_on=MODEL,
    chosen="60 cells, 8 h; one distance for both kinds of points; layers are soft discs on a vertical line, on average",
)
def _layers() -> Evidence:
    counted = {distance: layers(f"{distance} R_soft") for distance in ("1/3", "1/2", "2/3", "1")}
    found = [over_seeds(values) for values in counted.values()]
    told = ", ".join(f"{there.mean:.1f} for {distance}" for distance, there in zip(counted, found, strict=True))
    drops = [(a.mean - b.mean, a.low - b.high, a.high - b.low) for a, b in pairwise(found)]
    mean, low, high = (min(part) for part in zip(*drops, strict=True))
    what = f"least drop of the layers ({told} R_soft) from a distance to the next"
    return Evidence(
        printed=(at_least(what, mean, 0.0, interval=(low, high)),),
        seed=SEEDS[0],
        runs_needed=max(runs_for(values, mean / 2) for values in counted.values()),
    )
