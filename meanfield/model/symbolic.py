"""Symbolic derivatives of a model; the only module of this package that imports CasADi."""

from __future__ import annotations

import re
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.callables import UserFunction
from dincl.checks import describe, plain
from dincl.errors import FunctionFailed, InvalidProblem
from dincl.extras import needs
from dincl.status import Status
from meanfield.kernels.program import BLOCK, OPERATIONS, Program

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence


def library() -> Any:
    """Import CasADi on first use."""
    with needs("A model of meanfield", "meanfield"):
        import casadi

    return casadi


def expressions(functions: Mapping[str, Any], nx: int, ny: int) -> SimpleNamespace:
    """Differentiate the functions of a model, a mapping with keys g, W0, W1 and V; V is None without interaction.

    Returned are the symbols X (nx), y, v (ny), U, r (nx), and expressions derived from the Lagrangian (5.8):
    level = g(X, y), gX = dg/dX, gy = dg/dy, phi = -gX^{-1} gy (5.9), omega = Omega[v, v] (5.10), determinant = det gX,
    turning = its rate along (U, v), curvature = D^2 g[(U, v), (U, v)], F0 = -grad W0(y), F1 = -grad W1(X),
    K = grad V(r) with r = X_k - X_i (5.4), W0, W1 and V. Without interaction V = K = 0.

    Raises
    ------
    FunctionFailed
        if a function of the model raises; its exception is the cause.
    InvalidProblem
        if a function does not return an expression of the right shape in its arguments.
    """
    ca = library()
    X, U, r = (ca.SX.sym(name, nx) for name in ("X", "U", "r"))
    y, v = (ca.SX.sym(name, ny) for name in ("y", "v"))
    level = _shaped(_expression("g", functions["g"], {"X": X, "y": y}), "g", nx)
    W0 = _shaped(_expression("W0", functions["W0"], {"y": y}), "W0", 1)
    W1 = _shaped(_expression("W1", functions["W1"], {"X": X}), "W1", 1)
    V = ca.SX(0) if functions["V"] is None else _shaped(_expression("V", functions["V"], {"r": r}), "V", 1)
    gX, gy = ca.jacobian(level, X), ca.jacobian(level, y)
    phi = affine(-gy / gX if nx == 1 else -ca.mtimes(ca.inv_minor(gX), gy), X)
    flow = ca.mtimes(phi, v)
    return SimpleNamespace(
        X=X,
        y=y,
        v=v,
        U=U,
        r=r,
        level=level,
        gX=gX,
        gy=gy,
        phi=phi,
        omega=affine(_derivative_along(flow, (X, y), (flow, v)), X),
        determinant=ca.det(gX),
        turning=_derivative_along(ca.det(gX), (X, y), (U, v)),
        curvature=_derivative_along(_derivative_along(level, (X, y), (U, v)), (X, y), (U, v)),
        F0=-ca.gradient(W0, y),
        F1=-ca.gradient(W1, X),
        K=ca.gradient(V, r),
        W0=W0,
        W1=W1,
        V=V,
    )


def affine(expression: Any, X: Any) -> Any:
    """Write an expression that is affine in X as value at 0 plus slope times X; return other expressions unchanged.

    In this form a particle needs one product per coordinate; the coefficients depend on y alone.
    """
    ca = library()
    column = ca.vec(expression)
    slope = ca.jacobian(column, X)
    if ca.jacobian(slope, X).nnz() > 0:
        return expression
    at_zero = ca.substitute(ca.vertcat(column, ca.vec(slope)), X, ca.SX.zeros(X.numel()))
    value, slope = at_zero[: column.numel()], at_zero[column.numel() :]
    straight = value + ca.mtimes(ca.reshape(slope, column.numel(), X.numel()), X)
    return ca.densify(ca.reshape(straight, *expression.shape))


def is_affine(expression: Any, symbols: Any) -> bool:
    """Return whether the second derivative of an expression vanishes symbolically."""
    ca = library()
    return bool(ca.jacobian(ca.jacobian(ca.vec(expression), symbols), symbols).nnz() == 0)


def _derivative_along(value: Any, symbols: tuple[Any, Any], direction: tuple[Any, Any]) -> Any:
    """Differentiate an expression in (X, y) along a direction."""
    ca = library()
    return sum(ca.jtimes(value, symbol, part) for symbol, part in zip(symbols, direction, strict=True))


def _expression(name: str, given: Any, symbols: dict[str, Any]) -> Any:
    """Express a function of the model in our symbols; it is a callable, or an expression in symbols of these names."""
    value = _call(name, given, symbols) if callable(given) else given
    try:
        expression = _convert(value)
    except MemoryError:
        raise
    except Exception as error:
        signature = f"{name}({', '.join(symbols)})"
        raise InvalidProblem(f"{signature} = {describe(value)}: must be built from CasADi operations") from error
    return expression if callable(given) else _substitute_symbols(name, expression, symbols)


