"""A study that takes no time: outcomes that are a function of (parameters, seed), as those of the simulation are."""

import threading
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa

import tissue
import tissue.study.outcomes
from tissue.study.outcomes import Outcomes

STUDY = """
title = "small"
base = "thesis"
replicates = {replicates}
seed = 7
trajectories = [2, 129]
[overrides.emt]
cells = 2
[scenarios."[A]"]
emt.a = "12 h"
[scenarios."[A] no INM"]
emt = {{ a = "12 h", inm = 0 }}
"""


def study_file(folder, replicates=300):
    """Write a study of six pieces."""
    path = Path(folder) / "small.toml"
    path.write_text(STUDY.format(replicates=replicates), "utf-8")
    return path


def run():
    """Run the study of the folder, or continue it."""
    return tissue.run_study("small.toml", "out")


def outcomes(parameters, replicates, seeds, whole=()):
    """Random numbers; every 50th run fails."""
    draws = [np.random.default_rng(seed).random(3) for seed in seeds]
    failed = [number % 50 == 49 for number in replicates]
    runs = {
        "replicate": replicates,
        "seed": seeds,
        "status": pa.array(["NON_FINITE" if bad else "SUCCESS" for bad in failed]).dictionary_encode(),
        "detail": ["lost" if bad else "" for bad in failed],
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


def _slow(*args):
    threading.Event().wait(0.1)
    return outcomes(*args)


def use_stand_in():
    """In another process: a simulation that takes a while."""
    tissue.study.outcomes.outcomes = _slow


def stored(folder):
    """The contents of all tables in a folder, and of the notes that they are there."""
    files = [path for path in sorted(Path(folder).glob("*/*/*")) if not path.name.startswith("_damaged-")]
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}
