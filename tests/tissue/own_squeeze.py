"""A module of a user, of which tests load copies: an event, an observable and a rule of divisions."""

import tissue

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
    tissue.EmtEvent("squeeze", "the basal spring stiffens and shortens", "a test", begin, last),
    tissue.Observable("stiffest", "largest alpha_bx", stiffest),
    tissue.DivisionRule("always", "without chance; farther apart", "a test", always, far),
)
