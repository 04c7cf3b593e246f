"""The public functions and constructors of tissue, with values that are right.

Calls write files into the present folder. What they register is taken off the shelves again.
"""

import atexit
import shutil
import tempfile
from contextlib import contextmanager
from pathlib import Path

import dincl
import tissue
from tests.borders import tissue_functions as own
from tests.borders.harness import Call
from tissue.files.keys import all_keys
from tissue.files.parameter_files import flat
from tissue.pictures.picture import picture
from tissue.quasi_steady.daha import TissueArrowHurwicz
from tissue.quasi_steady.frozen import frozen_problem, made_feasible
from tissue.quasi_steady.minimiser import Judge
from tissue.quasi_steady.run import simulate_quasi_steady
from tissue.registration import KINDS
from tissue.registry import shelf
from tissue.study.answers import control_shares, scenario_changes, scenario_differences, scenario_ratios
from tissue.study.curves import over_time
from tissue.study.ratios import ratio, wilson
from tissue.study.read import Results

FOLDER = Path(tempfile.mkdtemp())
atexit.register(shutil.rmtree, FOLDER, ignore_errors=True)

TINY = {"tissue.cells": 8, "numerics.t_end": "0.4 h", "numerics.dt": "0.1 h", "numerics.keep": "0.2 h"}
TINY |= {"numerics.substeps": 5, "numerics.mu": "0.15 h"}
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
QUASI = simulate_quasi_steady(QUIET, 1, throw=False)
FRAMES = tuple(frame for run in RUNS for frame in (run.frames[0], run.final))
STATES = tuple(frame for frame in FRAMES if not frame.cells.events.any())

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
RATIOS = scenario_ratios(RESULTS)


THING = tissue.Force("mine", own.push, "mine")


@contextmanager
def shelves():
    """What is registered inside is gone behind it."""
    before = {kind: dict(shelf(kind)) for kind in KINDS}
    try:
        yield
    finally:
        for kind, things in before.items():
            shelf(kind).clear()
            shelf(kind).update(things)


def registered(thing, other=THING):
    """What ``register`` does, for this call alone."""
    with shelves():
        tissue.register(thing, other)


def changed(parameters, key, value, seed):
    """A run with another value of one key."""
    return simulated(parameters.changed({key: value}), seed)


def two_changed(parameters, key, value, other, further):
    """Parameters with other values of two keys, in all forms."""
    found = parameters.changed({key: value, other: further})
    return found.as_toml(), found.as_dict(), found.numbers(), found.start_numbers(), found.curve(), found.groups()


def simulated(parameters, seed):
    """A run and its tables."""
    run = tissue.simulate(parameters, seed, throw=False)
    return run, run.table().select_dtypes(float).to_numpy(), run.summary().to_numpy(float), repr(run)


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


def slopes(push, energy, run, strength):
    """The test of a force that is not registered."""
    return tissue.force_error(tissue.Force("generated", push, "generated", energy=energy), run, strength)


def built(t, cells, layers, curve, checkpoint, parameters):
    """A run from a frame of the user's own, and that frame in a file."""
    frame = tissue.Frame(t, cells, layers, curve, checkpoint)
    frame.save("built.npz")
    return simulated_from(parameters, frame, 1)


def altered(frame, array, value, parameters):
    """A run from a state in which the user has replaced an array of the cells."""
    return simulated_from(parameters, frame._replace(cells=frame.cells._replace(**{array: value})), 1)


def simulated_from(parameters, start, seed):
    """A run from a state, and its tables."""
    run = tissue.simulate(parameters, seed, start, throw=False)
    return run, run.summary().to_numpy(float)


def frozen(frame, parameters, scheme):
    """A frozen tissue, its forces, and a step of a scheme."""
    cells, layers, numbers = frame.cells, frame.layers, parameters.numbers()
    cells = made_feasible(cells, layers, numbers, dincl.GaussSeidel(1e-6))
    problem = frozen_problem(cells, layers, numbers)
    return dincl.solve(problem, scheme, [1e-3], throw=False)


def minimised(minimiser, frame, parameters):
    """What a minimiser of the quasi-steady model finds."""
    return minimiser.minimise(frame.cells, frame.layers, parameters.numbers())


def arrow_hurwicz(numbers):
    """DAHA with numbers of the user's own."""
    return TissueArrowHurwicz(numbers).minimise(FRAMES[0].cells, FRAMES[0].layers, SMALL.numbers())


def studied(study, out, executor):
    """A study, of which the folder is there already."""
    return tissue.run_study(study, out, executor).complete


def answers(results):
    """All that is asked of a study's results."""
    scenario_changes(results)
    return scenario_ratios(results).to_numpy(), control_shares(results).to_numpy()


def plotted(run, ax=None, t=None):
    """A picture is made, and thrown away."""
    run.plot(ax, t=t)


def animated(file):
    """A movie of two states."""
    RUNS[1].animate(file)


def results_plotted(scenario):
    """A chart is made, and thrown away."""
    RESULTS.plot(scenario=scenario)


