"""Small compiled runs that call a drift by its address, and the same in plain Python."""

from functools import partial

import numpy as np

from dincl.compiled import kernel
from dincl.drifts.functions import OK, velocity
from dincl.system.callbacks import DriftPointer, catching

X = np.array([[0.5, -0.25], [1.0, 3.0], [-0.0, 2.0]])


@partial(kernel, references=False)
def asked(address, t, x, out, n, d, data):
    """The drift, asked for once, and its numbers checked."""
    return velocity(address, t, x, out, n, d, data)


@partial(kernel, references=False)
def descend(address, data, h, steps, x, out):
    """Explicit Euler; the evaluations made, and the code of the last one."""
    for k in range(steps):
        code = velocity(address, k * h, x, out, x.shape[0], x.shape[1], data)
        if code != OK:
            return k + 1, code
        for i in range(x.shape[0]):
            for j in range(x.shape[1]):
                x[i, j] += h * out[i, j]
    return steps, OK


def run(problem, steps=7, h=0.1, slices=1):
    """A small compiled run."""
    pointer, x = DriftPointer(problem), problem.x0.copy()
    out = np.empty_like(x)
    with catching([pointer]):
        for _ in range(slices):
            evaluations, code = descend(pointer.address, pointer.data, h, steps, x, out)
            pointer.count_evaluations(evaluations)
            if code != OK:
                pointer.failure((evaluations - 1) * h, x, out, code)
    return x


def plain(problem, steps=7, h=0.1):
    x = problem.x0.copy()
    for k in range(steps):
        x = x + h * problem.velocity(k * h, x)
    return x
