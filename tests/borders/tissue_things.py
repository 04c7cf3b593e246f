"""What generated calls of tissue are made with: tiny tissues, their runs and states, and a study of two scenarios."""

import atexit
import shutil
import tempfile
from pathlib import Path

import tissue

FOLDER = Path(tempfile.mkdtemp())
atexit.register(shutil.rmtree, FOLDER, ignore_errors=True)

TINY = {"tissue.cells": 8, "numerics.t_end": "0.4 h", "numerics.dt": "0.1 h", "numerics.keep": "0.2 h"}
TINY |= {"numerics.substeps": 12, "numerics.mu": "0.15 h"}
SMALL = tissue.preset("published").changed(TINY)
EMT = SMALL.changed({"emt.cells": 2, "emt.a": "0.1 h", "emt.b": "0.1 h to 0.3 h", "emt.p": "0.2 h, 50 %"})
TYPES = SMALL.changed({"types.soft.cells": 2, "types.soft.alpha_ax": 0.5, "types.soft.place": 0.3})
TUBE = {"layer.shape": "circle", "layer.perimeter": "400 um", "layer.closed": True, "layer.side": "outside"}
TUBE = SMALL.changed({**TUBE, "tissue.cells": 241, "numerics.t_end": "0.1 h", "numerics.keep": "0.1 h"})
LONGER = EMT.changed({"numerics.t_end": "0.6 h"})
QUIET = SMALL.changed({"numerics.noise": "step", "daha.most_iterations": 200, "numerics.t_end": "0.1 h"})
QUICK = SMALL.changed({"cell.min_cycle": "2 h", "cell.max_cycle": "3 h", "numerics.t_end": "1 h"})
PARAMETERS = (SMALL, EMT, TYPES, LONGER, QUICK)
RUNS = tuple(tissue.simulate(one, 1) for one in (SMALL, EMT, TYPES))
FRAMES = tuple(frame for run in RUNS for frame in (run.frames[0], run.final))

STUDY = """title = "tiny"
base = "small.toml"
replicates = 2
seed = 1
[overrides.emt]
cells = 1
b = "0.1 h"
[scenarios.B]
[scenarios.AB]
emt.a = "0.1 h"
"""
FILES = {"small.toml": SMALL.as_toml(), "based.toml": 'base = "small.toml"\n', "study.toml": STUDY}
FILES |= {"bad.toml": "[tissue", "empty.toml": "", "absurd.toml": 'base = "small.toml"\ntissue.cells = "many"\n'}
for name, content in FILES.items():
    (FOLDER / name).write_text(content, "utf-8")
RUNS[0].final.save(FOLDER / "kept.npz")
(FOLDER / "damaged.npz").write_bytes((FOLDER / "kept.npz").read_bytes()[:900])
RESULTS = tissue.run_study(FOLDER / "study.toml", FOLDER / "results")
