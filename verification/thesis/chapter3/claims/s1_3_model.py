"""Chapter 3, sections 1.3 and 2.1: how nuclei move in the tissue, and why they look stratified."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache

import numpy as np
import pandas as pd
from scipy.special import stdtrit

from tissue.files.parameters import preset
from tissue.frames.observables import ab_positions
from tissue.runs.simulate import simulate
from tissue.statistics.ratios import Ratio
from verification.claims import Evidence, at_least, at_most, equal
from verification.thesis.chapter3.intervals import over_seeds
from verification.thesis.text.quoted import claim

SEEDS = tuple(range(4))
# Hours before division: the passive part that is looked at, and the rise (T^G2 + T^mitosis = 1 h).
PASSIVE, RISE = (-9.0, -1.1), (-1.0, -0.1)
# The turn is read from means over positions that are 0.1 h apart.
GRAIN = 0.2
MOST_RUNS = 10_000
LEVEL = 0.95
# The standard deviation of y_AB from which on nuclei count as stratified.
STRATIFIED = 0.1
# The smallest hard discs that parameters may have, and no soft ones.
NO_PUSHING = (
    ("cell.alpha_xx", 0.0),
    ("cell.hard_radius", "0.001 R_soft"),
    ("cell.enlarged_radius", "0.001 R_soft"),
)


@cache
def grown(seed: int, name: str = "thesis", g2: str = "30 min", mitosis: str = "30 min") -> pd.DataFrame:
    """All cells of a run of 16 h, every 0.1 h."""
    changes = {"numerics.t_end": "16 h", "numerics.keep": "0.1 h", "cell.g2": g2, "cell.mitosis": mitosis}
    return simulate(preset(name).changed(changes), seed).table()


def nuclei(seed: int, g2: str = "30 min", mitosis: str = "30 min") -> pd.DataFrame:
    """The cells whose cycle ends in the run, by the hours to their division."""
    table = grown(seed, g2=g2, mitosis=mitosis)
    ends = table["time_h"] - table["age_h"] + table["cycle_h"]
    timed = table.assign(before=(table["age_h"] - table["cycle_h"]).round(1))
    return timed[(ends < table["time_h"].max()) & (timed["before"] < 0)]


def runs_for(values: Sequence[float], gap: float) -> int:
    """The fewest runs whose 95 % interval of the mean is narrower than ± gap, with the scatter of these values."""
    scatter = float(np.std(values, ddof=1))
    enough = (n for n in range(2, MOST_RUNS) if stdtrit(n - 1, 0.975) * scatter / math.sqrt(n) < gap)
    return next(enough, MOST_RUNS)


def speed(table: pd.DataFrame, part: tuple[float, float]) -> float:
    """Mean of dy_AB/dt over the cells that are seen from the beginning of the part to its end."""
    inside = table[table["before"].between(part[0] - 0.01, part[1] + 0.01)]
    cycles = inside.groupby(["id", "cycle_h"])
    whole = cycles["before"].agg(np.ptp) > part[1] - part[0] - 0.25
    return float(((cycles["y_ab"].last() - cycles["y_ab"].first())[whole]).mean() / (part[1] - part[0]))


@claim(
    "c3.inm",
    "Nuclei move slowly towards the basal side for most of the cycle and fast to the apical side at the end of it.",
    "section 1.3",
    chosen="ages at the start uniform on the cycle; nuclei anywhere in the box",
)
def _movement() -> Evidence:
    speeds = [[speed(nuclei(seed), part) for seed in SEEDS] for part in (PASSIVE, RISE)]
    down, up = map(over_seeds, speeds)
    return Evidence(
        f"{len(SEEDS)} runs of 16 h with the values of Tables 1, 2, 3 and 5: from {-PASSIVE[0]:g} h to "
        f"{-PASSIVE[1]:g} h before division y_AB changes by {down.mean:.3f} per hour, in the last hour by "
        f"{up.mean:+.2f} per hour, {-up.mean / down.mean:.0f} times as fast",
        printed=(
            at_most("passive speed of y_AB [1/h]", down.mean, 0.0, interval=(down.low, down.high)),
            at_least("active speed of y_AB [1/h]", up.mean, 0.0, interval=(up.low, up.high)),
            at_least("active over passive speed", abs(up.mean / down.mean), 1.0),
        ),
        seed=SEEDS[0],
        runs_needed=max(runs_for(values, abs(float(np.mean(values)))) for values in speeds),
    )


def cycles_for(share: float) -> int:
    """How many cycles would show that such a share is above LEVEL."""
    enough = (n for n in range(1, MOST_RUNS) if Ratio(round(share * n), n).interval()[0] > LEVEL)
    return next(enough, MOST_RUNS)


def divided_apically(**phases: str) -> tuple[int, int]:
    """Cell cycles that end with the nucleus in the apical half, and all that end."""
    last = pd.concat([nuclei(seed, **phases).groupby(["id", "cycle_h"])["y_ab"].last() for seed in SEEDS])
    return int((last > 0.5).sum()), len(last)


@claim(
    "c3.apical-mitosis",
    "With interkinetic nuclear movement practically every cell divides on the apical side.",
    "section 1.3",
    chosen="the apical side is y_AB > 1/2; 95 % count as effectively all",
)
def _apical() -> Evidence:
    """Without the phases of section 2.2.3 there is no rise."""
    (apical, of), (without, of_those) = divided_apically(), divided_apically(g2="0 h", mitosis="0 h")
    share, other = Ratio(apical, of).interval(), Ratio(without, of_those).interval()
    return Evidence(
        f"{apical} of {of} cell cycles end with the nucleus in the apical half, 95 % interval of the share "
        f"[{share[0]:.3f}, {share[1]:.3f}]; without INM {without} of {of_those}",
        printed=(
            at_least("share of divisions in the apical half", apical / of, LEVEL, interval=share),
            at_most("the share without INM", without / of_those, LEVEL, interval=other),
        ),
        seed=SEEDS[0],
        runs_needed=math.ceil(len(SEEDS) * cycles_for(apical / of) / of),
    )


def turn(table: pd.DataFrame) -> float:
    """Hours before division at which the mean of y_AB over all cells bends upwards most."""
    mean = table[table["before"] > PASSIVE[0] / 2].groupby("before")["y_ab"].mean()
    return -float(mean.index[1 + int(np.diff(mean, 2).argmax())])


@claim(
    "c3.last-hour",
    "Nuclei turn round one hour before division.",
    "Figure 7",
    chosen="as for c3.inm",
)
def _last_hour() -> Evidence:
    turns = [turn(nuclei(seed)) for seed in SEEDS]
    found = over_seeds(turns)
    return Evidence(
        f"{len(SEEDS)} runs of 16 h: the mean of y_AB over the nuclei bends upwards {found.mean:.2f} h before division "
        f"[{found.low:.2f}, {found.high:.2f}]; T^G2 + T^mitosis = 1 h",
        printed=(equal("turn before division [h]", found.mean, 1.0, GRAIN, (found.low, found.high)),),
        seed=SEEDS[0],
        runs_needed=runs_for(turns, GRAIN - abs(found.mean - 1.0)),
    )


def spread(name: str, changes: tuple[tuple[str, object], ...]) -> list[float]:
    """Standard deviation of y_AB over the nuclei after 24 h, for each seed."""
    parameters = preset(name).changed({"numerics.t_end": "24 h"} | dict(changes))
    return [float(ab_positions(simulate(parameters, seed).final).std()) for seed in SEEDS]


@claim(
    "c3.pushing",
    "Nuclei lie at different heights because they push each other.",
    "section 2.1",
    chosen="a standard deviation of y_AB above 0.1 counts as stratified",
)
def _pushing() -> Evidence:
    names = ("thesis", "published")
    values = [spread(name, changes) for changes in ((), NO_PUSHING) for name in names]
    found = [over_seeds(one) for one in values]
    pushed, free = found[:2], found[2:]
    return Evidence(
        f"after 24 h nuclei spread over y_AB with the standard deviation {pushed[0].mean:.2f} ({pushed[1].mean:.2f} "
        f"by the rules of the published runs); without repulsion and hard discs {free[0].mean:.3f} "
        f"({free[1].mean:.3f}): they form a single row",
        printed=(
            *(
                at_least(f"spread, {name} rules", one.mean, STRATIFIED, interval=one[1:])
                for name, one in zip(names, pushed, strict=True)
            ),
            *(
                at_most(f"spread without pushing, {name} rules", one.mean, STRATIFIED, interval=one[1:])
                for name, one in zip(names, free, strict=True)
            ),
        ),
        seed=SEEDS[0],
        runs_needed=max(runs_for(one, abs(float(np.mean(one)) - STRATIFIED)) for one in values),
    )
