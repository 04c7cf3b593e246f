"""What holds of a run of any tissue: alone, in company, in threads and from each saved state it has the same bits."""

import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from dincl.errors import InvalidProblem
from dincl.status import Status
from tests.tissue.bits import same, same_end
from tests.tissue.space.in_space import SURFACES, of_surface
from tests.tissue.users import LAYERS, LIVELY, SHORT, own_module
from tissue.files.parameters import preset
from tissue.frames.frame import Frame
from tissue.runs.simulate import simulate, simulate_many

# A run that goes on later may end before an event.
pytestmark = pytest.mark.filterwarnings("ignore:.* never begins")

EMT = {"emt.cells": 5, "emt.inm": 0.5, "emt.a": "0 h to 3 h", "emt.b": "0.5 h to 2 h", "emt.s": "1 h", "emt.p": "2 h"}
LEAVING = {"cells": 3, "place": 0.9, "divides": False, "inm": 0.5, "a": "2 h", "alpha_ax": 3}
QUICK = {"cells": 6, "place": "scattered", "min_cycle": "1 h", "max_cycle": "1.5 h", "g2": "0.2 h", "b": "1 h"}
BIG = {"cells": 6, "place": 0.2, "soft_radius": "7 um", "alpha_xx": 4, "max_basal_distance": "2/3 R_soft"}
TUBE = {"layer.shape": "circle", "layer.perimeter": "60 R_soft", "layer.closed": True, "tissue.cells": 180}
TYPES = {f"types.{name}.{key}": value for name, one in
         (("leaving", LEAVING), ("quick", QUICK), ("big", BIG)) for key, value in one.items()}  # fmt: skip
SLICES = {
    "divisions": {},
    "EMT": EMT,
    "noise in substeps": EMT | {"numerics.noise": "substep"},
    "constriction": {"emt.cells": 6, "emt.ac": "1 h to 3 h", "emt.a": "2 h, 50 %"},
    "a cap": EMT | {"cell.max_cytoskeleton": "4 R_soft"},
    "types": TYPES | {"emt.cells": 2, "emt.s": "1 h"},
    "no cores": EMT | {"cell.hard_radius": "0 um", "cell.enlarged_radius": "0 um", "cell.alpha_xx": 0},
    "arc": EMT | TUBE | {"layer.closed": False, "tissue.cells": 60},
    "tube": EMT | TUBE | {"layer.side": "outside"},
}
FORCES = {"forces.wall": 2.0, "forces.straight": 3.0}
USERS = {f"forces on a {name}": EMT | FORCES | layer for name, layer in LAYERS.items()}
USERS["an event and a rule"] = {"emt.cells": 4, "emt.squeeze": "2 h", "emt.a": "1 h", "division.rule": "always"}
IN_SPACE = {
    "emt__cells": 3,
    "emt__a": "0.5 h",
    "emt__b": "1 h",
    "emt__s": "1 h",
    "emt__p": "1.5 h",
    "numerics__keep": "0.5 h",
}
NAMES = [f"{name}, {of}" for name in ("thesis", "published") for of in SLICES] + [*USERS, *SURFACES]


@pytest.fixture(scope="module", autouse=True)
def modules(tmp_path_factory):
    with own_module(tmp_path_factory.mktemp("own"), "module_of_contract") as file:
        yield [str(file)]


@pytest.fixture(params=NAMES)
def parameters(request, modules):
    if request.param in SURFACES:
        return of_surface(request.param, **IN_SPACE)
    name, _, of = request.param.partition(", ")
    given = preset(name if of else "published").changed({**SHORT, **LIVELY, "tissue.two_daughters": 0.5})
    return given.changed(SLICES[of] if of else {"own.modules": modules, **USERS[name]})


@pytest.mark.slow_with("published, tube", "forces on a tube", "cylinder", "sphere")
def test_alone_in_company_and_in_threads(parameters):
    """A run is a function of (parameters, seed); saved states that are left out change nothing."""
    company = simulate_many(parameters, [5, 2, 9])
    with ThreadPoolExecutor(2) as threads:
        alone = list(threads.map(lambda run: simulate(parameters, run.seed), company))
    for one, other in zip(company, alone, strict=True):
        assert one.status is Status.SUCCESS
        assert same_end(one, other)
        assert len(one.final.cells.x) > len(one.frames[0].cells.x)
    assert not np.array_equal(alone[0].final.cells.cycle[:20], alone[1].final.cells.cycle[:20])
    ends = simulate(parameters.changed({"numerics.keep": parameters.as_dict()["numerics"]["t_end"]}), 5)
    assert len(ends.frames) == 2
    assert same(ends.final, company[0].final)


@pytest.mark.slow_with("published, tube", "forces on a tube", "cylinder", "sphere")
def test_side_by_side_each_with_parameters_of_its_own(parameters):
    """The bits of each run are those that it has alone, also where another one cannot be beside it."""
    cell, numerics, mu = parameters.cell, parameters.numerics, parameters.numerics.mu.value
    given = [parameters]
    for k in (1, 2):
        own: dict[str, object] = {
            "numerics.mu": f"{(1 + k / 4) * mu:g} h",
            "cell.alpha_ax": cell.alpha_ax * (1 - k / 8),
        }
        own |= {"cell.alpha_xx": cell.alpha_xx * (1 + k / 4), "tissue.two_daughters": 0.4 * k}
        own |= {f"forces.{name}": strength * (1 + k / 4) for name, strength in parameters.forces}
        own |= {"tissue.diffusion": f"{0.7 * k} um^2/h"}
        given.append(parameters.changed(own))
    given.append(given[1].changed({"numerics.substeps": numerics.substeps + 1}))
    for several in (given[:3], given[2:]):
        for k, run in enumerate(simulate_many(several, range(len(several)))):
            assert same_end(run, simulate(several[k], k))
            assert run.parameters == several[k]
            assert run.final.checkpoint.parameters == several[k].as_toml()


def test_parameters_of_runs_side_by_side_must_have_the_same_times():
    """One for each seed, and the message says what differs."""
    given = preset("published").changed(SHORT)
    for several, seeds, says in (
        (
            [given, given.changed({"numerics.t_end": "5 h"})],
            [1, 2],
            'numerics.t_end = "4 h" and "5 h": must be the same',
        ),
        ([given, given.changed({"numerics.keep": ["2 h"]})], [1, 2], "numerics.keep"),
        ([given], [1, 2], "parameters = 1 of them: must be one for each of 2 seeds"),
        ([given, 3], [1, 2], "must be tissue.Parameters"),
    ):
        with pytest.raises(InvalidProblem, match=says):
            simulate_many(several, seeds)


@pytest.mark.slow_with("forces on a tube", "cylinder")
def test_from_each_saved_state_the_same_bits(parameters, tmp_path):
    """Handed over, from disk, and through pickle in turn; a run leaves its start as it was."""
    run = simulate(parameters, 3)
    for number, frame in enumerate(run.frames):
        start = frame
        if number % 3 == 1:
            frame.save(tmp_path / "state.npz")
            start = Frame.load(tmp_path / "state.npz")
        elif number % 3 == 2:
            start = pickle.loads(pickle.dumps(frame))
        before = pickle.loads(pickle.dumps(start))
        rest = simulate(parameters, 3, start)
        assert len(rest.frames) == len(run.frames) - number
        assert same_end(run, rest)
        assert same(start, before)
