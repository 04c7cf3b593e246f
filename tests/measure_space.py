"""What a substep costs in three dimensions and in two: ``python -m tests.measure_space``.

Nanoseconds of CPU time per cell and substep, smallest and median of ``TIMES`` dt, in turns in one process, after a
warm-up: a run of 1,000 cells of the preset "published" in two dimensions, alone; periodic hexagonal sheets of spacing
1/3 and height 8 in three, in the order of the sheet and in any order, with noise before each dt and rest lengths that
follow, 3 % of the nuclei enlarged. Last the exponent of the cost in the number of cells. No test: these are times.
"""

import time

import numpy as np

from tests.tissue.space.space_calls import call_substeps, taken, workspace_of
from tests.twins.tissue.space.state import SpaceTissue, Steps
from tissue.files.parameters import preset
from tissue.kernels.surface_workspace import LISTS, PAIRS, SUBSTEPS
from tissue.rules.slice import in_plane
from tissue.runs.group import Group
from tissue.runs.simulate import simulate
from tissue.state.running import new_state
from tissue.state.surface import PLANE, Surface

TIMES, WARM = 12, 20
SPACING, HEIGHT, KICK = 1 / 3, 8.0, 0.1
SIDES = (20, 32, 70, 141)


def sheet(side, mixed, rng):
    """A sheet of side x side cells, and the numbers of its steps; ``mixed``: the cells in any order."""
    n, depth = side * side, SPACING * np.sqrt(3) / 2
    row, place = np.divmod(np.arange(n), side)
    b = np.array([depth * row, 0.0 * row, SPACING * (place + 0.5 * (row % 2))])
    above = np.where(row % 2 == 0, -1, 1)
    ends = [(row, place + 1), (row + 1, place), (row + 1, place + above)]
    edges = np.vstack([np.column_stack((np.arange(n), i % side * side + k % side)) for i, k in ends])
    if mixed:
        order = rng.permutation(n)
        b, edges = b[:, order], np.argsort(order)[edges]
    x = b + SPACING * rng.uniform(-1, 1, (3, n))
    x[1] = HEIGHT * rng.uniform(1 / 6, 5 / 6, n)
    one, none, m = np.ones(n), np.zeros(n), len(edges)
    stiff, rest = (2 * one, 2 * one, 15 * one), (2.5 * one, 2.5 * one)
    radius = np.where(rng.uniform(size=n) < 0.03, 0.7, 0.3)
    a = b + np.array([[0.0], [HEIGHT], [0.0]])
    junctions = edges, np.full(m, SPACING), np.full(m, 1.25)
    state = SpaceTissue(x, a, b, radius, *stiff, *rest, one, one, none, *junctions, edges)
    return state, Steps(substeps=40, surface=Surface(PLANE, np.inf, 1.0, depth * side, SPACING * side))


class InSpace:
    """A sheet that goes on by one dt each time."""

    def __init__(self, side, mixed=False):
        self.rng = np.random.default_rng(side)
        self.state, self.steps = sheet(side, mixed, self.rng)
        self.workspaces, self.n = workspace_of(self.state, self.steps), side * side
        for _ in range(WARM):
            self.cost()
        self.workspaces.flat.value.counts[:] = 0

    def cost(self):
        """Of one dt."""
        x, a, b = self.state.x + KICK * self.rng.standard_normal((3, self.n)), self.state.a, self.state.b
        rests = [1 + np.maximum(np.sqrt(((x - end) ** 2).sum(axis=0)) - 1, 0) for end in (a, b)]
        l_ax, l_bx = (new + (old - new) * np.exp(-0.25) for new, old in zip(rests, self.state[7:9], strict=True))
        self.state = self.state._replace(x=x, l_ax=l_ax, l_bx=l_bx)
        workspace_of(self.state, self.steps, self.workspaces)
        begin = time.process_time()
        call_substeps(self.workspaces, self.n)
        spent = time.process_time() - begin
        self.state = taken(self.workspaces, self.state)
        return 1e9 * spent / self.n / self.steps.substeps

    def told(self):
        counts = self.workspaces.flat.value.counts
        pairs, substeps = counts[PAIRS] / counts[SUBSTEPS] / self.n, counts[SUBSTEPS] / counts[LISTS]
        return f"{pairs:.1f} pairs, {substeps:.1f} substeps a list"


class InPlane:
    """A run of two dimensions after two hours, of which one dt is made again and again, with other noise."""

    def __init__(self):
        self.rng = np.random.default_rng(0)
        wide = {"tissue.cells": 1000, "tissue.width": f"{10 * 1000 / 45} R_soft", "numerics.t_end": "2 h"}
        parameters = preset("published").changed(wide)
        self.frame, self.numbers = simulate(parameters, 0).final, parameters.numbers()
        self.cost()

    def cost(self):
        cells = self.frame.cells
        n = len(cells.x)
        kicks = KICK * self.rng.standard_normal((2, n))
        moved = cells._replace(x=cells.x + kicks[0], y=cells.y + kicks[1])
        group = Group([new_state(moved, self.frame.layers, capacity=n, space=in_plane())], self.numbers)
        begin = time.process_time()
        group.make_substeps()
        return 1e9 * (time.process_time() - begin) / n / self.numbers.substeps


def main():
    """Measure in turns, and tell."""
    plane, sheets = InPlane(), {f"{side * side} cells": InSpace(side) for side in SIDES}
    sheets[f"{SIDES[-1] ** 2} cells in any order"] = InSpace(SIDES[-1], mixed=True)
    costs = {name: [] for name in ("plane", *sheets)}
    for _ in range(TIMES):
        for name, one in sheets.items():
            costs["plane"].append(plane.cost())
            costs[name].append(one.cost())
    smallest, median = ({name: form(all_of) for name, all_of in costs.items()} for form in (min, np.median))
    print(f"two dimensions: {smallest['plane']:.0f}, {median['plane']:.0f} ns")
    for name, one in sheets.items():
        times = smallest[name] / smallest["plane"], median[name] / median["plane"]
        print(
            f"{name}: {smallest[name]:.0f}, {median[name]:.0f} ns, {times[0]:.2f}, {times[1]:.2f} times, {one.told()}"
        )
    first, last = (f"{side * side} cells" for side in (SIDES[0], SIDES[-1]))
    grown = np.log([form[last] / form[first] for form in (smallest, median)]) / np.log(SIDES[-1] ** 2 / SIDES[0] ** 2)
    print(f"cost n^{1 + grown[0]:.3f}, n^{1 + grown[1]:.3f}")


if __name__ == "__main__":
    main()
