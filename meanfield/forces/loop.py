"""Compiled loop over particles, generated from elementary operations, that reads each particle once."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from meanfield.model.translate import Body, body

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from meanfield.model.translate import Instruction

# Sums are accumulated over blocks of this many particles, so that rounding does not grow with the number of particles.
SUM_BLOCK = 2048
# Arrays with a row for each particle.
PARTICLE_ARRAYS = ("X", "P", "w", "U")
# Lines with a sine or cosine. The loop calls ``forces.trig``, because calls of the C library are not vectorised.
ANGLE = re.compile(r"(t\d+) = np\.(sin|cos)\((.*)\)")


def compile_loop(
    program: Sequence[Instruction], nx: int, *, interacting: bool, weighted: bool, plain_last: bool
) -> Callable[..., Any]:
    """Compile a loop over particles that stores the first nx outputs of each particle and averages the others.

    The inputs of the program are X, the force of interaction if ``interacting``, y and v. Averages use the weights if
    ``weighted``. If ``plain_last``, the last output is averaged without weights, so that equal signs average to
    exactly 1.

    Returns
    -------
    function
        of (X, force, weights, y, v, U): fills U (Q, nx) and returns the averages; unused arguments are ignored.
    """
    names = ["X", "P", "y", "v"] if interacting else ["X", "y", "v"]
    varies = [name in ("X", "P") for name in names]
    forms = [f"{n}[i, {{}}]" if p else f"{n}[{{}}]" for n, p in zip(names, varies, strict=True)]
    text = body(program, forms, varies)
    weights = ["w[i] * " if weighted else ""] * len(text.outputs[nx:])
    if plain_last:
        weights[-1] = ""
    fast, general = _source(text, nx, weights, fast=True), _source(text, nx, weights, fast=False)
    constants = np.array(text.constants)

    def evaluate(X: Any, P: Any, w: Any, y: Any, v: Any, U: Any) -> Any:
        averages, out_of_range = _compiled(fast)(X, P, w, U, y, v, constants)
        return averages if out_of_range == 0 else _compiled(general)(X, P, w, U, y, v, constants)[0]

    return evaluate


def _source(text: Body, nx: int, weights: Sequence[str], *, fast: bool) -> str:
    """Generate the source of a loop; if ``fast``, it uses ``forces.trig`` and counts the angles out of its range."""
    sums = text.outputs[nx:]
    angles = [found[3] for found in map(ANGLE.fullmatch, text.per_particle) if found] if fast else []
    each = [ANGLE.sub(r"\1 = \2(\3)", line) for line in text.per_particle] if fast else text.per_particle
    lines = [f"def f({', '.join(f'all_{name}' for name in PARTICLE_ARRAYS)}, y, v, numbers):"]
    lines += [f"    n, total, out_of_range = all_X.shape[0], np.zeros({len(sums)}), 0.0"]
    lines += [f"    {line}" for line in text.common]
    lines += [f"    for begin in range(0, n, {SUM_BLOCK}):"]
    # Views are indexed from 0. With indices from begin on, numba's test for negative indices prevents vectorisation.
    lines += [f"        {name} = all_{name}[begin : begin + {SUM_BLOCK}]" for name in PARTICLE_ARRAYS]
    lines += [f"        s{k} = 0.0" for k in range(len(sums))]
    lines += ["        for i in range(X.shape[0]):"]
    lines += [f"            {line}" for line in each]
    lines += [f"            out_of_range += 0.0 if abs({a}) <= MAX_ANGLE else 1.0" for a in dict.fromkeys(angles)]
    lines += [f"            U[i, {k}] = {name}" for k, name in enumerate(text.outputs[:nx])]
    lines += [f"            s{k} += {weights[k]}({name})" for k, name in enumerate(sums)]
    lines += [f"        total[{k}] += s{k}" for k in range(len(sums))]
    lines += [f"    total[{k}] /= n" for k in range(len(sums)) if not weights[k]]
    return "\n".join([*lines, "    return total, out_of_range", ""])


@cache
def _compiled(source: str) -> Any:
    """Compile a generated loop; sums may be reordered, which changes only their last bits."""
    from dincl.compiled.functions import compile_reordered
    from meanfield.forces import trig

    namespace: dict[str, Any] = {"np": np, "sin": trig.sin, "cos": trig.cos, "MAX_ANGLE": trig.MAX_ANGLE}
    exec(compile(source, "<model>", "exec"), namespace)
    return compile_reordered(namespace["f"])
