"""Chapter 3, sections 1.3 and 2.1: how nuclei move in the tissue, and why they look stratified."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pandas as pd

from tissue.files.parameters import preset
from tissue.frames.observables import ab_positions
from tissue.runs.simulate import simulate
from verification.claims import Evidence, at_least, at_most, claim, equal
from verification.thesis.chapter3.growing import PRESETS
from verification.thesis.chapter3.sampled import MODEL, MOST_RUNS, SEEDS, of_mean, runs_for
from verification.thesis.chapter4.ratios import Ratio

# Hours before division: the passive part that is looked at, and the rise (T^G2 + T^mitosis = 1 h).
PASSIVE, RISE = (-9.0, -1.1), (-1.0, -0.1)
# The turn is read from means over positions that are 0.1 h apart.
GRAIN = 0.2
LEVEL = 0.95
# The standard deviation of y_AB from which on nuclei count as stratified.
STRATIFIED = 0.1
# The smallest hard discs that parameters may have, and no soft ones.
NO_PUSHING = (("cell.alpha_xx", 0.0), ("cell.hard_radius", "0.001 R_soft"), ("cell.enlarged_radius", "0.001 R_soft"))


@cache
def grown(seed: int, name: str = "thesis", g2: str = "30 min", mitosis: str = "30 min") -> pd.DataFrame:
    """Return all cells of a run of 16 h, every 0.1 h."""
    changes = {"numerics.t_end": "16 h", "numerics.keep": "0.1 h", "cell.g2": g2, "cell.mitosis": mitosis}
    return simulate(preset(name).changed(changes), seed).table()


def nuclei(seed: int, g2: str = "30 min", mitosis: str = "30 min") -> pd.DataFrame:
    """Return the cells whose cycle ends in the run, by the hours to their division."""
    table = grown(seed, g2=g2, mitosis=mitosis)
    ends = table["time_h"] - table["age_h"] + table["cycle_h"]
    timed = table.assign(before=(table["age_h"] - table["cycle_h"]).round(1))
    return timed[(ends < table["time_h"].max()) & (timed["before"] < 0)]


def speed(table: pd.DataFrame, part: tuple[float, float]) -> float:
    """Return the mean of dy_AB/dt over the cells that are seen from the beginning of the part to its end."""
    inside = table[table["before"].between(part[0] - 0.01, part[1] + 0.01)]
    cycles = inside.groupby(["id", "cycle_h"])
    whole = cycles["before"].agg(np.ptp) > part[1] - part[0] - 0.25
    return float(((cycles["y_ab"].last() - cycles["y_ab"].first())[whole]).mean() / (part[1] - part[0]))


@claim(
    "c3.inm",
    "Nuclei move slowly towards the basal side for most of the cycle and fast to the apical side at the end of it.",
    source="section 1.3; Figure 7",
    also=("c3.last-hour",),
    quote=(
        "an apical to basal movement during the G1 phase, the S phase and a passive part of the G2 phase. Followed by "
        "a fast basal to apical displacement during the active part of the G2 phase and mitosis"
    ),
    rests_on=MODEL,
    chosen="4 runs of 16 h; ages at the start uniform on the cycle; nuclei anywhere in the box",
)
def _movement() -> Evidence:
    down, up = ([speed(nuclei(seed), part) for seed in SEEDS] for part in (PASSIVE, RISE))
    turns = [turn(nuclei(seed)) for seed in SEEDS]
    return Evidence(
        printed=(
            of_mean("dy_AB/dt from 9 h to 1.1 h before division [1/h]", down, at_most, 0.0),
            of_mean("dy_AB/dt in the last hour [1/h]", up, at_least, 0.0),
            at_least("speed in the last hour over the speed before", abs(float(np.mean(up) / np.mean(down))), 1.0),
            of_mean("time before division at which y_AB turns upwards [h]", turns, equal, 1.0, GRAIN),
        ),
        seed=SEEDS[0],
        runs_needed=max(runs_for(values, abs(float(np.mean(values)))) for values in (down, up)),
    )


def divided_apically(**phases: str) -> tuple[int, int]:
    """Return the number of cell cycles that end with the nucleus in the apical half, and of all that end."""
    last = pd.concat([nuclei(seed, **phases).groupby(["id", "cycle_h"])["y_ab"].last() for seed in SEEDS])
    return int((last > 0.5).sum()), len(last)


@claim(
    "c3.apical-mitosis",
    "With interkinetic nuclear movement practically every cell divides on the apical side.",
    source="section 1.3",
    quote="One consequence of INM is that effectively all cell division occurs on the apical side of the tissue",
    rests_on=("c3.inm",),
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


def turn(table: pd.DataFrame) -> float:
    """Return the hours before division at which the mean of y_AB over all cells bends upwards most."""
    mean = table[table["before"] > PASSIVE[0] / 2].groupby("before")["y_ab"].mean()
    return -float(mean.index[1 + int(np.diff(mean, 2).argmax())])


def spread(name: str, changes: tuple[tuple[str, object], ...]) -> list[float]:
    """Return the standard deviation of y_AB over the nuclei after 24 h, for each seed."""
    parameters = preset(name).changed({"numerics.t_end": "24 h"} | dict(changes))
    return [float(ab_positions(simulate(parameters, seed).final).std()) for seed in SEEDS]


@claim(
    "c3.pushing",
    "Nuclei lie at different heights because they push each other.",
    source="section 2.1",
    quote="The mechanical pushing between nuclei leads to the pseudostratified nature of the tissue",
    rests_on=MODEL,
    chosen="a standard deviation of y_AB above 0.1 counts as stratified",
)
def _pushing() -> Evidence:
    pushed, free = ([spread(name, changes) for name in PRESETS] for changes in ((), NO_PUSHING))
    what = "standard deviation of y_AB after 24 h"
    return Evidence(
        printed=(
            *(
                of_mean(f"{what}, {name} rules", v, at_least, STRATIFIED)
                for name, v in zip(PRESETS, pushed, strict=True)
            ),
            *(
                of_mean(f"{what} without repulsion and hard discs, {name} rules", v, at_most, STRATIFIED)
                for name, v in zip(PRESETS, free, strict=True)
            ),
        ),
        seed=SEEDS[0],
        runs_needed=max(runs_for(one, abs(float(np.mean(one)) - STRATIFIED)) for one in (*pushed, *free)),
    )
