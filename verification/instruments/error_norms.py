"""Errors of a run against a reference: the largest over time, at a time, of overlap, and of quantities of the state."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import dincl
from dincl.checks import describe
from verification.instruments.references import Known

Floats = NDArray[np.float64]
Quantity = Callable[..., Any]
Errors = str | float | Quantity | Sequence["str | float | Quantity"] | Mapping[str, "str | float | Quantity"]
# Step of the difference quotients that carry the error of a reference over to a quantity, relative to the coordinates.
DIFFERENCE = 1e-7


class Computed(NamedTuple):
    """States of a run at the K output times, (K, N, d), and the largest error that the run states, NaN if none."""

    x: Floats
    stated: float = np.nan


def distance(x: Floats, y: Floats) -> Floats:
    """Return max_i |X_i - Y_i| at each time, shape (K,), for x, y of shape (K, N, d) or (K, d) [length]."""
    far: Floats = np.sqrt(((x - y) ** 2).sum(axis=-1)).reshape(len(x), -1).max(axis=-1)
    return far


def error_of(x: Floats, known: Known) -> Floats:
    """Return max_i |X_i - exact| at each time, shape (K,), for x (K, N, d) [length]."""
    off = known.off(x)
    return distance(off, np.zeros_like(off))


def _largest(problem: Any, answer: Computed, known: Known) -> float:
    return float(error_of(answer.x, known).max())


def _final(problem: Any, answer: Computed, known: Known) -> float:
    return float(error_of(answer.x, known)[-1])


def _overlap(problem: Any, answer: Computed, known: Known) -> float:
    if not isinstance(problem, dincl.Problem):
        return np.nan
    return max(problem.violation(float(t), state) for t, state in zip(known.t, answer.x, strict=True))


def _stated(problem: Any, answer: Computed, known: Known) -> float:
    return answer.stated


Norm = Callable[[Any, Computed, Known], float]
NORMS: Mapping[str, Norm] = {
    "largest": _largest,
    "final": _final,
    "overlap": _overlap,
    "stated": _stated,
}
LABELS = {
    "largest": "largest error over time [length]",
    "final": "error at the end [length]",
    "overlap": "largest overlap [length]",
    "stated": "error that the run states [length]",
}


def label(error: str) -> str:
    """Return the label of an axis."""
    return LABELS.get(error, f"error at {error} [length]" if error.startswith("t = ") else f"error of {error}")


def heading(error: str) -> str:
    """Return the heading of a column."""
    return label(error)[0].upper() + label(error)[1:]


@dataclass(frozen=True)
class ErrorAt:
    """Error max_i |X_i - exact| at one of the output times [length]."""

    t: float

    def __call__(self, problem: Any, answer: Computed, known: Known) -> float:
        """Return the error of a run; InvalidProblem if t is no output time."""
        known.take([self.t])
        return float(error_of(answer.x, known)[np.abs(known.t - self.t).argmin()])


@dataclass(frozen=True)
class ErrorOf:
    """Largest error over time of a quantity q(x) of the state: max_k |q(x_k) - q(reference_k)|."""

    name: str
    quantity: Quantity

    def __call__(self, problem: Any, answer: Computed, known: Known) -> float:
        """Return the error of a run; infinite where the quantity is not finite, or raises."""
        exact = [self._value(state) for state in known.x]
        try:
            found = [np.asarray(self.quantity(state), dtype=np.float64) for state in answer.x]
        except Exception:  # noqa: BLE001  # it is defined for the states of the reference, and not for these
            return np.inf
        error = max(np.abs(a - b).max() for a, b in zip(found, exact, strict=True))
        return float(error) if np.isfinite(error) else np.inf

    def of_reference(self, known: Known) -> float:
        """Return the largest over t of sum_ij |dq/dX_ij| e, the first order of the reference's stated error e in q."""
        worst = 0.0
        for state, error in zip(known.x, known.error, strict=True):
            here, h = self._value(state), DIFFERENCE * max(1.0, float(np.abs(state).max()))
            slopes = np.zeros_like(here)
            for index in np.ndindex(state.shape):
                moved = state.copy()
                moved[index] += h
                slopes += np.abs(self._value(moved) - here) / h
            worst = max(worst, float(slopes.max() * error))
        return worst

    def _value(self, state: Floats) -> Floats:
        try:
            found = self.quantity(state)
            value = np.asarray(found, dtype=np.float64)
        except Exception as error:
            raise dincl.InvalidProblem(
                f"errors: {self.name!r} raised {type(error).__name__}: {error} for a state of shape {state.shape} of "
                "the reference: must give a finite number, or an array of them"
            ) from error
        if not value.size or not np.isfinite(value).all():
            raise dincl.InvalidProblem(
                f"errors: {self.name!r} gave {describe(found)} for a state of shape {state.shape} of the reference: "
                "must give a finite number, or an array of them"
            )
        return value


