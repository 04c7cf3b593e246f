"""A list of elementary operations as one compiled loop over particles, which reads each of them once."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from meanfield.model.translate import Body, body

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from meanfield.model.translate import Instruction

# Sums of this many particles are added up apart, so that rounding does not grow with their number.
BLOCK = 2048
# Arrays with a row for each particle.
BLOCKWISE = ("X", "P", "w", "U")
# Lines with a sine or cosine, which the loop takes from ``kernels.trig``: those of the C library fit no register.
ANGLE = re.compile(r"(t\d+) = np\.(sin|cos)\((.*)\)")


def summed(
    program: Sequence[Instruction], nx: int, *, pulled: bool, weighted: bool, signed: bool
) -> Callable[..., Any]:
    """A compiled loop over particles: keeps the first nx outputs for each, averages the others.

    The inputs of the program are X, then the force of interaction if ``pulled``, y and v. The average is over the
    weights if ``weighted``; that of the last output is plain if ``signed``, so that equal signs average to 1 exactly.

    Returns
    -------
    function
        of (X, force, weights, y, v, U): fills U (Q, nx), returns the averages; arguments not used are ignored.
    """
    names = ["X", "P", "y", "v"] if pulled else ["X", "y", "v"]
    own = [name in ("X", "P") for name in names]
    text = body(program, [f"{n}[i, {{}}]" if o else f"{n}[{{}}]" for n, o in zip(names, own, strict=True)], own)
    weights = ["w[i] * " if weighted else ""] * len(text.outputs[nx:])
    if signed:
        weights[-1] = ""
    near, anywhere = _source(text, nx, weights, near=True), _source(text, nx, weights, near=False)
    constants = np.array(text.constants)

    def evaluated(X: Any, P: Any, w: Any, y: Any, v: Any, U: Any) -> Any:
        averages, far = _compiled(near)(X, P, w, U, y, v, constants)
        return averages if far == 0 else _compiled(anywhere)(X, P, w, U, y, v, constants)[0]

    return evaluated


def _source(text: Body, nx: int, weights: Sequence[str], *, near: bool) -> str:
    """The source of a loop in blocks over all particles, which counts angles that are too far for ``kernels.trig``."""
    sums = text.outputs[nx:]
    angles = [found[3] for found in map(ANGLE.fullmatch, text.each) if found] if near else []
    each = [ANGLE.sub(r"\1 = \2(\3)", line) for line in text.each] if near else text.each
    lines = [f"def f({', '.join(f'all_{name}' for name in BLOCKWISE)}, y, v, numbers):"]
    lines += [f"    n, total, far = all_X.shape[0], np.zeros({len(sums)}), 0.0"]
    lines += [f"    {line}" for line in text.common]
    lines += [f"    for begin in range(0, n, {BLOCK}):"]
    # Views, not indices from begin on: these would be looked at for negative ones, and no vector register used.
    lines += [f"        {name} = all_{name}[begin : begin + {BLOCK}]" for name in BLOCKWISE]
    lines += [f"        s{k} = 0.0" for k in range(len(sums))]
    lines += ["        for i in range(X.shape[0]):"]
    lines += [f"            {line}" for line in each]
    lines += [f"            far += 0.0 if abs({angle}) <= FARTHEST else 1.0" for angle in dict.fromkeys(angles)]
    lines += [f"            U[i, {k}] = {name}" for k, name in enumerate(text.outputs[:nx])]
    lines += [f"            s{k} += {weights[k]}({name})" for k, name in enumerate(sums)]
    lines += [f"        total[{k}] += s{k}" for k in range(len(sums))]
    lines += [f"    total[{k}] /= n" for k in range(len(sums)) if not weights[k]]
    return "\n".join([*lines, "    return total, far", ""])


@cache
def _compiled(source: str) -> Any:
    """A generated loop, compiled; sums may be reordered, which changes their last bits only."""
    from numba import njit

    from meanfield.kernels import trig

    place: dict[str, Any] = {"np": np, "sin": trig.sin, "cos": trig.cos, "FARTHEST": trig.FARTHEST}
    exec(compile(source, "<model>", "exec"), place)
    return njit(nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz", "arcp"})(place["f"])
