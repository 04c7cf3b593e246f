"""Functions of a model as lists of elementary operations, and the compiled interpreter that evaluates them.

An operation acts on a block of particles at once, so that reading the list costs little beside the arithmetic. Results
that are the same for all particles are computed once. No model needs a compilation of its own.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.compiled import inner, kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.compiled.arrays import Floats

    Integers = NDArray[np.int64]

# Particles per block: the values of a block fit into the cache.
BLOCK = 256
# Elementary operations by CasADi's names in lower case; the place is the code of the operation.
OPERATIONS = (
    "assign", "add", "sub", "mul", "div", "neg", "sq", "twice", "inv", "exp", "sin", "cos", "fabs", "pow", "constpow",
    "fmin", "fmax", "atan2", "if_else_zero", "lt", "le", "eq", "ne", "not", "and", "or", "log", "tan", "sinh", "cosh",
    "tanh", "sqrt", "sign", "asin", "acos", "atan",
)  # fmt: skip
# pi/2 in three parts, of which the first two have 33 bits, so that their products with n < 2^20 are exact.
PARTS_OF_QUARTER = (1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21)
MAX_ANGLE, QUARTERS = 2.0**20, 2 / math.pi
# Coefficients of (sin r - r) / r^3 and of (cos r - 1 + r^2/2) / r^4 as polynomials in r^2, highest power first.
S = tuple((-1) ** k / math.factorial(2 * k + 1) for k in range(8, 0, -1))
C = tuple((-1) ** k / math.factorial(2 * k) for k in range(9, 1, -1))


class Program(NamedTuple):
    """Operations in order: first those that depend on common inputs, then on X alone, then on anything else.

    Every value has a slot: constants, common inputs, particle inputs, results.

    Attributes
    ----------
    code
        (n, 4): operation, slot of the result, slots of the arguments.
    parts
        (5,): ends of the first two groups of operations; first slots of the common inputs, of X, and of other inputs F.
    constants, outputs
        values of the constants (c,); slots of the outputs (k,).
    spread
        slots of common values that operations on particles or outputs read.
    values, common
        workspace: values of the slots (blocks, slots, BLOCK) for particles, (slots, 1) for common values. With as many
        blocks as the particles fill, results that depend on X alone are computed once.
    none
        (0, 0): inputs of a program that has none.
    """

    code: Integers
    parts: Integers
    constants: Floats
    outputs: Integers
    spread: Integers
    values: Floats
    common: Floats
    none: Floats

    def with_workspace(self, blocks: int = 1) -> Program:
        """Return the program with a workspace of its own."""
        slots = self.common.shape[0]
        return self._replace(values=np.empty((blocks, slots, BLOCK)), common=np.empty((slots, 1)))


@inner
def apply(operation: int, a: Floats, b: Floats, out: Floats) -> None:
    """Compute out = operation(a, b) for arrays (n,)."""
    n = out.size
    if operation == 1:
        for i in range(n):
            out[i] = a[i] + b[i]
    elif operation == 2:
        for i in range(n):
            out[i] = a[i] - b[i]
    elif operation == 3:
        for i in range(n):
            out[i] = a[i] * b[i]
    elif operation == 4:
        for i in range(n):
            out[i] = a[i] / b[i]
    elif operation == 5:
        for i in range(n):
            out[i] = -a[i]
    elif operation == 6:
        for i in range(n):
            out[i] = a[i] * a[i]
    elif operation == 7:
        for i in range(n):
            out[i] = 2.0 * a[i]
    elif operation == 8:
        for i in range(n):
            out[i] = 1.0 / a[i]
    elif operation == 9:
        for i in range(n):
            out[i] = math.exp(a[i])
    elif operation in (10, 11):
        _wave(a, 0.0 if operation == 10 else 1.0, out)
    else:
        for i in range(n):
            out[i] = _rare(operation, a[i], b[i])


@inner
def _wave(a: Floats, turn: float, out: Floats) -> None:
    """Compute out = sin(a + turn pi/2), turn = 0 or 1, with an error below 2e-16, by a loop without branches.

    a = n pi/2 + r with |r| <= pi/4, where n pi/2 is subtracted in three parts whose products with n are exact (Cody and
    Waite); then Taylor polynomials, whose next terms are below 1e-18. A block with larger angles is computed again.
    """
    far = 0
    for i in range(a.size):
        x = a[i]
        far += 0 if abs(x) <= MAX_ANGLE else 1
        n = np.rint(x * QUARTERS)
        r = ((x - n * PARTS_OF_QUARTER[0]) - n * PARTS_OF_QUARTER[1]) - n * PARTS_OF_QUARTER[2]
        z = r * r
        # Horner's scheme is written out because numba does not unroll a loop over a tuple.
        sine = ((((((S[0] * z + S[1]) * z + S[2]) * z + S[3]) * z + S[4]) * z + S[5]) * z + S[6]) * z + S[7]
        cosine = ((((((C[0] * z + C[1]) * z + C[2]) * z + C[3]) * z + C[4]) * z + C[5]) * z + C[6]) * z + C[7]
        quarter = n + turn
        half = np.floor(0.5 * quarter)
        value = 1.0 - (0.5 * z - z * z * cosine) if quarter != 2.0 * half else r + r * z * sine
        out[i] = value if half == 2.0 * np.floor(0.5 * half) else -value
    if far > 0:
        for i in range(a.size):
            out[i] = math.sin(a[i]) if turn == 0.0 else math.cos(a[i])


@inner
def _rare(operation: int, a: float, b: float) -> Any:
    """Compute one number by an operation that takes longer than the decision which one it is."""
    if operation == 0:
        return a
    if operation == 12:
        return abs(a)
    if operation in (13, 14):
        return a**b
    if operation == 15:
        return np.minimum(a, b)
    if operation == 16:
        return np.maximum(a, b)
    if operation == 17:
        return np.arctan2(a, b)
    if operation == 18:
        return b if a != 0.0 else 0.0
    if operation == 26:
        return np.log(a)
    if operation == 27:
        return np.tan(a)
    if operation == 28:
        return np.sinh(a)
    if operation == 29:
        return np.cosh(a)
    if operation == 30:
        return np.tanh(a)
    if operation == 31:
        return np.sqrt(a)
    if operation == 32:
        return np.sign(a)
    if operation == 33:
        return np.arcsin(a)
    if operation == 34:
        return np.arccos(a)
    if operation == 35:
        return np.arctan(a)
    return 1.0 if _is_true(operation, a, b) else 0.0


@inner
def _is_true(operation: int, a: float, b: float) -> bool:
    if operation == 19:
        return a < b
    if operation == 20:
        return a <= b
    if operation == 21:
        return a == b
    if operation == 22:
        return a != b
    if operation == 23:
        return a == 0.0
    if operation == 24:
        return a != 0.0 and b != 0.0
    return a != 0.0 or b != 0.0


@inner
def compute_common(p: Program, inputs: Floats) -> None:
    """Compute all values that depend on the common inputs (n,) alone."""
    common = p.common
    for k in range(p.constants.size):
        common[k, 0] = p.constants[k]
    for k in range(p.parts[3] - p.parts[2]):
        common[p.parts[2] + k, 0] = inputs[k]
    _run(p.code, common, 0, p.parts[0], 1)


@inner
def run_block(p: Program, block: int, fresh: bool, X: Floats, F: Floats, begin: int, n: int) -> None:
    """Compute all values of n particles from ``begin`` on; unless ``fresh``, those of X alone are there already."""
    values = p.values[block]
    for k in p.spread:
        row, value = values[k], p.common[k, 0]
        for i in range(n):
            row[i] = value
    if fresh:
        _read(values, p.parts[3], X, begin, n)
        _run(p.code, values, p.parts[0], p.parts[1], n)
    _read(values, p.parts[4], F, begin, n)
    _run(p.code, values, p.parts[1], p.code.shape[0], n)


@inner
def _read(values: Floats, slot: int, X: Floats, begin: int, n: int) -> None:
    for j in range(X.shape[1]):
        row = values[slot + j]
        for i in range(n):
            row[i] = X[begin + i, j]


@inner
def _run(code: Integers, values: Floats, begin: int, end: int, n: int) -> None:
    for k in range(begin, end):
        a, b, out = values[code[k, 2]], values[code[k, 3]], values[code[k, 1]]
        apply(code[k, 0], a[:n], b[:n], out[:n])


@kernel
def evaluate(p: Program, X: Floats, F: Floats, common: Floats, out: Floats) -> None:
    """Compute all outputs, a column of ``out`` each, for particle inputs X (Q, n), F (Q, m) and common inputs."""
    compute_common(p, common)
    for begin in range(0, X.shape[0], BLOCK):
        n = min(BLOCK, X.shape[0] - begin)
        run_block(p, 0, True, X, F, begin, n)
        for j in range(out.shape[1]):
            row = p.values[0, p.outputs[j]]
            for i in range(n):
                out[begin + i, j] = row[i]


def evaluated(p: Program, X: Floats, F: Floats, common: Floats) -> Floats:
    """Return all outputs of a program (Q, outputs), in a workspace of this call."""
    out = np.empty((len(X), len(p.outputs)))
    # For arrays that are read-only or not contiguous the kernel would be compiled again.
    X, F = (part if part.flags.writeable and part.flags.c_contiguous else part.copy() for part in (X, F))
    evaluate(p.with_workspace(), X, F, common, out)
    return out