KEYS = tuple(all_keys(tissue.Parameters))
PRESENT = flat(SMALL.as_dict())
VALUES = tuple({repr(value): value for value in PRESENT.values()}.values())
VALUES += ("0.2 h", "3 um", "0.5 R_soft", "-1 um", "0 h", "1e-300 h", "1e300 um", "7 parsec", "never", "50 %", 3, 0, 0.5)
SEEDS, FLAG, STRENGTH = (0, 1, 2**70), (True, False), (0, 0.5, 1, 1e5)
TIMES = ("0.1 h", "0.1 h to 0.3 h", "0.2 h, 50 %", "never")
PATHS = ("built.npz", FOLDER / "again.npz", FOLDER / "no" / "folder.npz", FOLDER)
SCHEMES = (dincl.PBD(1e-3), dincl.Penalty(1e-3, 1.0), dincl.CatchUp(1e-3, dincl.GaussSeidel(1e-6)))
NAMES, TEXTS = ("generated", "my_force", "x2"), ("what it means", "")
AFTER, UNITS, COLUMNS = (None, "a", "b", "generated"), ("", "um", "h"), (["replicate"], None, ("cell", "inm"))
CELLS, LAYERS = tuple(frame.cells for frame in FRAMES), tuple(frame.layers for frame in FRAMES)
ARRAYS = tuple(FRAMES[0].cells._fields)
REPLACED = tuple(getattr(FRAMES[1].cells, name) for name in ("x", "id", "divides", "radius"))
THINGS = (
    THING,
    tissue.EmtEvent("mine", "mine", "a test", own.begin, own.last, "b"),
    tissue.Observable("mine", "mine", own.measure),
    tissue.DivisionRule("mine", "mine", "a test", own.splits, own.place),
)
SCENARIOS, LEVELS = ("B", "AB"), (0.95, 0.5)
EMT_CELLS = RESULTS.cells("AB")
HITS = EMT_CELLS["extruded"] == "no"
CALLS = (
    Call("preset", tissue.preset, {"name": ("published", "thesis", "chick")}),
    Call("load", tissue.load, {"path": tuple(FOLDER / name for name in FILES)}),
    Call("Parameters", tissue.Parameters.model_validate, {"obj": (SMALL.as_dict(), EMT.as_dict())}),
    Call("changes", SMALL.changed, {"changes": ({}, TINY, {"types.soft.cells": 2}, {"no.key": 1}, {1: 2}, [("a", 1)])}),
    Call("changed", changed, {"parameters": PARAMETERS, "key": KEYS, "value": VALUES, "seed": SEEDS}),
    Call(
        "two changed",
        two_changed,
        {"parameters": PARAMETERS, "key": KEYS, "value": VALUES, "other": KEYS, "further": VALUES},
    ),
    Call(
        "simulate",
        tissue.simulate,
        {"parameters": PARAMETERS, "seed": SEEDS, "start": (None, *FRAMES), "throw": FLAG, "watch": (None, lambda t: t)},
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
    Call(
        "minimised",
        minimised,
        {
            "minimiser": (Judge(1e-6), TissueArrowHurwicz(QUIET.daha_numbers())),
            "frame": FRAMES[:1],
            "parameters": (SMALL,),
        },
    ),
    Call(
        "frozen_problem",
        frozen_problem,
        {"cells": CELLS, "layers": LAYERS, "numbers": (SMALL.numbers(), EMT.numbers()._replace(mu=0.1))},
    ),
    Call("frozen", frozen, {"frame": FRAMES, "parameters": PARAMETERS, "scheme": SCHEMES}),
    Call("Frame.load", tissue.Frame.load, {"path": (FOLDER / "kept.npz", FOLDER / "damaged.npz", FOLDER / "small.toml")}),
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
            "parameters": PARAMETERS[:2],
        },
    ),
    Call("altered", altered, {"frame": FRAMES, "array": ARRAYS, "value": REPLACED, "parameters": (LONGER, SMALL, TYPES)}),
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
    Call("Results.parameters", RESULTS.parameters, {"scenario": SCENARIOS}),
    Call("Results.trajectory", RESULTS.trajectory, {"scenario": SCENARIOS, "replicate": (0, 1)}),
    Call("answers", answers, {"results": (RESULTS,)}),
    Call("scenario_differences", scenario_differences, {"ratios": (RATIOS,), "replicates": (2, 32)}),
    Call("Run.plot", plotted, {"run": RUNS, "ax": (None,), "t": (None, 0.2, 0)}, ("ax", "t")),
    Call("Run.animate", animated, {"file": ("run.gif", FOLDER / "run.webp", "run.txt", FOLDER)}),
    Call(
        "picture",
        picture,
        {"frames": (FRAMES[:1], list(FRAMES[1:2])), "parameters": PARAMETERS[1:2], "path": ("a.png", FOLDER / "b.svg")},
    ),
    Call("Results.plot", results_plotted, {"scenario": SCENARIOS}),
    Call("over_time", over_time, {"cells": (EMT_CELLS,), "rule": ("thesis", "published"), "level": LEVELS}, ("rule",)),
    Call("ratio", ratio, {"hits": (HITS,), "replicate": (EMT_CELLS["replicate"],)}),
    Call("wilson", wilson, {"value": (0.5, [0.0, 1.0]), "size": (10, [3, 4]), "level": LEVELS}, ("level",)),
)
