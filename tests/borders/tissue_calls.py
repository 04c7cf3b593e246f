"""The public functions and constructors of tissue, with values that are right; tiny tissues, their runs and states.

Calls write files into the present folder. What they register is taken off the registry again.
"""

import atexit
import shutil
import tempfile
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

import tissue
from tests.borders import tissue_functions as own
from tests.borders.harness import calls
from tests.borders.values import ABSURD
from tests.tissue.users import shelves
from tissue.files.keys import all_keys
from tissue.files.parameter_files import flat
from tissue.study.read import Results

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
THING = tissue.Force("mine", own.push, "mine")


def registered(thing, other=THING):
    """What ``register`` does, for this call alone."""
    with shelves():
        tissue.register(thing, other)


def changed(changes, seed):
    """A run with other values of some keys."""
    return simulated(EMT.changed(changes), seed)


def forms(changes):
    """Parameters with other values of some keys, in all forms."""
    found = TYPES.changed(changes)
    return found.as_toml(), found.as_dict(), found.numbers(), found.start_numbers(), found.curve(), found.groups()


def simulated(parameters, seed):
    """A run and its tables."""
    run = tissue.simulate(parameters, seed, throw=False)
    if run.summary()["folded"].ne("no").any():  # which is why heights and positions are missing
        run = replace(run, parameters=run.parameters.changed({"numerics.folded": "keep"}))
    return (
        run,
        run.table().select_dtypes(float).to_numpy(),
        run.summary().select_dtypes("number").to_numpy(float),
        repr(run),
    )


def pushed(push, energy, strength, seed):
    """A run with a force of the user."""
    with shelves():
        tissue.register(tissue.Force("generated", push, "generated", energy=energy))
        return simulated(SMALL.changed({"forces.generated": strength}), seed)


def begun(begin, last, after, time, seed):
    """A run with an event of the user."""
    with shelves():
        tissue.register(tissue.EmtEvent("generated", "generated", "a test", begin, last, after))
        return simulated(EMT.changed({"emt.generated": time}), seed)


def divided(splits, place, seed):
    """A run with a rule of divisions of the user."""
    with shelves():
        tissue.register(tissue.DivisionRule("generated", "generated", "a test", splits, place))
        return simulated(QUICK.changed({"division.rule": "generated"}), seed)


def measured(measure, unit, seed):
    """A run with an observable of the user."""
    with shelves():
        tissue.register(tissue.Observable("generated", "generated", measure, unit))
        return simulated(SMALL, seed)


def built(t, cells, layers, curve, checkpoint):
    """A run from a frame of the user's own, and that frame in a file."""
    frame = tissue.Frame(t, cells, layers, curve, checkpoint)
    frame.save("built.npz")
    return resumed(LONGER, frame)


def altered(name, value):
    """A run from a state in which the user has replaced an array of the cells."""
    return resumed(LONGER, FRAMES[3]._replace(cells=FRAMES[3].cells._replace(**{name: value})))


def resumed(parameters, start):
    """A run from a state, and its tables."""
    run = tissue.simulate(parameters, 1, start, throw=False)
    return run, run.summary().select_dtypes("number").to_numpy(float)


def studied(study, out, executor):
    """A study, of which the folder is there already."""
    return tissue.run_study(study, out, executor).complete


def plotted(ax=None, t=None):
    """A picture is made, and thrown away."""
    RUNS[1].plot(ax, t=t)


def animated(file):
    """A movie of two states."""
    RUNS[1].animate(file)


KEYS = tuple(all_keys(tissue.Parameters))
PRESENT = flat(SMALL.as_dict())
VALUES = tuple({repr(value): value for value in PRESENT.values()}.values())
VALUES += (
    "0.2 h",
    "3 um",
    "0.5 R_soft",
    "-1 um",
    "0 h",
    "1e-300 h",
    "1e300 um",
    "7 parsec",
    "never",
    "50 %",
    3,
    0,
    0.5,
)


