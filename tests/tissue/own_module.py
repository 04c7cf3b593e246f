"""A module of a user, of which tests load copies: forces, an event, an observable and a rule of divisions."""

import math

import tissue

CELLS = 0
WALL, POINT = 6.0, (1.0, 3.0)


def push_down(store, on, strength, numbers):
    cells = store.cells
    for i in range(store.sizes[CELLS]):
        on.ay[i] -= strength * max(0.0, cells.ay[i] - WALL)
        on.y[i] -= strength * max(0.0, cells.y[i] - WALL)


def wall_energy(store, strength, numbers):
    w = 0.0
    for i in range(store.sizes[CELLS]):
        w += max(0.0, store.cells.ay[i] - WALL) ** 2 + max(0.0, store.cells.y[i] - WALL) ** 2
    return 0.5 * strength * w


def pull_to_point(store, on, strength, numbers):
    cells = store.cells
    for i in range(store.sizes[CELLS]):
        on.x[i] -= strength * (cells.x[i] - POINT[0])
        on.y[i] -= strength * (cells.y[i] - POINT[1])
        on.ax[i] -= strength * (cells.ax[i] - POINT[0])
        on.ay[i] -= strength * (cells.ay[i] - POINT[1])
        on.bx[i] -= strength * (cells.bx[i] - POINT[0])
        on.by[i] -= strength * (cells.by[i] - POINT[1])


def straighten(store, on, strength, numbers):
    """The bending energy of the thesis with alpha_axb = strength (3.12)."""
    cells = store.cells
    for i in range(store.sizes[CELLS]):
        ux, uy = cells.ax[i] - cells.x[i], cells.ay[i] - cells.y[i]
        vx, vy = cells.bx[i] - cells.x[i], cells.by[i] - cells.y[i]
        u, v = math.hypot(ux, uy), math.hypot(vx, vy)
        ux, uy, vx, vy = ux / u, uy / u, vx / v, vy / v
        cosine = ux * vx + uy * vy
        ax, ay = -strength * (vx - cosine * ux) / u, -strength * (vy - cosine * uy) / u
        bx, by = -strength * (ux - cosine * vx) / v, -strength * (uy - cosine * vy) / v
        on.ax[i] += ax
        on.ay[i] += ay
        on.bx[i] += bx
        on.by[i] += by
        on.x[i] -= ax + bx
        on.y[i] -= ay + by


def bending_energy(store, strength, numbers):
    cells, w = store.cells, 0.0
    for i in range(store.sizes[CELLS]):
        ux, uy = cells.ax[i] - cells.x[i], cells.ay[i] - cells.y[i]
        vx, vy = cells.bx[i] - cells.x[i], cells.by[i] - cells.y[i]
        w += 1.0 + (ux * vx + uy * vy) / (math.hypot(ux, uy) * math.hypot(vx, vy))
    return strength * w


def explode(store, on, strength, numbers):
    """Of those tissues alone whose first cell has a long cycle: for strength 1 no number, else ever larger."""
    cells = store.cells
    if cells.cycle[0] > 15.0:
        on.x[0] += math.nan if strength == 1.0 else strength * (1.0 + abs(cells.x[0]))
        on.by[3] += math.nan if strength == 1.0 else strength * (1.0 + abs(cells.by[3]))
        on.bx[5] += math.nan if strength == 1.0 else strength * (1.0 + abs(cells.bx[5]))


STIFFER = 3.0


def begin(store, i, bit, numbers):
    store.cells.stiff_bx[i] *= STIFFER


def last(store, i, rest_ax, rest_bx, numbers):
    store.cells.rest_bx[i] = 0.5 * rest_bx


def stiffest(frame, parameters):
    return float(frame.cells.stiff_bx.max())


def always(store, i, number, numbers):
    return number < 2.0


def far(store, i, numbers):
    cells = store.cells
    for points in (cells.x, cells.ax, cells.bx):
        points[i] -= 0.1
        points[i + 1] += 0.1


tissue.register(
    tissue.Force("wall", push_down, "nothing is above a height", "a test", wall_energy),
    tissue.Force("point", pull_to_point, "springs to a point"),
    tissue.Force("straight", straighten, "cells are straight", "(3.12)", bending_energy),
    tissue.Force("explosive", explode, "tissues are lost"),
    tissue.EmtEvent("squeeze", "the basal spring stiffens and shortens", "a test", begin, last),
    tissue.Observable("stiffest", "largest alpha_bx", stiffest),
    tissue.DivisionRule("always", "without chance; farther apart", "a test", always, far),
)
