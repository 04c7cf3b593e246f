"""The first-order model of chapter 3 once more, in as many digits as wanted: what the kernels should compute.

Nothing is shared with the kernels or the other twins but the numbers, taken as the doubles that they are. Points of the
plane are complex numbers. A basal point of the layer is known by its arclength s along it; which curve the layer is, is
in one function, ``Layer``. The rules are those of the preset ``thesis``: all cells are alike, noise comes once per dt,
and there are no EMT events.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from mpmath import mp
from numpy.random import Generator

from tissue.frames.frame import Frame
from tissue.state.numbers import Numbers

# The point of the basal layer at arclength s, and the unit tangent there.
Layer = Callable[[Any], tuple[Any, Any]]


def line(s: Any) -> tuple[Any, Any]:
    """The straight layer y = 0."""
    return mp.mpc(s, 0), mp.mpc(1, 0)


@dataclass
class Cell:
    """A cell; lengths in R_soft, times in h."""

    x: Any  # nucleus X
    a: Any  # apical point A
    s: Any  # arclength of the basal point B
    eta_ax: Any
    eta_bx: Any
    eta_aa: Any  # of the junction to the next cell
    birth: Any
    cycle: Any
    radius: Any


@dataclass(frozen=True)
class Reference:
    """The model with these numbers, on this layer; made and run within one ``mpmath.workdps``."""

    numbers: Numbers
    layer: Layer = line

    def number(self, name: str) -> Any:
        """A number of the run, the double that it is."""
        return mp.mpf(getattr(self.numbers, name))

    def run(self, cells: list[Cell], steps: int, draws: Generator, noise: Generator) -> list[Cell]:
        """The cells after so many dt; generators are those of the run, and give doubles."""
        dt = self.number("dt")
        for k in range(1, steps + 1):
            cells = [one for cell in cells for one in self.divided(cell, k * dt, draws)]
            for cell in cells:
                self.age(cell, k * dt)
            for cell in cells:
                kick = [mp.mpf(float(noise.standard_normal())) for _ in range(2)]
                cell.x += mp.sqrt(self.number("variance") * dt) * mp.mpc(*kick)
            for _ in range(self.numbers.substeps):
                self.move(cells, dt / self.numbers.substeps / self.number("mu"))
                self.part(cells)
                self.order(cells)
        return cells

    # Rules, once per dt

    def divided(self, cell: Cell, t: Any, draws: Generator) -> Iterator[Cell]:
        """The cell, a cell that begins a new cycle, or two that do: section 2.2.5, (3.1), (3.7)."""
        if t - cell.birth < cell.cycle:
            yield cell
            return
        two = draws.random() < self.numbers.two_daughters
        cell = replace(cell, birth=t, cycle=self.new_cycle(draws))
        if not two:
            yield cell
            return
        offset, (_, along) = self.number("division_offset"), self.layer(cell.s)
        for side, eta_aa, cycle in (
            (-1, self.number("new_junction"), cell.cycle),
            (1, cell.eta_aa, self.new_cycle(draws)),
        ):
            place = side * offset
            shifted = {"x": cell.x + place * along, "a": cell.a + place * along, "s": cell.s + place}
            yield replace(cell, **shifted, eta_aa=eta_aa, cycle=cycle)

    def new_cycle(self, draws: Generator) -> Any:
        """t_cycle ~ U(T_min, T_max)  (3.1)."""
        low, high = self.number("min_cycle"), self.number("max_cycle")
        return low + (high - low) * mp.mpf(draws.random())

    def age(self, cell: Cell, t: Any) -> None:
        """The hard radius (3.4) and the rest lengths (3.2), (3.3), (3.6), solved over dt for points that rest."""
        dt, age = self.number("dt"), t - cell.birth
        mitosis = age >= cell.cycle - self.number("mitosis")
        g2 = age >= cell.cycle - self.number("g2") - self.number("mitosis")
        cell.radius = self.number("enlarged_radius" if mitosis else "hard_radius")
        b, _ = self.layer(cell.s)
        wanted_ax = mp.mpf(0) if g2 else abs(cell.x - cell.a) - 1
        wanted_bx = abs(cell.a - b) - 2 if g2 else abs(cell.x - b) - 1
        cell.eta_ax = wanted_ax + (cell.eta_ax - wanted_ax) * mp.exp(-self.number("rate_ax") * dt)
        cell.eta_bx = wanted_bx + (cell.eta_bx - wanted_bx) * mp.exp(-self.number("rate_bx") * dt)
        cell.eta_aa *= mp.exp(-self.number("rate_aa") * dt)

    # A substep (3.34)

    def move(self, cells: list[Cell], scale: Any) -> None:
        """Z - (h / mu) grad W(Z): explicit Euler, basal points along the layer."""
        forces = [self.within(cell) for cell in cells]
        on_x, on_a, along = ([force[k] for force in forces] for k in range(3))
        stiffness = self.number("junction_factor") * self.number("alpha_aa")
        for i in range(len(cells) - 1):
            tension = _spring(cells[i + 1].a - cells[i].a, stiffness, cells[i].eta_aa)  # (3.11)
            on_a[i] += tension
            on_a[i + 1] -= tension
        for i in range(len(cells)):
            for j in range(i):
                apart = cells[i].x - cells[j].x
                if abs(apart) < 2:
                    push = _spring(apart, self.number("repulsion"), 2)  # (3.13)
                    on_x[i] -= push
                    on_x[j] += push
        for cell, x, a, s in zip(cells, on_x, on_a, along, strict=True):
            cell.x, cell.a, cell.s = cell.x + scale * x, cell.a + scale * a, cell.s + scale * s

    def within(self, cell: Cell) -> tuple[Any, Any, Any]:
        """-grad W of the springs (3.9), (3.10) and of straightness (3.12): on X, on A, on s."""
        power = self.numbers.power
        b, tangent = self.layer(cell.s)
        u, v = cell.a - cell.x, b - cell.x
        l_ax, l_bx = 1 + cell.eta_ax, 1 + cell.eta_bx
        on_a = -_spring(u, 2 * self.number("alpha_ax") / l_ax**power, l_ax)
        on_b = -_spring(v, 2 * self.number("alpha_bx") / l_bx**power, l_bx)
        # W = alpha (cos gamma + 1) with cos gamma = u . v / (|u| |v|)
        length_u, length_v, alpha = abs(u), abs(v), self.number("alpha_axb")
        cosine = _dot(u, v) / (length_u * length_v)
        on_a -= alpha * (v / length_v - cosine * u / length_u) / length_u
        on_b -= alpha * (u / length_u - cosine * v / length_v) / length_v
        return -(on_a + on_b), on_a, _dot(on_b, tangent)

    def part(self, cells: list[Cell]) -> None:
        """|X_i - X_j| >= R_i + R_j (C1) for i, then j < i: each moves by half of the overlap."""
        for i, cell in enumerate(cells):
            for other in cells[:i]:
                apart, reach = cell.x - other.x, cell.radius + other.radius
                distance = abs(apart)
                if distance < reach:
                    half = (reach - distance) / 2 * apart / distance
                    cell.x, other.x = cell.x + half, other.x - half

    def order(self, cells: list[Cell]) -> None:
        """s_i <= s_{i+1} (C4), then s_{i+1} - s_i <= d_max (C2), from one end to the other: each moves by half."""
        largest = self.number("max_basal")
        for left, right in pairwise(cells):
            if right.s < left.s:
                left.s = right.s = (left.s + right.s) / 2
        for left, right in pairwise(cells):
            excess = right.s - left.s - largest
            if excess > 0:
                left.s, right.s = left.s + excess / 2, right.s - excess / 2


def _spring(arrow: Any, stiffness: Any, rest: Any) -> Any:
    """k (d - l) along the arrow."""
    length = abs(arrow)
    return stiffness * (length - rest) / length * arrow


def _dot(u: Any, v: Any) -> Any:
    return u.real * v.real + u.imag * v.imag


def taken(frame: Frame) -> list[Cell]:
    """The cells of a state, by the doubles that they are."""
    c = frame.cells
    s = c.along if frame.curve.pieces else c.bx
    columns = (c.x, c.y, c.ax, c.ay, s, c.rest_ax, c.rest_bx, c.rest_aa, c.birth, c.cycle, c.radius)
    rows = ([mp.mpf(value) for value in row] for row in zip(*(column.tolist() for column in columns), strict=True))
    return [Cell(mp.mpc(x, y), mp.mpc(ax, ay), *rest) for x, y, ax, ay, *rest in rows]
