"""A list of elementary operations as a NumPy function on all particles at once, and as one compiled loop over them.

Constants are arguments of the generated code, so that models that differ only in their numbers share one compilation.
"""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from meanfield.errors import InvalidModel

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from meanfield.symbolic import Instruction

_SAME = "exp log sin cos tan sinh cosh tanh sqrt sign floor ceil log1p expm1"
_INVERSE = "sin cos tan sinh cosh tanh"
TEMPLATES = {
    "assign": "{0}", "add": "{0} + {1}", "sub": "{0} - {1}", "mul": "{0} * {1}", "div": "{0} / {1}", "neg": "-{0}",
    "sq": "{0} * {0}", "twice": "2.0 * {0}", "inv": "1.0 / {0}", "fabs": "np.abs({0})", "pow": "{0} ** {1}",
    "constpow": "{0} ** {1}", "fmin": "np.minimum({0}, {1})", "fmax": "np.maximum({0}, {1})",
    "atan2": "np.arctan2({0}, {1})", "hypot": "np.hypot({0}, {1})", "lt": "1.0 * ({0} < {1})",
    "le": "1.0 * ({0} <= {1})", "eq": "1.0 * ({0} == {1})", "ne": "1.0 * ({0} != {1})", "not": "1.0 * ({0} == 0)",
    "and": "1.0 * (({0} != 0) & ({1} != 0))", "or": "1.0 * (({0} != 0) | ({1} != 0))",
    "if_else_zero": "np.where({0} != 0, {1}, 0.0)",
    **{name: f"np.{name}({{0}})" for name in _SAME.split()},
    **{f"a{name}": f"np.arc{name}({{0}})" for name in _INVERSE.split()},
}  # fmt: skip
# Sums of this many particles are added up apart, so that rounding does not grow with their number.
BLOCK = 2048


class Body(NamedTuple):
    """Generated lines: those that are the same for all particles, those for each, and the name of each output."""

    common: tuple[str, ...]
    each: tuple[str, ...]
    outputs: tuple[str, ...]
    constants: tuple[float, ...]


def body(program: Sequence[Instruction], inputs: Sequence[str], particle: Sequence[bool]) -> Body:
    """Write a program down line by line.

    Parameters
    ----------
    inputs
        one format per input of the program, with the element in place of ``{}``.
    particle
        whether an input belongs to the particle, so that what depends on it is computed for each.
    """
    common: list[str] = []
    each: list[str] = []
    constants: list[float] = []
    named: dict[int, tuple[str, bool]] = {}
    outputs: dict[tuple[int, int], str] = {}
    for number, step in enumerate(program):
        if step.operation == "output":
            outputs[step.place, step.result] = named[step.arguments[0]][0]
        elif step.operation == "input":
            place, element = step.arguments
            named[step.result] = (inputs[place].format(element), particle[place])
        elif step.operation == "const":
            named[step.result] = (f"numbers[{len(constants)}]", False)
            constants.append(step.constant)
        else:
            arguments = [named[k] for k in step.arguments]
            own = any(is_own for _, is_own in arguments)
            lines = each if own else common
            lines.append(f"t{number} = {_formula(step.operation, [name for name, _ in arguments])}")
            named[step.result] = (f"t{number}", own)
    return Body(tuple(common), tuple(each), tuple(outputs[k] for k in sorted(outputs)), tuple(constants))


def _formula(operation: str, names: Sequence[str]) -> str:
    if operation not in TEMPLATES:
        raise InvalidModel(f"the operation {operation} in a function of the model: allowed are {', '.join(TEMPLATES)}")
    return TEMPLATES[operation].format(*names)


def vectorised(
    program: Sequence[Instruction], inputs: Sequence[str], particle: Sequence[bool]
) -> Callable[..., list[NDArray[np.float64]]]:
    """A NumPy function of the inputs: arrays (Q, n) of what belongs to particles, (n,) of what does not.

    Returns
    -------
    function
        of all inputs in order; gives the elements of all outputs one after another, each of shape (Q,) or ().
    """
    forms = [f"{name}[:, {{}}]" if own else f"{name}[{{}}]" for name, own in zip(inputs, particle, strict=True)]
    text = body(program, forms, particle)
    lines = [f"def f({', '.join(inputs)}, numbers):", *text.common, *text.each, f"return [{', '.join(text.outputs)}]"]
    function = _executed("\n    ".join(lines))
    constants = np.array(text.constants)
    return lambda *values: function(*values, constants)


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
    kernel = _compiled(_loop(text, nx, weights))
    constants = np.array(text.constants)
    return lambda X, P, w, y, v, U: kernel(X, P, w, y, v, constants, U)


def _loop(text: Body, nx: int, weights: Sequence[str]) -> str:
    """The source of a loop in blocks over all particles."""
    sums = text.outputs[nx:]
    lines = ["def kernel(X, P, w, y, v, numbers, U):", f"    total = np.zeros({len(sums)})"]
    lines += [f"    {line}" for line in text.common]
    lines += ["    n = X.shape[0]", f"    for begin in range(0, n, {BLOCK}):"]
    lines += [f"        s{k} = 0.0" for k in range(len(sums))]
    lines += [f"        for i in range(begin, min(begin + {BLOCK}, n)):"]
    lines += [f"            {line}" for line in text.each]
    lines += [f"            U[i, {k}] = {name}" for k, name in enumerate(text.outputs[:nx])]
    lines += [f"            s{k} += {weights[k]}({name})" for k, name in enumerate(sums)]
    lines += [f"        total[{k}] += s{k}" for k in range(len(sums))]
    lines += [f"    total[{k}] /= n" for k in range(len(sums)) if not weights[k]]
    return "\n".join([*lines, "    return total", ""])


@cache
def _executed(source: str) -> Any:
    """The function that a generated source defines."""
    place: dict[str, Any] = {"np": np, "math": math}
    exec(compile(source, "<model>", "exec"), place)
    return place["f"] if "f" in place else place["kernel"]


@cache
def _compiled(source: str) -> Any:
    """A generated loop, compiled; sums may be reordered, which changes their last bits only."""
    from numba import njit

    return njit(nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz", "arcp"})(_executed(source))