def varied(rng, number):
    """Changes of one or two keys, to values that may be right or absurd."""
    made = []
    for _ in range(number):
        pool = VALUES if rng.random() < 0.7 else ABSURD
        keys = rng.choice(len(KEYS), rng.integers(1, 3), replace=False)
        made.append({KEYS[key]: pool[rng.integers(len(pool))] for key in keys})
    return tuple(made)


CHANGES = varied(np.random.default_rng(0), 2000)
THINGS = (
    THING,
    tissue.EmtEvent("mine", "mine", "a test", own.begin, own.last, "b"),
    tissue.Observable("mine", "mine", own.measure),
    tissue.DivisionRule("mine", "mine", "a test", own.splits, own.place),
)
# Right values by the names of arguments; some functions have others.
POOL = {"parameters": PARAMETERS, "changes": CHANGES, "seed": (0, 1), "seeds": ([0], (1, 2), range(3), [5, -1])}
POOL |= {"throw": (True, False), "watch": (None, lambda t: t), "strength": (0, 0.5, 1, 1e5), "t": (None, 0.2, 0)}
POOL |= {"start": (None, FRAMES[1], [FRAMES[0]], FRAMES[:2]), "push": own.PUSHES, "energy": own.ENERGIES}
POOL |= {"begin": own.BEGINS, "last": own.LASTS, "measure": own.MEASURES, "splits": own.SPLITS, "place": own.PLACES}
POOL |= {"after": (None, "a", "b"), "unit": ("", "um", "h")}
POOL |= {"time": ("0.1 h", "0.1 h to 0.3 h", "0.2 h, 50 %", "never"), "name": ("generated", "x2")}
POOL |= {"meaning": ("what it means", ""), "source": ("what it means", ""), "thing": THINGS, "other": THINGS}
POOL |= {"force": THINGS[:1], "run": RUNS, "ax": (None,), "study": (FOLDER / "study.toml",)}
POOL |= {"out": (FOLDER / "results",), "executor": (None,), "scenario": ("B", "AB"), "outcome": ("basal", "height_um")}
POOL |= {"path": ("built.npz", FOLDER / "again.npz", FOLDER / "no" / "folder.npz", FOLDER)}
POOL |= {"file": ("run.gif", FOLDER / "run.webp", "run.txt", FOLDER)}
POOL |= {"folder": (FOLDER / "results", str(FOLDER / "results"), FOLDER)}
POOL |= {"cells": tuple(frame.cells for frame in FRAMES), "layers": tuple(frame.layers for frame in FRAMES)}
POOL |= {"curve": (FRAMES[0].curve, TUBE.curve()), "checkpoint": (FRAMES[0].checkpoint, FRAMES[3].checkpoint, None)}
ARRAYS = ("x", "id", "divides", "emt", "radius")
REPLACED = {"value": tuple(getattr(FRAMES[3].cells, name) for name in ARRAYS)}
CALLS = calls(
    POOL,
    (tissue.preset, {"name": ("published", "thesis", "chick")}),
    (tissue.load, {"path": tuple(FOLDER / name for name in FILES)}),
    (SMALL.changed, {"changes": ({}, TINY, {"types.soft.cells": 2}, {"no.key": 1}, {1: 2}, [("a", 1)])}),
    *(changed, forms, (tissue.simulate, {"start": (None, *FRAMES)}), tissue.simulate_many),
    (tissue.Frame.load, {"path": (FOLDER / "kept.npz", FOLDER / "damaged.npz", FOLDER / "small.toml")}),
    *(RUNS[0].final.save, (built, {"t": (0.0, 0.4)})),
    *((partial(altered, name), REPLACED) for name in ARRAYS),
    *(tissue.Force, tissue.EmtEvent, tissue.Observable, tissue.DivisionRule, registered),
    *(pushed, begun, divided, measured, tissue.force_error, studied, Results),
    (RESULTS.cells, {"columns": (["replicate"], None, ("cell", "inm"))}),
    (RESULTS.runs, {"columns": (["seed"], None)}),
    *(RESULTS.values, RESULTS.parameters, plotted, animated),
)
