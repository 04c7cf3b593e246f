"""The public functions and constructors of tissue, with values that are right.

Calls write files into the present folder. What they register is taken off the shelves again.
"""

from functools import partial

import numpy as np

import dincl
import tissue
from tests.borders import tissue_functions as own
from tests.borders.harness import Call
from tests.borders.tissue_things import (
    EMT,
    FILES,
    FOLDER,
    FRAMES,
    PARAMETERS,
    QUIET,
    RESULTS,
    RUNS,
    SMALL,
    TINY,
    TUBE,
)
from tests.borders.tissue_uses import (
    THING,
    altered,
    animated,
    answers,
    arrow_hurwicz,
    begun,
    built,
    changed,
    divided,
    forms,
    frozen,
    measured,
    plotted,
    pushed,
    registered,
    slopes,
    studied,
)
from tests.borders.values import ABSURD
from tissue.files.keys import all_keys
from tissue.files.parameter_files import flat
from tissue.study.read import Results
from verification.thesis.quasi_steady.daha import TissueArrowHurwicz
from verification.thesis.quasi_steady.frozen import frozen_problem
from verification.thesis.quasi_steady.minimiser import Judge
from verification.thesis.quasi_steady.run import simulate_quasi_steady

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
SEEDS, FLAG, STRENGTH = (0, 1), (True, False), (0, 0.5, 1, 1e5)
TIMES = ("0.1 h", "0.1 h to 0.3 h", "0.2 h, 50 %", "never")
PATHS = ("built.npz", FOLDER / "again.npz", FOLDER / "no" / "folder.npz", FOLDER)
SCHEMES = (dincl.PBD(1e-3), dincl.Penalty(1e-3, 1.0), dincl.CatchUp(1e-3, dincl.Daqp(1e-6)))
NAMES, TEXTS = ("generated", "my_force", "x2"), ("what it means", "")
AFTER, UNITS, COLUMNS = (None, "a", "b", "generated"), ("", "um", "h"), (["replicate"], None, ("cell", "inm"))
CELLS, LAYERS = tuple(frame.cells for frame in FRAMES), tuple(frame.layers for frame in FRAMES)
REPLACED = tuple(getattr(FRAMES[3].cells, name) for name in ("x", "id", "divides", "emt", "radius"))
THINGS = (
    THING,
    tissue.EmtEvent("mine", "mine", "a test", own.begin, own.last, "b"),
    tissue.Observable("mine", "mine", own.measure),
    tissue.DivisionRule("mine", "mine", "a test", own.splits, own.place),
)
SCENARIOS = ("B", "AB")
CALLS = (
    Call("preset", tissue.preset, {"name": ("published", "thesis", "chick")}),
    Call("load", tissue.load, {"path": tuple(FOLDER / name for name in FILES)}),
    Call("changes", SMALL.changed, {"changes": ({}, TINY, {"types.soft.cells": 2}, {"no.key": 1}, {1: 2}, [("a", 1)])}),
    Call("changed", changed, {"changes": CHANGES, "seed": SEEDS}),
    Call("forms", forms, {"changes": CHANGES}),
    Call(
        "simulate",
        tissue.simulate,
        {
            "parameters": PARAMETERS,
            "seed": SEEDS,
            "start": (None, *FRAMES),
            "throw": FLAG,
            "watch": (None, lambda t: t),
        },
        ("seed", "start", "throw", "watch"),
    ),
    Call(
        "simulate_many",
        tissue.simulate_many,
        {
            "parameters": PARAMETERS,
            "seeds": ([0], (1, 2), range(3), [5, -1]),
            "start": (None, FRAMES[1], [FRAMES[0]], FRAMES[:2]),
            "throw": FLAG,
        },
        ("start", "throw"),
    ),
    Call(
        "quasi-steady",
        simulate_quasi_steady,
        {
            "parameters": (QUIET, *PARAMETERS),
            "seed": SEEDS,
            "minimiser": (None, Judge(1e-6), TissueArrowHurwicz(QUIET.daha_numbers())),
            "throw": FLAG,
            "watch": (None, lambda t: t),
        },
        ("seed", "minimiser", "throw", "watch"),
    ),
    Call("Judge", Judge, {"tol": (1e-6, 1)}),
    Call("DAHA", arrow_hurwicz, {"numbers": (QUIET.daha_numbers(), QUIET.daha_numbers()._replace(eps=0.1))}),
    *(
        Call(
            type(one).__name__, one.minimise, {"cells": CELLS[:1], "layers": LAYERS[:1], "numbers": (SMALL.numbers(),)}
        )
        for one in (Judge(1e-6), TissueArrowHurwicz(QUIET.daha_numbers()))
    ),
    Call(
        "frozen_problem",
        frozen_problem,
        {"cells": CELLS, "layers": LAYERS, "numbers": (SMALL.numbers(), EMT.numbers()._replace(mu=0.1))},
    ),
    Call("frozen", frozen, {"cells": CELLS, "layers": LAYERS, "numbers": (SMALL.numbers(),), "scheme": SCHEMES}),
    Call(
        "Frame.load", tissue.Frame.load, {"path": (FOLDER / "kept.npz", FOLDER / "damaged.npz", FOLDER / "small.toml")}
    ),
    Call("Frame.save", RUNS[0].final.save, {"path": PATHS}),
    Call(
        "built",
        built,
        {
            "t": (0.0, 0.4),
            "cells": CELLS,
            "layers": LAYERS,
            "curve": (FRAMES[0].curve, TUBE.curve()),
            "checkpoint": (FRAMES[0].checkpoint, FRAMES[3].checkpoint, None),
        },
    ),
    *(Call("altered", partial(altered, name), {"value": REPLACED}) for name in ("x", "id", "divides", "emt", "radius")),
    Call(
        "Force",
        tissue.Force,
        {"name": NAMES, "push": own.PUSHES, "meaning": TEXTS, "source": TEXTS, "energy": own.ENERGIES},
        ("source", "energy"),
    ),
    Call(
        "EmtEvent",
        tissue.EmtEvent,
        {
            "name": NAMES[::2],
            "meaning": TEXTS,
            "source": TEXTS,
            "begin": own.BEGINS,
            "last": own.LASTS,
            "after": AFTER,
        },
        ("begin", "last", "after"),
    ),
    Call(
        "Observable",
        tissue.Observable,
        {"name": NAMES, "meaning": TEXTS, "measure": own.MEASURES, "unit": UNITS},
        ("unit",),
    ),
    Call(
        "DivisionRule",
        tissue.DivisionRule,
        {"name": NAMES, "meaning": TEXTS, "source": TEXTS, "splits": own.SPLITS, "place": own.PLACES},
    ),
    Call("register", registered, {"thing": THINGS, "other": THINGS}, ("other",)),
    Call("pushed", pushed, {"push": own.PUSHES, "energy": own.ENERGIES, "strength": STRENGTH, "seed": SEEDS}),
    Call(
        "begun",
        begun,
        {"begin": own.BEGINS, "last": own.LASTS, "after": AFTER[:3], "time": TIMES, "seed": SEEDS},
    ),
    Call("divided", divided, {"splits": own.SPLITS, "place": own.PLACES, "seed": SEEDS}),
    Call("measured", measured, {"measure": own.MEASURES, "unit": UNITS, "seed": SEEDS}),
    Call("force_error", tissue.force_error, {"force": THINGS[:1], "run": RUNS, "strength": STRENGTH}, ("strength",)),
    Call("slopes", slopes, {"push": own.PUSHES, "energy": own.ENERGIES, "run": RUNS, "strength": STRENGTH}),
    Call(
        "run_study",
        studied,
        {"study": (FOLDER / "study.toml",), "out": (FOLDER / "results",), "executor": (None,)},
    ),
    Call("Results", Results, {"folder": (FOLDER / "results", str(FOLDER / "results"), FOLDER)}),
    Call("Results.cells", RESULTS.cells, {"scenario": SCENARIOS, "columns": COLUMNS}, ("columns",)),
    Call("Results.runs", RESULTS.runs, {"scenario": SCENARIOS, "columns": (["seed"], None)}, ("columns",)),
    Call("Results.values", RESULTS.values, {"scenario": SCENARIOS, "outcome": ("basal", "height_um")}),
    Call("Results.parameters", RESULTS.parameters, {"scenario": SCENARIOS}),
    Call("Results.trajectory", RESULTS.trajectory, {"scenario": SCENARIOS, "replicate": (0, 1)}),
    Call("answers", answers, {"results": (RESULTS,)}),
    Call("Run.plot", plotted, {"ax": (None,), "t": (None, 0.2, 0)}, ("ax", "t")),
    Call("Run.animate", animated, {"file": ("run.gif", FOLDER / "run.webp", "run.txt", FOLDER)}),
)
