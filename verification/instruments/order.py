"""The order of convergence from measured errors, with its uncertainty and with what must be left out to see it.

Asymptotically error = C h^p, a line of slope p in (log h, log error). Real measurements have a coarse end that has not
reached it, a fine end where rounding or the reference covers the error, and runs that failed. Every step size stays
visible as a row with its role; only the rows "used" enter the fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import stdtrit

from verification.instruments.asymptotic import (
    EPS,
    MIN_RANGE,
    ROUNDING_REACH,
    SLOPE_DRIFT,
    Floats,
    asymptotic_start,
    line,
    reference_shift,
    resolution_of,
)

MIN_STEPS = 5  # step sizes wanted from the caller
MIN_POINTS = 3  # usable errors for a slope: two fix the line, the third is the only witness of its scatter
MIN_RATIO = 1.01  # of neighbouring step sizes; closer ones measure noise divided by almost nothing
CONFIDENCE = 0.95
FLOOR_FACTOR = 3.0  # an error below three times the resolution of its reference is not resolved
SCATTER = 0.35  # residual deviation per mean log step ratio; pairwise slopes then deviate by 0.35 sqrt(2) = 0.5

Failures = Sequence[bool | Enum] | NDArray[np.bool_] | None
Role = Literal["used", "pre-asymptotic", "floor", "failed"]
Indices = NDArray[np.intp]


@dataclass(frozen=True)
class Row:
    """One step size with its role; ``slope`` is that from the next coarser row, None if either has no log error."""

    h: float
    error: float
    slope: float | None
    role: Role
    reason: str


@dataclass(frozen=True)
class Order:
    """error = constant h^slope on rows[first] ... rows[last]; rows run from the coarsest to the finest step.

    ``interval`` is the 95 % interval of the slope: Student's t on the residuals, plus the largest change that an error
    ``resolution`` of the reference can cause. It knows of scatter, not of a drift that is left (see ``drifting``).
    Where no order can be read, slope, interval, constant [error / h^slope], first and last are None.
    """

    rows: tuple[Row, ...]
    resolution: float
    slope: float | None = None
    interval: tuple[float, float] | None = None
    constant: float | None = None
    first: int | None = None
    last: int | None = None
    exact: bool = False  # all errors are rounding
    scattered: bool = False  # errors fall in the mean, but not from step to step
    drifting: bool = False  # the slopes in the range still change, all in one direction
    diverging: bool = False  # errors grow as h falls
    rising: bool = False  # the error of the finest step exceeds the two before it

    def count(self, role: Role) -> int:
        """Count the rows of one role, such as the coarse ones left out as "pre-asymptotic"."""
        return sum(row.role == role for row in self.rows)

    @property
    def verdict(self) -> str:
        """One sentence: the order found, and the steps left out."""
        names: dict[Role, str] = {"pre-asymptotic": "pre-asymptotic", "floor": "at the floor", "failed": "failed"}
        parts = [f"{self.count(role)} {name}" for role, name in names.items() if self.count(role)]
        left_out = f" (left out: {', '.join(parts)})" if parts else ""
        if self.slope is None or self.interval is None:
            return f"{_why_none(self)}{left_out}."
        return f"{_finding(self, self.slope, self.interval)}{left_out}."


def estimate(
    h: ArrayLike, error: ArrayLike, floor: float = 0.0, failed: Failures = None, *, scale: float = 1.0
) -> Order:
    """Fit log error = log C + p log h on the asymptotic range.

    Floor: errors up to ``FLOOR_FACTOR`` times the resolution, which is ``floor``, at least eps ``scale``, or more where
    errors stop falling close above. Pre-asymptotic range: coarse points go one by one, down to four, while one of two
    F tests at ``REFUTE_LEVEL`` refutes a line and the slope changes by more than ``SLOPE_DRIFT``: the test of c = 0 in
    log error = log C + p log h + c h, and Chow's, whether the line through the finer points predicts the coarser.

    Arguments
    ---------
    h : (K,) step sizes > 0 in any order, K >= 5, neighbours at least 1 % apart [time]
    error : (K,) errors >= 0; NaN and infinity are failed runs [unit of the quantity]
    floor : own error of the reference, or any other resolution of the measurement [unit of the quantity]
    failed : (K,) mask, True for a failed run; or members of an Enum that are true for success, as ``dincl.Status``
    scale : size of the quantity, whose rounding is eps scale [unit of the quantity]

    Returns
    -------
    Order

    Raises
    ------
    ValueError : for other input than is listed above

    Source
    ------
    G. C. Chow, Tests of equality between sets of coefficients in two linear regressions, Econometrica 28 (1960).
    """
    steps, errors = _checked(h, error)
    for name, value in (("floor", floor), ("scale", scale)):
        if not (np.isfinite(value) and value >= 0.0):
            raise ValueError(f"{name} = {value!r}, but it must be finite and >= 0")
    coarse_first = np.argsort(-steps)
    reasons = _reasons(errors, failed)
    steps, errors, reasons = steps[coarse_first], errors[coarse_first], [reasons[i] for i in coarse_first]
    done = np.flatnonzero([not reason for reason in reasons])
    resolution = resolution_of(steps[done], errors[done], floor, scale)
    usable = done[errors[done] > FLOOR_FACTOR * resolution]
    x, y = np.log(steps[usable]), np.log(errors[usable])
    start = asymptotic_start(x, y, resolution) if usable.size >= MIN_POINTS else 0
    roles: list[Role] = ["failed"] * steps.size
    parts: list[tuple[Indices, Role]] = [(done, "floor"), (usable[:start], "pre-asymptotic"), (usable[start:], "used")]
    for members, role in parts:
        for i in members:
            roles[i] = role
    rows = _rows(steps, errors, roles, reasons)
    if usable.size < MIN_POINTS:
        exact = done.size >= MIN_POINTS and usable.size == 0 and resolution <= ROUNDING_REACH * EPS * scale
        return Order(rows, resolution, exact=exact)
    return _fitted(rows, x[start:], y[start:], resolution)


def order_text(order: Order) -> str:
    """Return the order for a table cell: "1.00 [0.98, 1.03]", with "scattered" or "drifting" behind it; or a word.

    "exact", "none", or "does not fall": the error of the finest step exceeds the two before it.
    """
    if order.slope is None or order.interval is None:
        return "exact" if order.exact else "none"
    return "does not fall" if order.rising and not order.diverging else _slope_text(order.slope, order.interval, order)


def _slope_text(value: float, interval: tuple[float, float], order: Order) -> str:
    slope, low, high = (f"{value:.2f}".replace("-0.00", "0.00") for value in (value, *interval))
    notes = (", scattered" if order.scattered else "") + (", drifting" if order.drifting else "")
    return f"{slope} [{low}, {high}]{notes}"


def _checked(h: ArrayLike, error: ArrayLike) -> tuple[Floats, Floats]:
    steps, errors = np.asarray(h, dtype=np.float64), np.asarray(error, dtype=np.float64)
    if steps.ndim != 1 or steps.shape != errors.shape:
        raise ValueError(f"h has shape {steps.shape} and error {errors.shape}, but both must have the same shape (K,)")
    if steps.size < MIN_STEPS:
        raise ValueError(f"h has {steps.size} step sizes, but an order needs at least {MIN_STEPS}")
    for value in steps[~(np.isfinite(steps) & (steps > 0.0))]:
        raise ValueError(f"h contains {value}, but step sizes must be finite and > 0")
    for small, large in pairwise(np.sort(steps)):
        if large < MIN_RATIO * small:
            raise ValueError(f"h contains {small} and {large}, but step sizes must be distinct, by 1 % at least")
    for value in errors[errors < 0.0]:
        raise ValueError(f"error contains {value}, but errors must be >= 0, or NaN for a failed run")
    return steps, errors


def _reasons(errors: Floats, failed: Failures) -> list[str]:
    """Return why each run failed; empty for a success."""
    entries = [False] * errors.size if failed is None else list(failed)
    if len(entries) != errors.size:
        raise ValueError(f"failed has {len(entries)} entries, but it must have one per error, {errors.size}")
    for entry in entries:
        if not isinstance(entry, bool | np.bool_ | Enum):
            message = f"failed contains {entry!r}, but its entries must be bool or members of a status Enum"
            raise ValueError(message)  # noqa: TRY004  (bad input is a ValueError everywhere in this project)
    return [_reason(entry, value) for entry, value in zip(entries, errors, strict=True)]


def _reason(entry: bool | np.bool_ | Enum, error: float) -> str:
    succeeded = bool(entry) if isinstance(entry, Enum) else not entry
    if not succeeded:
        return entry.name if isinstance(entry, Enum) else "marked as failed"
    return "" if np.isfinite(error) else f"error is {error}"


def _rows(h: Floats, error: Floats, roles: list[Role], reasons: list[str]) -> tuple[Row, ...]:
    has_log = [role != "failed" and value > 0.0 for role, value in zip(roles, error, strict=True)]
    slopes: list[float | None] = [None] * h.size
    for i in range(1, h.size):
        if has_log[i - 1] and has_log[i]:
            slopes[i] = float((np.log(error[i]) - np.log(error[i - 1])) / (np.log(h[i]) - np.log(h[i - 1])))
    return tuple(map(Row, h.tolist(), error.tolist(), slopes, roles, reasons))


def _fitted(rows: tuple[Row, ...], x: Floats, y: Floats, resolution: float) -> Order:
    """Fit the used rows and look at the fit."""
    slope, intercept, squares = line(x, y)
    spread = float(np.sqrt(squares / (x.size - 2)))
    shift = reference_shift(x, y, resolution)
    half = shift + float(stdtrit(x.size - 2, 0.5 + 0.5 * CONFIDENCE)) * spread / float(np.sqrt(x.size) * np.std(x))
    with np.errstate(over="ignore", under="ignore"):  # C is the error at h = 1, perhaps far outside of the range
        constant = float(np.exp(intercept))
    used = [i for i, row in enumerate(rows) if row.role == "used"]
    slopes = np.diff(y) / np.diff(x)
    one_way = x.size > MIN_POINTS and abs(np.sum(np.sign(np.diff(slopes)))) == x.size - 2
    # The two bends of four points agree by chance in one of four cases: they count if coarser points drifted before.
    known = x.size > MIN_RANGE or any(row.role == "pre-asymptotic" for row in rows)
    return Order(
        rows,
        resolution,
        slope,
        (slope - half, slope + half),
        constant,
        used[0],
        used[-1],
        scattered=bool(slope > 0.0 and not one_way and spread > SCATTER * (x[0] - x[-1]) / (x.size - 1)),
        drifting=bool(known and one_way and abs(slopes[0] - slopes[-1]) > SLOPE_DRIFT + shift),
        diverging=slope + half < -SLOPE_DRIFT,
        rising=bool(y[-1] > max(y[-2], y[-3])),
    )


def _why_none(order: Order) -> str:
    size, covered = len(order.rows), order.count("floor")
    usable = size - covered - order.count("failed")
    if order.exact:
        return f"The method is exact to rounding: no error of {covered} exceeds {FLOOR_FACTOR * order.resolution:.1e}"
    if usable == 0 and covered > 0:
        return f"No order can be read: {covered} of {size} errors are covered by the resolution {order.resolution:.1e}"
    return f"No order can be read: {usable} of {size} errors are usable, {MIN_POINTS} are needed"


def _finding(order: Order, slope: float, interval: tuple[float, float]) -> str:
    if order.diverging:
        says = "The error grows as h falls"
    elif order.rising:
        says = "The error does not fall with h: that of the finest step exceeds the two before it"
    elif interval[0] <= SLOPE_DRIFT:
        says = "No convergence is shown"
    else:
        says = "The error falls with h"
    scatter = " and the errors scatter about their trend instead of following it" if order.scattered else ""
    drift = " and the slopes still change in one direction" if order.drifting else ""
    fitted = _slope_text(slope, interval, order)
    return f"{says}{scatter}{drift}: order {fitted}, 95 % interval, {order.count('used')} step sizes"
