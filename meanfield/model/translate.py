"""A list of elementary operations as lines of Python, and as a NumPy function on all particles at once.

Constants are arguments of the generated code, so that models that differ only in their numbers share one compilation.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.errors import InvalidProblem

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

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


class Instruction(NamedTuple):
    """One elementary operation: ``value[result] = operation(value[arguments])``.

    For "input" the arguments are (number of the input, element), for "output" the result is element ``result`` of
    output ``place``; elements of matrices are counted column by column.
    """

    operation: str
    result: int
    arguments: tuple[int, ...]
    constant: float = 0.0
    place: int = 0


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
        raise InvalidProblem(
            f"the operation {operation} in a function of the model: allowed are {', '.join(TEMPLATES)}"
        )
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
    function = executed("\n    ".join(lines))
    constants = np.array(text.constants)
    return lambda *values: function(*values, constants)


@cache
def executed(source: str) -> Any:
    """The function that a generated source defines."""
    place: dict[str, Any] = {"np": np}
    exec(compile(source, "<model>", "exec"), place)
    return place["f"]
