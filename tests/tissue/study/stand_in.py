"""Studies that take no time: outcomes that are a function of (parameters, seed), as those of the simulation are."""

from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa

import tissue
from tissue.events.known import row
from tissue.files.groups import drawn
from tissue.study.outcomes import Outcomes

# Its two scenarios have parts of 32 runs: three with 70 replicates.
STUDY = """
title = "small"
base = "thesis"
replicates = {replicates}
seed = 7
[overrides.emt]
cells = 2
[scenarios."[A]"]
emt.a = "12 h"
[scenarios."[A] no INM"]
emt = {{ a = "12 h", inm = 0 }}
"""


def study_file(folder, replicates=70):
    """Write the study."""
    path = Path(folder) / "small.toml"
    path.write_text(STUDY.format(replicates=replicates), "utf-8")
    return path


def run(**options):
    """Run the study of the folder, or continue it."""
    return tissue.run_study("small.toml", "out", **options)


def outcomes(parameters, replicates, seeds):
    """Random numbers; every 50th run fails."""
    draws = [np.random.default_rng(seed).random(3) for seed in seeds]
    failed = [number % 50 == 49 for number in replicates]
    runs = {
        "replicate": replicates,
        "seed": seeds,
        "status": pa.array(["NON_FINITE" if bad else "SUCCESS" for bad in failed]).dictionary_encode(),
        "detail": ["lost" if bad else "" for bad in failed],
        "folded": ["no" for _ in failed],
        "controls_0h": pa.array([None if bad else 58 for bad in failed], pa.int64()),
    }
    sound = [(number, draw) for number, draw, bad in zip(replicates, draws, failed, strict=True) if not bad]
    cells = {
        "replicate": [number for number, _ in sound for _ in range(2)],
        "cell": [cell for _ in sound for cell in range(2)],
        "extruded": pa.array(["basal" if x[0] < 0.5 else "no" for _, x in sound for _ in range(2)]).dictionary_encode(),
        "ab_0h": [parameters.emt.inm + draw[1 + cell] for _, draw in sound for cell in range(2)],
    }
    return Outcomes(pa.table(cells), pa.table(runs))


def stored(folder):
    """The contents of all tables in a folder."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(Path(folder).glob("*/*/*"))}


# Two factors, with all columns

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


def random_outcomes(parameters, replicates, seeds):
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
    return Outcomes(*(pa.Table.from_pandas(table, preserve_index=False) for table in (cells, done)))
