"""What users do with tissue in more than one call; what they register is taken off the shelves again."""

from contextlib import contextmanager
from dataclasses import replace

import dincl
import tissue
from tests.borders import tissue_functions as own
from tests.borders.tissue_things import (
    EMT,
    FRAMES,
    LONGER,
    QUICK,
    RUNS,
    SMALL,
    TYPES,
)
from tissue.plugins import registry
from tissue.runs.registration import KINDS
from tissue.study.answers import answer_table, scenario_changes, scenario_means
from verification.thesis.quasi_steady.daha import TissueArrowHurwicz
from verification.thesis.quasi_steady.frozen import frozen_problem, made_feasible

PROJECTION = dincl.ActiveSet(1e-9)
THING = tissue.Force("mine", own.push, "mine")


@contextmanager
def shelves():
    """What is registered inside is gone behind it."""
    before = {kind: dict(registry(kind)) for kind in KINDS}
    try:
        yield
    finally:
        for kind, things in before.items():
            registry(kind).clear()
            registry(kind).update(things)


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


def slopes(push, energy, run, strength):
    """The test of a force that is not registered."""
    return tissue.force_error(tissue.Force("generated", push, "generated", energy=energy), run, strength)


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


def frozen(cells, layers, numbers, scheme):
    """A frozen tissue, made feasible, and a step of a scheme."""
    cells = made_feasible(cells, layers, numbers, PROJECTION)
    return dincl.solve(frozen_problem(cells, layers, numbers), scheme, [1e-3], throw=False)


def arrow_hurwicz(numbers):
    """DAHA with numbers of the user's own."""
    return TissueArrowHurwicz(numbers).minimise(FRAMES[0].cells, FRAMES[0].layers, SMALL.numbers())


def studied(study, out, executor):
    """A study, of which the folder is there already."""
    return tissue.run_study(study, out, executor).complete


def answers(results):
    """All that is asked of a study's results."""
    scenario_changes(results)
    return scenario_means(results).to_numpy(), answer_table(results)["p"].to_numpy()


def plotted(ax=None, t=None):
    """A picture is made, and thrown away."""
    RUNS[1].plot(ax, t=t)


def animated(file):
    """A movie of two states."""
    RUNS[1].animate(file)
