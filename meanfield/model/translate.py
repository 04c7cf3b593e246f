"""Translation of elementary operations to lines of Python, and to a NumPy function of all particles at once.

Constants are arguments of the generated code: models that differ only in their constants share one compilation.
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

    For "input", the arguments are (number of the input, element). For "output", the result is element ``result`` of
    output number ``place``. Elements of matrices are counted column by column.
    """

    operation: str
    result: int
    arguments: tuple[int, ...]
    constant: float = 0.0
    place: int = 0


class Body(NamedTuple):
    """Generated lines, ``common`` to all particles and ``per_particle``, names of the outputs, and constants."""

    common: tuple[str, ...]
    per_particle: tuple[str, ...]
    outputs: tuple[str, ...]
    constants: tuple[float, ...]


def body(program: Sequence[Instruction], inputs: Sequence[str], particle: Sequence[bool]) -> Body:
    """Generate the lines of a program.

    Parameters
    ----------
    inputs
        one format string per input of the program; ``{}`` stands for the element.
    particle
        whether an input belongs to a particle; results that depend on such inputs are computed per particle.
    """
    common: list[str] = []
    per_particle: list[str] = []
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
            varies = any(argument_varies for _, argument_varies in arguments)
            lines = per_particle if varies else common
            lines.append(f"t{number} = {_formula(step.operation, [name for name, _ in arguments])}")
            named[step.result] = (f"t{number}", varies)
    return Body(tuple(common), tuple(per_particle), tuple(outputs[k] for k in sorted(outputs)), tuple(constants))


def _formula(operation: str, names: Sequence[str]) -> str:
    if operation not in TEMPLATES:
        raise InvalidProblem(
            f"the operation {operation} in a function of the model: allowed are {', '.join(TEMPLATES)}"
        )
    return TEMPLATES[operation].format(*names)


def vectorised(
    program: Sequence[Instruction], inputs: Sequence[str], particle: Sequence[bool]
) -> Callable[..., list[NDArray[np.float64]]]:
    """Translate a program to a NumPy function.

    Returns
    -------
    function
        of all inputs in order: arrays (Q, n) for inputs of particles, (n,) for others. It returns the elements of all
        outputs in order, each of shape (Q,) or ().
    """
    forms = [f"{name}[:, {{}}]" if varies else f"{name}[{{}}]" for name, varies in zip(inputs, particle, strict=True)]
    text = body(program, forms, particle)
    header, result = f"def f({', '.join(inputs)}, numbers):", f"return [{', '.join(text.outputs)}]"
    function = define("\n    ".join([header, *text.common, *text.per_particle, result]))
    constants = np.array(text.constants)
    return lambda *values: function(*values, constants)


@cache
def define(source: str) -> Any:
    """Return the function ``f`` that generated source code defines."""
    namespace: dict[str, Any] = {"np": np}
    exec(compile(source, "<model>", "exec"), namespace)
    return namespace["f"]
