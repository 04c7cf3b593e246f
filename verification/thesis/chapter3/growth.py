"""Growth of the height for several dampings (Figures 14 to 16), with the substeps of the preset and with more."""

from __future__ import annotations

from functools import partial

import numpy as np
import pandas as pd

from dincl.study import Key, Row, Study
from tissue.files.parameters import preset
from tissue.frames.observables import height
from verification.thesis.chapter3.growing import PRESETS, SUCCESS, growing
from verification.thesis.chapter3.sampled import over_seeds

DAMPINGS = (0.2, 0.15, 0.1, 0.05, 0.025)
# Length of the runs of Figure 16, how often a height is kept [h], largest h / mu of the fine runs.
END, EVERY, FINE, SEEDS = 48.0, 2.0, 1 / 240, 24
# What the embryo does in some places within 48 h.
DOUBLED = 2.0
COLUMNS = {
    "preset": "Preset",
    "kind": "Substeps",
    "mu": "μ [h]",
    "substeps": "Substeps",
    "ratio": "Height at 48 h / at the start",
    "low": "from",
    "high": "to",
    "least": "Least",
    "largest": "Largest",
    "runs": "Runs",
    "lost": "Lost",
}


def study(smallest: bool = False) -> Study:
    """Return one run for each preset, damping and number of substeps, with all seeds; few with fewest substeps."""
    names = [(name, mu) for name in PRESETS for mu in DAMPINGS]
    keys = [(*name, count) for name in names for count in substeps_of(*name)[: 1 if smallest else None]]
    seeds, key = 2 if smallest else SEEDS, ("preset", "mu", "substeps")
    runs = tuple(dict(zip(key, one, strict=True)) for one in sorted(keys, key=lambda one: -one[2]))
    run, settings = partial(grown, seeds=seeds), {"seeds": seeds, "end": END, "every": EVERY}
    return Study("tissue_growth", "Tissue: growth", key, runs, run, settings, COLUMNS, by=("seed", "t"))


def substeps_of(name: str, mu: float, fine: float = FINE) -> tuple[int, ...]:
    """Return substeps of the preset, and as many more as h / mu <= ``fine`` takes."""
    numbers = preset(name).numbers()
    return tuple(sorted({numbers.substeps, max(numbers.substeps, int(np.ceil(numbers.dt / mu / fine - 1e-9)))}))


def grown(key: Key, seeds: int, end: float = END) -> list[Row]:
    """Return one row for each seed and time: the height over that of the start; NaN from where a run is lost."""
    rows: list[Row] = []
    for seed in range(seeds):
        run = growing(key["preset"], seed, mu=key["mu"], substeps=key["substeps"])
        first = height(run.frame())
        for t in np.arange(0.0, end + EVERY / 2, EVERY).tolist():
            ratio = height(run.frame()) / first if run.to(t) else np.nan
            rows.append(dict(key) | {"seed": seed, "t": t, "ratio": ratio, "status": run.status})
    return rows


def fine(table: pd.DataFrame) -> pd.Series:
    """Return whether a row belongs to the finest runs of its preset and damping, in the order of the table."""
    return table["substeps"] == table.groupby(["preset", "mu"])["substeps"].transform("max")


def last_rows(table: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of the end."""
    return table[table["t"] == table["t"].max()]


def ratios(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each preset, damping and number of substeps: height at the end over that at the start.

    Mean over the seeds with its interval, their least and largest; and how many were lost.
    """
    rows = []
    for (name, mu, substeps), mine in last_rows(table).groupby(["preset", "mu", "substeps"]):
        kept = mine.loc[mine["status"] == SUCCESS, "ratio"]
        mean, low, high = over_seeds(kept)
        about = {"preset": name, "mu": mu, "substeps": substeps, "ratio": mean, "low": low, "high": high}
        about |= {"least": kept.min(), "largest": kept.max()}
        rows.append(about | {"runs": len(mine), "lost": len(mine) - len(kept)})
    return pd.DataFrame(rows).sort_values(["preset", "substeps", "mu"], ignore_index=True)


def doubling(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each preset and kind of substeps: the damping at which the height doubles.

    For each seed on the line in log mu through the two dampings next to it, without those of which a run was lost; mean
    over the seeds with its interval. NaN where the ratio does not come near: beyond the dampings by more than one of
    their distances.
    """
    rows = []
    for name, mine in last_rows(table).groupby("preset"):
        own = mine["substeps"] == mine["substeps"].min()
        for kind, one in (("as the preset", mine[own]), ("fine", mine[fine(mine)])):
            whole = one.pivot(index="seed", columns="mu", values="ratio").dropna(axis="columns")
            found = [_where_doubled(whole.columns.to_numpy(), ratio) for ratio in whole.to_numpy()]
            mean, low, high = over_seeds(found)
            rows.append({"preset": name, "kind": kind, "mu": mean, "low": low, "high": high, "runs": len(found)})
    return pd.DataFrame(rows)


def _where_doubled(mu: np.ndarray, ratio: np.ndarray) -> float:
    """Return mu with ratio(mu) = 2, for ratios (K,) that fall with mu."""
    if len(mu) < 2:
        return np.nan
    k = int(np.clip(np.searchsorted(-ratio, -DOUBLED), 1, len(mu) - 1))
    x = np.log(mu[k - 1 : k + 1])
    part = (DOUBLED - ratio[k - 1]) / (ratio[k] - ratio[k - 1])
    return float(np.exp(x[0] + part * (x[1] - x[0]))) if -1 <= part <= 2 else np.nan