def checked_errors(errors: Errors) -> dict[str, Norm]:
    """Return the errors by their names, one at least.

    Parameters
    ----------
    errors
        A name of ``NORMS``, an output time t, a function x -> quantity (a number or an array) of states x (N, d),
        several of these, or a mapping from names to them. A time is named "t = 1", a function after itself, a lambda
        "quantity".

    Raises
    ------
    InvalidProblem
        For an unknown name, or an object that is neither a name nor a time nor a function.
    """
    if isinstance(errors, Mapping):
        pairs = list(errors.items())
    else:
        given = list(errors) if isinstance(errors, Iterable) and not isinstance(errors, str) else [errors]
        pairs = [(_name(error), error) for error in given]
    found: dict[str, Norm] = {}
    for name, error in pairs:
        if isinstance(error, str) and error in NORMS:
            found[name] = NORMS[error]
        elif isinstance(error, int | float):
            found[name] = ErrorAt(float(error))
        elif callable(error):
            found[name] = (
                error if isinstance(error, ErrorAt | ErrorOf) or error in NORMS.values() else ErrorOf(name, error)
            )
        else:
            raise dincl.InvalidProblem(
                f"errors = {describe(error)}: must be one or more of {', '.join(NORMS)}, output times, or functions of "
                "the state"
            )
    if not found or len(found) < len(pairs):
        names = ", ".join(name for name, _ in pairs)
        raise dincl.InvalidProblem(f"errors = {names or 'nothing'}: must be one or more errors with different names")
    return found


def _name(error: object) -> str:
    if isinstance(error, int | float):
        return f"t = {error:g}"
    name = error if isinstance(error, str) else getattr(error, "__name__", type(error).__name__)
    return "quantity" if name == "<lambda>" else str(name)


def measured(problem: Any, answer: Computed, known: Known, errors: Mapping[str, Norm]) -> dict[str, float]:
    """Return the errors of a run, NaN if it did not arrive."""
    arrived = bool(np.isfinite(answer.x).all())
    return {name: error(problem, answer, known) if arrived else np.nan for name, error in errors.items()}


def of_reference(known: Known, errors: Mapping[str, Norm]) -> dict[str, float]:
    """Return the columns of the reference's own error: of positions, and of each quantity."""
    found = {"reference_error": float(known.error.max())}
    quantities = {name: error for name, error in errors.items() if isinstance(error, ErrorOf)}
    return found | {_column(name): error.of_reference(known) for name, error in quantities.items()}


def reference_error(rows: pd.DataFrame, error: str) -> pd.Series:
    """Return the reference's own error in ``error``, one for each row; what needs no reference has none."""
    if error in ("overlap", "stated"):
        return pd.Series(0.0, rows.index)
    return rows[_column(error) if _column(error) in rows else "reference_error"]


def _column(error: str) -> str:
    return f"reference_error_{error}"