def _convert(value: Any) -> Any:
    """Convert an expression, numbers, or a list of both, to one expression; TypeError for anything else.

    Other values do not reach CasADi, which iterates endlessly over an infinite iterator and crashes the process on an
    array with three axes.
    """
    ca = library()
    if isinstance(value, (ca.SX, ca.DM)):
        return ca.SX(value)
    if isinstance(value, np.ndarray) and value.dtype.kind == "O":
        value = list(value.flat)
    if isinstance(value, (list, tuple)) and any(isinstance(part, ca.SX) for part in value):
        return ca.vertcat(*(part if isinstance(part, ca.SX) else _convert(part) for part in value))
    numbers = plain(value)
    if numbers is None or numbers.ndim > 2:
        raise TypeError("not an expression")
    return ca.SX(ca.DM(numbers))


def _call(name: str, given: Callable[..., Any], symbols: dict[str, Any]) -> Any:
    """Call a user's function with symbols."""
    try:
        return UserFunction(name, tuple(symbols), Status.FUNCTION_FAILED).call(given, *symbols.values())
    except FunctionFailed as failed:
        detail = f"{failed.detail} It must be built from CasADi operations."
        raise FunctionFailed(failed.status, detail) from failed.__cause__


def _substitute_symbols(name: str, expression: Any, symbols: dict[str, Any]) -> Any:
    """Replace the user's symbols X, y (or X_0, X_1, ...) by our symbols of the same names."""
    ca = library()
    ours = {}
    for symbol, vector in symbols.items():
        ours.update({symbol: vector[0]} if vector.numel() == 1 else {})
        ours.update({f"{symbol}_{k}": vector[k] for k in range(vector.numel())})
    used = ca.symvar(expression)
    unknown = sorted({s.name() for s in used} - ours.keys())
    if unknown:
        raise InvalidProblem(f"{name} contains the symbol {unknown[0]}: allowed are {', '.join(sorted(ours))}")
    return ca.substitute(expression, ca.vertcat(*used), ca.vertcat(*(ours[s.name()] for s in used)))


def _shaped(expression: Any, name: str, rows: int) -> Any:
    """Return an expression as a dense column of ``rows`` components."""
    ca = library()
    if expression.numel() != rows:
        raise InvalidProblem(f"{name} has {expression.numel()} components: must have {rows}")
    return ca.densify(ca.vec(expression))


def program(X: Any, F: Any, common: Any, outputs: Sequence[Any]) -> Program:
    """List the elementary operations that compute outputs from X, other particle inputs F, and common inputs.

    Outputs are matrices, whose elements are outputs of the program, column by column. Common subexpressions are
    computed once.

    Raises
    ------
    InvalidProblem
        if a function of the model has an operation that the interpreter does not know.
    """
    ca = library()
    function = ca.Function("f", [common, X, F], ca.cse([ca.densify(ca.vec(e)) for e in outputs]))
    names = {getattr(ca, n): n.removeprefix("OP_").lower() for n in dir(ca) if re.fullmatch(r"OP_[A-Z0-9_]+", n)}
    steps = range(function.n_instructions())
    constants = [function.instruction_constant(k) for k in steps if names[function.instruction_id(k)] == "const"]
    first = np.cumsum([len(constants), common.numel(), X.numel(), F.numel()])
    # Slots of the values in CasADi's places, which it uses again, and the inputs that they depend on.
    at: dict[int, tuple[int, frozenset[int]]] = {}
    code: list[tuple[int, tuple[int, int, int, int]]] = []
    found: dict[tuple[int, int], int] = {}
    used, slot = 0, int(first[-1])
    for k in steps:
        operation = names[function.instruction_id(k)]
        result, arguments = function.instruction_output(k), function.instruction_input(k)
        if operation == "output":
            found[result[0], result[1]] = at[arguments[0]][0]
        elif operation == "const":
            at[result[0]], used = (used, frozenset()), used + 1
        elif operation == "input":
            at[result[0]] = int(first[arguments[0]]) + arguments[1], frozenset(arguments[:1])
        else:
            if operation not in OPERATIONS:
                raise InvalidProblem(
                    f"the operation {operation} in a function of the model: allowed are {', '.join(OPERATIONS)}"
                )
            read = [at[place] for place in arguments]
            inputs = frozenset().union(*(inputs for _, inputs in read))
            group = 0 if inputs <= {0} else 1 if inputs == {1} else 2
            code.append((group, (OPERATIONS.index(operation), slot, read[0][0], read[-1][0])))
            at[result[0]], slot = (slot, inputs), slot + 1
    common_slots = {*range(int(first[1])), *(line[1] for group, line in code if group == 0)}
    needed = {line[k] for group, line in code if group > 0 for k in (2, 3)} | {*found.values()}
    ends = np.cumsum([sum(group == k for group, _ in code) for k in (0, 1)])
    return Program(
        code=np.array([line for _, line in sorted(code, key=lambda pair: pair[0])], dtype=np.int64).reshape(-1, 4),
        parts=np.array([*ends, *first[:3]], dtype=np.int64),
        constants=np.array(constants, dtype=np.float64),
        outputs=np.array([found[place] for place in sorted(found)], dtype=np.int64),
        spread=np.array(sorted(needed & common_slots), dtype=np.int64),
        values=np.empty((0, slot, BLOCK)),
        common=np.empty((slot, 1)),
        none=np.empty((0, 0)),
    )
