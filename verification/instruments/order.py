"""The order of convergence from measured errors: local orders, their range, and whether they have settled.

Asymptotically error = C h^p, a line of slope p in (log h, log error). Real measurements have a coarse end that has not
reached it, a fine end where rounding or the reference covers the error, and runs that failed. Every step size stays
visible as a row with its role; only the rows "used" enter the fit.

Errors of a deterministic method are no random sample, so that a regression gives no confidence interval. What can be
said is local: the order between each two neighbouring steps, log(e_i / e_j) / log(h_i / h_j). If the last of them still
differ, or follow a trend that does not end, the errors are not yet asymptotic, and no order is shown.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import fdtri

MIN_STEPS = 5  # step sizes wanted from the caller
MIN_POINTS = 3  # usable errors for a slope: two fix the line, the third is the only witness of its scatter
MIN_RATIO = 1.01  # of neighbouring step sizes; closer ones measure noise divided by almost nothing
FLOOR_FACTOR = 3.0  # an error below three times the resolution of its reference is not resolved
LAST = 3  # local orders that must agree: two differences, the least that show a trend
SETTLED = 0.1  # largest difference of the last local orders that counts as settled, as 0.1 is asked of an order
TAIL = 2.0  # times which a trend of local orders is continued beyond its geometric limit, as its ratio is uncertain
GROWING = 6.0  # steps by which a trend is continued that does not shrink
STEADY = 1e-3  # a change of local orders in one direction that does not shrink over three steps, and is larger, goes on
EPS = float(np.finfo(np.float64).eps)
MIN_RANGE = 4  # the search for the asymptotic range never goes below this
REFUTE_LEVEL = 0.005  # chance, per test, to refute a range that is straight up to normal noise in log error
SLOPE_DRIFT = 0.05  # a change of slope that is not worth a shorter range: half of the 0.1 asked of an order
ROUNDING_REACH = 1000.0  # rounding of a whole run may add up to this many eps * scale
REFERENCE_REACH = 10.0  # a reference may be this much worse than stated, if the errors stop falling there
STALLED_SLOPE = 0.25  # near the floor, errors that fall more slowly than h^0.25 have stopped falling

Floats = NDArray[np.float64]
Failures = Sequence[bool | Enum] | NDArray[np.bool_] | None
Role = Literal["used", "pre-asymptotic", "floor", "failed"]
Indices = NDArray[np.intp]


@dataclass(frozen=True)
class Row:
    """One step size with its role; ``slope`` is the local order from the next coarser row, None without a log error."""

    h: float
    error: float
    slope: float | None
    role: Role
    reason: str


@dataclass(frozen=True)
class Order:
    """error = constant h^slope on rows[first] ... rows[last]; rows run from the coarsest to the finest step.

    ``interval`` is the range of the local orders between the used rows, continued by the trend of the last ones to its
    limit if they have settled; it holds all slopes that the fit can have if the reference is wrong by ``resolution``.
    It is no confidence interval; it holds the order if later steps do what the last ones do. Unless the local orders
    have ``settled``, the errors are not yet asymptotic: the last three differ, or their trend leads, by more than 0.1
    and what the reference explains, or they are fewer than three. Where no order can be read, slope, interval,
    constant [error / h^slope], first and last are None.
    """

    rows: tuple[Row, ...]
    resolution: float
    slope: float | None = None
    interval: tuple[float, float] | None = None
    constant: float | None = None
    first: int | None = None
    last: int | None = None
    exact: bool = False  # all errors are rounding
    settled: bool = False  # the last local orders agree, and their trend ends close by
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
    """Return the order for a table cell: "1.00 [0.98, 1.03]", perhaps with "not yet asymptotic" behind it; or a word.

    "exact", "none", or "does not fall": the error of the finest step exceeds the two before it.
    """
    if order.slope is None or order.interval is None:
        return "exact" if order.exact else "none"
    return "does not fall" if order.rising and not order.diverging else _slope_text(order.slope, order.interval, order)


def _slope_text(value: float, interval: tuple[float, float], order: Order) -> str:
    slope, low, high = (f"{value:.2f}".replace("-0.00", "0.00") for value in (value, *interval))
    return f"{slope} [{low}, {high}]" + ("" if order.settled else ", not yet asymptotic")


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
    """Fit the used rows and look at their local orders."""
    slope, intercept, _ = line(x, y)
    with np.errstate(over="ignore", under="ignore"):  # C is the error at h = 1, perhaps far outside of the range
        constant = float(np.exp(intercept))
    used = [i for i, row in enumerate(rows) if row.role == "used"]
    local = np.diff(y) / np.diff(x)
    change = np.zeros(y.size) if resolution == 0.0 else -np.log1p(-np.exp(np.log(resolution) - y))
    doubt = (change[1:] + change[:-1]) / np.abs(np.diff(x))  # of each local order, by an error of the reference
    trend = _trend(local)
    apart = max(float(np.ptp(local[-LAST:])), *map(abs, trend))
    settled = local.size >= LAST and apart <= SETTLED and not _goes_on(local, doubt)
    below, above = (trend[0] - doubt[-1], trend[1] + doubt[-1]) if settled else (0.0, 0.0)
    shift = reference_shift(x, y, resolution)
    interval = (
        min(float(local.min()), slope - shift, float(local[-1] + below)),
        max(float(local.max()), slope + shift, float(local[-1] + above)),
    )
    return Order(
        rows,
        resolution,
        slope,
        interval,
        constant,
        used[0],
        used[-1],
        settled=settled,
        diverging=interval[1] < -SLOPE_DRIFT,
        rising=bool(y[-1] > max(y[-2], y[-3])),
    )


def _goes_on(local: Floats, doubt: Floats) -> bool:
    """Return whether three changes are in one direction and do not shrink: another order may follow.

    They are the last ones up to the finest that an error of the reference does not explain.
    """
    changes = np.diff(local)
    unexplained = np.flatnonzero(np.abs(changes) > doubt[1:] + doubt[:-1])
    changes = changes[: unexplained[-1] + 1][-LAST:] if unexplained.size else changes[:0]
    one_way = bool((changes > 0).all() or (changes < 0).all())
    return changes.size == LAST and one_way and abs(changes[-1]) >= max(abs(changes[0]), STEADY)


def _trend(local: Floats) -> tuple[float, float]:
    """Return how far below and above the last local order the next ones may lead.

    Differences of one sign that shrink by a ratio r, as of error = C h^p (1 + a h^q) with r = 2^-q, lead by r / (1 - r)
    times the last one; ``TAIL`` allows for a ratio that is not exact. Differences that grow lead on; those of both
    signs lead as far as the last one to both sides.
    """
    *_, before, last = np.diff(local, prepend=local[0])
    if local.size < LAST or before * last <= 0:
        return -abs(float(last)), abs(float(last))
    ratio = float(last / before)
    lead = float(last) * (GROWING if ratio >= 1 else min(TAIL * ratio / (1 - ratio), GROWING / SETTLED))
    return min(lead, 0.0), max(lead, 0.0)


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
    if not order.settled and not order.rising and not order.diverging:
        local = [row.slope for row in order.rows if row.slope is not None and row.role == "used"][-LAST:]
        says = f"Not yet asymptotic, local orders {', '.join(f'{one:.2f}' for one in local)}. {says}"
    fitted = _slope_text(slope, interval, order)
    return f"{says}: order {fitted}, range of the local orders, {order.count('used')} step sizes"


def resolution_of(h: Floats, error: Floats, floor: float, scale: float) -> float:
    """Return the size of what covers the error: as stated, or the largest error that stopped falling close above it."""
    reach = max(REFERENCE_REACH * floor, ROUNDING_REACH * EPS * scale)
    stalled = (error[1:] >= error[:-1] * (h[1:] / h[:-1]) ** STALLED_SLOPE) & (error[1:] <= reach)
    return float(np.max(error[1:][stalled], initial=max(floor, EPS * scale)))


def line(x: Floats, y: Floats) -> tuple[float, float, float]:
    """Fit a least squares line: slope, value at x = 0, sum of squared residuals."""
    centred = x - x.mean()
    slope = float(centred @ y / (centred @ centred))
    residual = y - y.mean() - slope * centred
    return slope, float(y.mean() - slope * x.mean()), float(residual @ residual)


def reference_shift(x: Floats, y: Floats, resolution: float) -> float:
    """Return sum_i |w_i| |log(1 - resolution / error_i)|, the largest change of the slope by such errors."""
    if resolution == 0.0:
        return 0.0
    centred = x - x.mean()
    return float(np.abs(centred) @ -np.log1p(-np.exp(np.log(resolution) - y)) / (centred @ centred))


def _refutes(narrow: float, wide: float, extra: int, freedom: int, level: float) -> bool:
    """Return whether ``extra`` parameters lower the sum of squares from narrow to wide by more than chance (F test)."""
    return (narrow - wide) * freedom > float(fdtri(extra, freedom, 1.0 - level)) * extra * wide


def _drifts(x: Floats, y: Floats, resolution: float) -> bool:
    """Return whether a next term c h is significant and changes the slope p + c h noticeably along the range."""
    h = np.exp(x - x[0])
    model = np.column_stack([np.ones_like(x), x - x[0], h])
    parameters, *_ = np.linalg.lstsq(model, y)
    if abs(parameters[2]) * (1.0 - h[-1]) <= SLOPE_DRIFT + reference_shift(x, y, resolution):
        return False
    residual = y - model @ parameters
    return _refutes(line(x, y)[2], float(residual @ residual), 1, x.size - 3, REFUTE_LEVEL)


def _coarse_part_off(x: Floats, y: Floats, resolution: float) -> bool:
    """Return whether the line through the finer points fails, for some cut, to predict the coarser ones."""
    slope, _, squares = line(x, y)
    cuts = range(1, x.size - MIN_RANGE + 1)
    for cut in cuts:
        fine_slope, _, fine_squares = line(x[cut:], y[cut:])
        noticeable = abs(fine_slope - slope) > SLOPE_DRIFT + reference_shift(x[cut:], y[cut:], resolution)
        if noticeable and _refutes(squares, fine_squares, cut, x.size - cut - 2, REFUTE_LEVEL / len(cuts)):
            return True
    return False


def asymptotic_start(x: Floats, y: Floats, resolution: float) -> int:
    """Return the index of the coarsest point of the longest fine end that is one straight line."""
    start = 0
    while x.size - start > MIN_RANGE:
        fine = x[start:], y[start:], resolution
        if not (_drifts(*fine) or _coarse_part_off(*fine)):
            break
        start += 1
    return start
