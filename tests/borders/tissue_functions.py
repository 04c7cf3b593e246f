"""Functions of users of the tissue, at top level of a file as numba wants them: right ones, and ones that fail."""

import math

NAN = math.nan


def push(store, on, strength, numbers):
    for i in range(store.sizes[0]):
        on.y[i] -= strength * (store.cells.y[i] - 3.0)


def energy(store, strength, numbers):
    total = 0.0
    for i in range(store.sizes[0]):
        total += 0.5 * strength * (store.cells.y[i] - 3.0) ** 2
    return total


def push_nan(store, on, strength, numbers):
    on.y[0] = NAN


def energy_nan(store, strength, numbers):
    return NAN


def energy_huge(store, strength, numbers):
    return 1e300 * strength


def push_raises(store, on, strength, numbers):
    raise ValueError("no push")


def energy_raises(store, strength, numbers):
    raise RuntimeError("no energy")


def few(store):
    return 1.0


def unknown(store, *rest):
    return store.cells.no_such_array[0]


def writes_text(store, on, strength, numbers):
    on.x[0] = "text"


def returns_text(store, *rest):
    return "text"


def begin(store, i, bit, numbers):
    store.cells.stiff_bx[i] *= 2.0


def begin_nan(store, i, bit, numbers):
    store.cells.stiff_bx[i] = NAN


def begin_raises(store, i, bit, numbers):
    raise ValueError("no begin")


def last(store, i, rest_ax, rest_bx, numbers):
    store.cells.rest_bx[i] = 0.5 * rest_bx


def last_nan(store, i, rest_ax, rest_bx, numbers):
    store.cells.rest_ax[i] = NAN


def last_raises(store, i, rest_ax, rest_bx, numbers):
    if rest_ax > -1e9:
        raise ZeroDivisionError("no last")


def splits(store, i, number, numbers):
    return number < 0.9


def splits_nan(store, i, number, numbers):
    return NAN


def splits_raises(store, i, number, numbers):
    raise OverflowError("no splits")


def place(store, i, numbers):
    store.cells.x[i] -= 0.1
    store.cells.x[i + 1] += 0.1


def place_nan(store, i, numbers):
    store.cells.x[i] = NAN


def place_raises(store, i, numbers):
    raise ValueError("no place")


def measure(frame, parameters):
    return float(frame.cells.y.min())


def measure_nan(frame, parameters):
    return NAN


def measure_array(frame, parameters):
    return frame.cells.y


def measure_text(frame, parameters):
    return "high"


def measure_raises(frame, parameters):
    raise KeyError("k")


def measure_few(frame):
    return 0.0


PUSHES = (push, push, push, push_nan, push_raises, few, unknown, writes_text)
ENERGIES = (energy, energy, None, energy_nan, energy_huge, energy_raises, few, unknown, returns_text)
BEGINS = (begin, begin, None, begin_nan, begin_raises, few, unknown)
LASTS = (last, last, None, last_nan, last_raises, few, unknown)
SPLITS = (splits, splits, splits_nan, splits_raises, few, unknown, returns_text)
PLACES = (place, place, place_nan, place_raises, few, unknown)
MEASURES = (measure, measure, measure_nan, measure_array, measure_text, measure_raises, measure_few)
