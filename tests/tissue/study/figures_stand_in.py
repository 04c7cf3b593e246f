"""A study of two factors, and outcomes that take no time: all columns, of random numbers."""

from functools import lru_cache

import numpy as np
import pandas as pd
import pyarrow as pa

from tissue.events.known import row
from tissue.files.groups import drawn
from tissue.files.parameters import preset
from tissue.runs.simulate import simulate
from tissue.study.outcomes import Outcomes

HEAD = """
title = "Does the time matter, and more inside?"
base = "thesis"
replicates = 40
seed = 3
[overrides.numerics]
keep = "24 h"
[overrides.emt]
cells = 5
"""
FACTORS = """
[factors.time]
late = { emt.a = "18 h" }
early = { emt.a = "6 h" }
[factors.shape]
line = {}
arc = { layer = { shape = "circle", perimeter = "400 um" } }
"""
COMPARE = """
[compare]
outcomes = ["basal", "controls_apical"]
measures = ["difference", "ratio"]
effect = "time"
by = "shape"
"""
INTERACTION = "(early - late, arc) - (early - late, line)"


def write(text, path="study.toml"):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path


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
        at, inm = drawn(parameters.groups()[0], rng)
        began = {f"t_{name}_h": at[row(name)] for name in "absp"}
        onset = at.min(axis=0)
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
        runs.append({"replicate": replicate, "seed": seed, "status": "SUCCESS", "detail": "", "folded": "no", **counts})
    cells, done = pd.concat(rows, ignore_index=True), pd.DataFrame(runs)
    tables = {number: whole(m, number) for number in asked}
    return Outcomes(*(pa.Table.from_pandas(table, preserve_index=False) for table in (cells, done)), tables)
