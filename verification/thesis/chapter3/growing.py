"""Tissues of the parameters of a preset, some changed: one that grows while it is looked at, and frozen ones."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.status import Status
from tissue.files.parameters import Parameters, preset
from tissue.frames.frame import Frame
from tissue.kernels.workspace import RUNNING
from tissue.rules.slice import in_plane
from tissue.runs.compiled_rules import rules_pointer
from tissue.runs.group import Group
from tissue.runs.start import started
from tissue.state.cells import COORDINATES, CellLayers, Cells
from tissue.state.checkpoint import Streams, streams
from tissue.state.numbers import Numbers, numbers_pointer
from tissue.state.running import TissueState, contents, new_state
from tissue.step.advance import apply_rules

Floats = NDArray[np.float64]
PRESETS = ("thesis", "published")
# A coordinate beyond so many times the largest at the start has left the tissue: 48 h of growth treble it.
FAR = 10.0
OUT_OF_BOUNDS = "BEYOND_BOUNDS"
SUCCESS = Status.SUCCESS.name


def until(end: float) -> dict[str, str]:
    """Return changes of parameters for runs to the end [h] that keep no state before it."""
    return {"numerics.t_end": f"{end:g} h", "numerics.keep": f"{end:g} h"}


@dataclass
class Growing:
    """One run that can be taken from time to time; its rules and noise are those of ``tissue.simulate``.

    Attributes
    ----------
    numbers, held, random
        Parameters, state and streams of the run.
    bound
        A coordinate beyond this has left the tissue [R_soft].
    made
        Steps made.
    status
        SUCCESS as long as the state is fit to go on, else the name of a ``Status``, or ``OUT_OF_BOUNDS``.
    seconds
        Time spent on the steps made so far.
    pairs
        Pairs looked at for the repulsion in them.
    """

    numbers: Numbers
    held: TissueState
    random: Streams
    bound: float
    made: int = 0
    status: str = SUCCESS
    seconds: float = 0.0
    pairs: int = 0

    def to(self, t: float) -> bool:
        """Go on until time t [h], a multiple of dt; whether the run is fit to go on from there."""
        step = round(t / self.numbers.dt)
        if self.status == SUCCESS:
            group = Group([self.held], self.numbers, [self.random])
            began = time.process_time()
            group.advance(self.made, step)
            self.seconds += time.process_time() - began
            self.held, ended = group.states[0], int(group.ended[0])
            self.pairs += group.pairs
            self.made, self.status = (step, SUCCESS) if ended == RUNNING else (ended - 1, Status.NON_FINITE.name)
        # Chance decides how a run ends that loses cells; its status is that it lost them.
        if extent(self.frame().cells) > self.bound:
            self.status = OUT_OF_BOUNDS
        return self.status == SUCCESS

    def frame(self) -> Frame:
        """Return the state now."""
        return Frame(self.made * self.numbers.dt, *contents(self.held))


def growing(name: str, seed: int, **changes: Any) -> Growing:
    """Return a run of a preset at its start, with some of its ``Numbers`` changed."""
    return growing_from(preset(name), seed, **changes)


def growing_from(parameters: Parameters, seed: int, **changes: Any) -> Growing:
    """Return a run at its start, with some of its ``Numbers`` changed."""
    random, numbers = streams(seed), parameters.numbers()
    held = started(parameters, random)
    return Growing(numbers._replace(**changes), held, random, far_from(contents(held)[0]))


def with_noise(run: Growing, seed: int) -> Growing:
    """Give a run the noise of another seed; its start and its divisions stay."""
    run.random = run.random._replace(noise=streams(seed).noise)
    return run


def extent(cells: Cells) -> float:
    """Return the largest coordinate by magnitude; infinite if one is not finite."""
    coordinates = np.abs([getattr(cells, name) for name in COORDINATES])
    return float(coordinates.max()) if np.isfinite(coordinates).all() else np.inf


def far_from(cells: Cells) -> float:
    """Return the coordinate beyond which a cell has left the tissue [R_soft]."""
    return FAR * extent(cells)


def nuclei(frame: Frame) -> Floats:
    """Return X, shape (2, n) [R_soft]."""
    return np.stack((frame.cells.x, frame.cells.y))


def rms(x: Floats, y: Floats) -> float:
    """Return sqrt(mean_i |X_i - Y_i|^2) for x, y of shape (2, n)."""
    return float(np.sqrt(((x - y) ** 2).sum(axis=0).mean()))


# Frozen tissues: rules stand still, there is no noise; their substeps and their jitter.
# One rule of the thesis preset changed: desired rest lengths that are not negative, as the published runs have it.
FLOORED = {"rules.floor_rest_length": True}


class Frozen(NamedTuple):
    """A state whose rules stand still."""

    cells: Cells
    layers: CellLayers
    numbers: Numbers


def floored() -> Parameters:
    """Return the thesis preset with desired rest lengths that are not negative, with which DAHA terminates."""
    return preset("thesis").changed(FLOORED)


@cache
def begun(parameters: Parameters, seed: int, t: float) -> Frozen:
    """Return the state from which the step that ends at t + dt begins: rules and noise applied, nothing moved yet.

    The tissue was grown by PBD. The state need not be in S.
    """
    run = growing_from(parameters, seed)
    run.to(t)
    if run.status != SUCCESS:
        raise RuntimeError(f"seed {seed}: the tissue was lost before t = {t:g} h: {run.status}")
    t, numbers = (run.made + 1) * run.numbers.dt, numbers_pointer(run.numbers)
    apply_rules(run.held, t, numbers, rules_pointer([run.held]), run.random.cycle, run.random.noise)
    return Frozen(*contents(run.held), run.numbers)


def substepped(state: Frozen, scale: float, substeps: int) -> Cells | None:
    """Return the cells after so many substeps of h = scale mu, without rules and noise; None if cells are lost."""
    cells, layers, numbers = state
    still = numbers._replace(dt=scale * numbers.mu * substeps, substeps=substeps, noise_in_substeps=False)
    group = Group([new_state(cells, layers, capacity=len(cells.x), space=in_plane())], still)
    return contents(group.states[0])[0] if group.make_substeps() else None


def swing(state: Frozen, scale: float) -> Floats | None:
    """Return |a| of each nucleus, shape (n,) [R_soft], of the state and the two after it; None if one of them is lost.

    a is the period-two part of three states in a row: where Z_k = Y + (-1)^k a, it is (Z_{k+1} - 2 Z_k + Z_{k-1})/4.
    Beyond the linear limit of explicit Euler points swing from substep to substep: they jitter.
    """
    now = substepped(state, scale, 1)
    after = None if now is None else substepped(state._replace(cells=now), scale, 1)
    if now is None or after is None:
        return None
    before, here, then = (np.stack((one.x, one.y)) for one in (state.cells, now, after))
    turn = (then - 2 * here + before) / 4
    return np.asarray(np.hypot(turn[0], turn[1]))
