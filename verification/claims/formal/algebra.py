"""Proofs by computer algebra: residuals that vanish for all values of their symbols, and sums of squares."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import product
from typing import Any

from dincl.extras import needs
from verification.claims import FormalProof, Technique
from verification.claims.formal import Step, refuse_unless_refuted

# Far above what is lost in DIGITS digits, and below the residual of a wrong variant at the point of ``_point``.
SEEN, DIGITS = 1e-20, 40


def library() -> Any:
    """Return sympy; MissingLibrary says that a proof needs it."""
    with needs("a proof by computer algebra", "proofs"):
        import sympy
    return sympy


def matrices(names: str) -> Any:
    """Return symbols for matrices and vectors of any size: their products do not commute."""
    return library().symbols(names, commutative=False)


def vanishes(right: Any, wrong: Any, said: str = "", rejects: str = "") -> Step:
    """Return the proof that an expression is zero for all values of its symbols and for all functions in it.

    Parameters
    ----------
    right, wrong
        An expression, a matrix or a sequence of them each: all of ``right`` simplify to zero, one of ``wrong`` differs
        from zero at a point.
    said, rejects
        See ``Step``.
    """
    return Step(partial(_identity, right, wrong), said, rejects)


def _identity(right: Any, wrong: Any, statement: str, rejected: str) -> FormalProof:
    true = all(map(_vanishes, _entries(right)))
    refuse_unless_refuted(any(map(_differs, _entries(wrong))), statement, rejected)
    return FormalProof(statement, Technique.IDENTITY, f"sympy {library().__version__}", true, rejected)


def squares(right: Any, wrong: Any, parts: Sequence[tuple[Any, Any]], said: str = "", rejects: str = "") -> Step:
    """Return the proof that a polynomial is at least 0, the sum of c q^2 over the pairs (c, q), all c >= 0.

    The polynomial ``wrong`` is negative at a point; ``said``, ``rejects``: see ``Step``.
    """
    return Step(partial(_squares, right, wrong, parts), said, rejects)


def _squares(right: Any, other: Any, squares: Sequence[tuple[Any, Any]], statement: str, wrong: str) -> FormalProof:
    sympy = library()
    total = sum(c * q**2 for c, q in squares)
    true = bool(all(sympy.sympify(c).is_nonnegative for c, _ in squares) and _vanishes(right - total))
    refuse_unless_refuted(_negative_somewhere(other), statement, wrong)
    certificate = " + ".join(f"{c}*({q})**2" for c, q in squares)
    return FormalProof(statement, Technique.SQUARES, f"sympy {sympy.__version__}", true, wrong, certificate)


def _entries(residual: Any) -> Iterator[Any]:
    """Yield scalar residuals of expressions, matrices and sequences of them."""
    sympy = library()
    if isinstance(residual, list | tuple):
        for part in residual:
            yield from _entries(part)
    elif isinstance(residual, sympy.MatrixBase):
        yield from residual
    else:
        yield sympy.sympify(residual)


def _vanishes(residual: Any) -> bool:
    """Return whether an expression simplifies to zero, by increasing cost."""
    sympy = library()
    expanded = sympy.expand(residual.doit())
    if expanded == 0 or not expanded.is_commutative:
        return bool(expanded == 0)
    return bool(sympy.cancel(sympy.together(expanded)) == 0 or sympy.simplify(expanded) == 0)


def _differs(residual: Any) -> bool:
    """Return whether an expression is not zero at a point; words of matrices are zero only if they cancel."""
    sympy = library()
    expanded = sympy.expand(residual.doit())
    if not expanded.is_commutative:
        return bool(expanded != 0)
    return bool(abs(sympy.N(_at_a_point(expanded), DIGITS)) > SEEN)


def _at_a_point(expression: Any) -> Any:
    """Return the value for one choice of its functions and symbols."""
    sympy = library()
    undefined = sympy.core.function.AppliedUndef
    outermost = sorted(expression.atoms(undefined), key=lambda each: (-len(each.atoms(undefined)), str(each)))
    for k, function in enumerate(dict.fromkeys(each.func for each in outermost)):
        expression = expression.replace(function, partial(_some_function, k)).doit()
    symbols = sorted(expression.free_symbols, key=str)
    return expression.subs({symbol: sympy.Rational(sympy.prime(k + 3), 13) for k, symbol in enumerate(symbols)})


def _some_function(k: int, *arguments: Any) -> Any:
    """Return a smooth function without symmetries, another one for each k."""
    sympy = library()
    wave = sum(sympy.Rational(2 + k + i, 3) * each for i, each in enumerate(arguments))
    return sympy.sin(wave + k + 1) + arguments[0] ** 3


def _negative_somewhere(polynomial: Any) -> bool:
    """Return whether a polynomial is negative at a point with small coordinates."""
    symbols = sorted(polynomial.free_symbols, key=str)
    values = [[value for value in (-1, 0, 1, 2) if value > 0 or not symbol.is_positive] for symbol in symbols]
    return any(polynomial.subs(dict(zip(symbols, point, strict=True))) < 0 for point in product(*values))
