"""Results of the studies of chapter 4 that take no time: all columns, of random numbers. And how to read a figure."""

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
from matplotlib.colors import to_hex

from tissue.events.known import row
from tissue.files.parameters import preset
from tissue.files.scenario import drawn
from tissue.runs.simulate import simulate
from tissue.statistics.ratios import ratio
from tissue.study.outcomes import Outcomes
from tissue.study.plan import load_study
from tissue.study.run import carry_out

RUNS = {"table5_63": 16, "table5_35": 256, "table5_7": 16}
SHORT = {"numerics.keep": "24 h"}
TIMES = (0.0, 24.0, 48.0)
POPULATIONS = {"table5_63": "63 % [P]", "table5_35": "35 % [P]", "table5_7": "7 % [P]"}


@lru_cache
def whole(cells, seed):
    """Of a run with [B] at 12 h."""
    changes = {"numerics.keep": "6 h", "numerics.t_end": "24 h", "emt.cells": cells, "emt.b": "12 h"}
    return simulate(preset("thesis").changed(changes), seed).table()


def outcomes(parameters, replicates, seeds, asked=()):
    """Tables with all columns, of random numbers; times of events as they are drawn for the scenario."""
    m, rows, runs = parameters.emt.cells, [], []
    times = [
        parameters.numerics.keep.value * k for k in range(round(parameters.t_end / parameters.numerics.keep.value) + 1)
    ]
    for replicate, seed in zip(replicates, seeds, strict=True):
        rng = np.random.default_rng(seed)
        emt, inm = drawn(parameters.scenario(), rng)
        began = {f"t_{name}_h": emt.at[row(name)] for name in "absp"}
        onset = emt.at.min(axis=0)
        table = {"replicate": np.full(m, replicate), "cell": np.arange(m), "inm": inm, **began, "onset_h": onset}
        table["onset_ab"] = np.where(np.isfinite(onset), rng.random(m), np.nan)
        for t in times:
            table |= {f"ab_{t:g}h": rng.uniform(-0.8, 1.4, m), f"below_{t:g}h": rng.random(m) < 0.3}
        ends = table[f"ab_{times[-1]:g}h"]
        table["extruded"] = np.select([ends < 0, ends > 1], ["basal", "apical"], "no")
        table["extruded_h"] = np.where(table["extruded"] == "no", np.nan, times[-1] - 1.0)
        rows.append(pd.DataFrame(table))
        counts = {
            f"controls{side}_{t:g}h": n for t in times for side, n in (("", 50), ("_apical", seed % 7), ("_basal", 0))
        }
        runs.append({"replicate": replicate, "seed": seed, "status": "SUCCESS", "detail": "", **counts})
    cells, done = pd.concat(rows, ignore_index=True), pd.DataFrame(runs)
    tables = {number: whole(m, number) for number in asked}
    return Outcomes(*(pa.Table.from_pandas(table, preserve_index=False) for table in (cells, done)), tables)


def written(patch):
    """Figures that are written nowhere but in name, by the name of their file; studies that wait for no disk."""
    found = {}

    def note(figure, path):
        Path(path).touch()
        found[Path(path).name] = figure

    patch.setattr("tissue.study.figures.catalogue.write", note)
    return found


def made(names, home, trajectories=(0, 1), runs=8):
    """Results of studies that come with the package, of few runs and output times."""
    for name in names:
        study = load_study(name)
        scenarios = {key: parameters.changed(SHORT) for key, parameters in study.scenarios.items()}
        short = replace(study, replicates=RUNS.get(name, runs), scenarios=scenarios, trajectories=trajectories)
        carry_out(short, Path(home) / name)


def last(cells, what="basal"):
    return {"basal": cells["ab_48h"] < 0, "apical": cells["ab_48h"] > 1, "below": cells["below_48h"]}[what]


def expected(cells, what="basal"):
    """The ratio at the end [%], and the ends of its interval."""
    one = ratio(last(cells, what), cells["replicate"])
    return [100 * value for value in (one.value, *one.interval())]


def caption(figure):
    return figure.get_supxlabel().replace("\n", " ").replace("\N{NO-BREAK SPACE}", " ")


def coloured(panel, colour):
    (line,) = (line for line in panel.lines if line.get_color() == colour)
    return line


def dots(panel):
    """Of each series of marks with intervals: its height, value and the ends of the interval, and colour, of each."""
    found = []
    for container in panel.containers:
        marks, _, (whiskers,) = container.lines
        ends = [segment[:, 0].tolist() for segment in whiskers.get_segments()]
        places = zip(marks.get_xdata(), marks.get_ydata(), ends, strict=True)
        found.append([(float(y), float(x), *interval, to_hex(marks.get_color())) for x, y, interval in places])
    return found
