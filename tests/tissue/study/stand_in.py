"""A study that takes no time: outcomes that are a function of (parameters, seed), as those of the simulation are."""

from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa

import tissue
from tissue.study.outcomes import Outcomes

# Its two scenarios have parts of 32 runs: three with 70 replicates.
STUDY = """
title = "small"
base = "thesis"
replicates = {replicates}
seed = 7
trajectories = [2, 33]
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


def outcomes(parameters, replicates, seeds, whole=()):
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
    seed_of = dict(zip(replicates, seeds, strict=True))
    tables = {number: pd.DataFrame({"time_h": [0.0, 1.0], "y_ab": seed_of[number] % 97}) for number in whole}
    return Outcomes(pa.table(cells), pa.table(runs), tables)


def stored(folder):
    """The contents of all tables in a folder."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(Path(folder).glob("*/*/*"))}
