"""Chapter 3, section 1.3: with interkinetic nuclear movement cells divide on the apical side."""

from __future__ import annotations

import math
from functools import cache

import pandas as pd

from tissue.files.parameters import preset
from tissue.runs.simulate import simulate
from verification.claims import Evidence, at_least, at_most, claim
from verification.thesis.chapter3.sampled import MODEL, MOST_RUNS, SEEDS
from verification.thesis.chapter4.ratios import Ratio

LEVEL = 0.95


@cache
def grown(seed: int, g2: str = "30 min", mitosis: str = "30 min") -> pd.DataFrame:
    """Return all cells of a run of 16 h, every 0.1 h."""
    changes = {"numerics.t_end": "16 h", "numerics.keep": "0.1 h", "cell.g2": g2, "cell.mitosis": mitosis}
    return simulate(preset("thesis").changed(changes), seed).table()


def nuclei(seed: int, g2: str = "30 min", mitosis: str = "30 min") -> pd.DataFrame:
    """Return the cells whose cycle ends in the run, by the hours to their division."""
    table = grown(seed, g2=g2, mitosis=mitosis)
    ends = table["time_h"] - table["age_h"] + table["cycle_h"]
    timed = table.assign(before=(table["age_h"] - table["cycle_h"]).round(1))
    return timed[(ends < table["time_h"].max()) & (timed["before"] < 0)]


def divided_apically(**phases: str) -> tuple[int, int]:
    """Return the number of cell cycles that end with the nucleus in the apical half, and of all that end."""
    last = pd.concat([nuclei(seed, **phases).groupby(["id", "cycle_h"])["y_ab"].last() for seed in SEEDS])
    return int((last > 0.5).sum()), len(last)


@claim(
    "c3.apical-mitosis",
    "With interkinetic nuclear movement practically every cell divides on the apical side.",
    source="section 1.3",
    quote="One consequence of INM is that effectively all cell division occurs on the apical side of the tissue",
    rests_on=MODEL,
    chosen="the apical side is y_AB > 1/2; 95 % count as effectively all; INM is switched off by T^G2 = T^mitosis = 0",
)
def _apical() -> Evidence:
    (apical, of), (without, of_those) = divided_apically(), divided_apically(g2="0 h", mitosis="0 h")
    share, other = Ratio(apical, of).interval(), Ratio(without, of_those).interval()
    # Cycles that would show that such a share is above LEVEL.
    enough = (n for n in range(1, MOST_RUNS) if Ratio(round(apical / of * n), n).interval()[0] > LEVEL)
    return Evidence(
        printed=(
            at_least(f"share of {of} divisions in the apical half", apical / of, LEVEL, interval=share),
            at_most(f"share of {of_those} divisions without INM", without / of_those, LEVEL, interval=other),
        ),
        seed=SEEDS[0],
        runs_needed=math.ceil(len(SEEDS) * next(enough, MOST_RUNS) / of),
    )
