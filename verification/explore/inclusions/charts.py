"""Charts of error and overlap of an inclusion, in time and against dt, as options of ECharts."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal, NamedTuple, TypeGuard

import numpy as np

from verification.explore.inclusions.problems import METHODS, Floats
from verification.explore.inclusions.runs import Measured

What = Literal["error", "overlap"]

COLOURS = dict(zip(METHODS, ("#d55e00", "#b8860b", "#0072b2", "#00966e", "#c2003d", "#a0599a"), strict=True))
# A run makes at least and at most so many steps: powers of 2.
COARSEST, FINEST = 2, 12
# Projections are made to a tolerance of 1e-11: what is smaller than this is drawn as if it were 0, at the lower end of
# a chart, which spans at least so many decades.
ZERO, DECADES = 1e-10, 4
LARGEST = 1e100  # of a number that is drawn; it is outside anyway
TICKS = (4, 3, 5)  # intervals that an axis may have, where it need not be longer for them the first ones
GREY = "#8a8a8a"
FEW = 32  # points of a line that are marked
CROSS = "path://M2,0L0,2L4,6L0,10L2,12L6,8L10,12L12,10L8,6L12,2L10,0L6,4Z"
TITLES = {"error": "error", "overlap": "overlap"}


class Compared(NamedTuple):
    """Runs of several methods with the same steps, among those of other steps.

    Attributes
    ----------
    known
        What was measured, by method and number of steps.
    methods, pictured, steps
        What is looked at, and which of the methods is in the picture.
    end, size
        Where the runs end, and how large the scene is: a method that goes beyond has left it, and its chart.
    """

    known: Mapping[tuple[str, int], Measured]
    methods: Sequence[str]
    pictured: str
    steps: int
    end: float
    size: float

    def largest(self, what: What, method: str, steps: int) -> float | None:
        """Return the largest value of a run that is known and reached its end."""
        found = self.known.get((method, steps))
        values = None if found is None or found.fault else _values(found, what)
        return None if values is None else float(values.max())

    def left(self) -> int:
        """Return how many runs are not known yet."""
        return sum((method, 2**k) not in self.known for method in self.methods for k in range(COARSEST, FINEST + 1))

    def order(self, method: str) -> float | None:
        """Return the slope of the error between 2 dt and dt, where the error is neither 0 nor out of range."""
        coarse, fine = (self.largest("error", method, steps) for steps in (self.steps // 2, self.steps))
        return math.log2(coarse / fine) if self._fits(coarse) and self._fits(fine) else None

    def _fits(self, error: float | None) -> TypeGuard[float]:
        return error is not None and ZERO < error <= self.size


def in_time(what: What, runs: Compared) -> dict[str, Any]:
    """Return error or overlap at the steps."""
    found = {method: runs.known.get((method, runs.steps)) for method in runs.methods}
    lines = {method: (one.t, _values(one, what)) for method, one in found.items() if one is not None}
    known = {method: (t, values) for method, (t, values) in lines.items() if values is not None}
    span = _span((values for _, values in known.values()), runs.size)
    series = [_line(runs, method, t, values, span) for method, (t, values) in known.items()]
    return _chart(f"{what} at the steps", series, span) | {"xAxis": _axis("t", type="value", min=0, max=runs.end)}


def against_dt(what: What, runs: Compared) -> dict[str, Any]:
    """Chart the largest error or overlap of runs against dt, with slopes of order 1 and 2; failed runs are crossed."""
    lines, failed = {}, []
    for method in runs.methods:
        values = {2**k: runs.largest(what, method, 2**k) for k in range(COARSEST, FINEST + 1)}
        known = {runs.end / steps: value for steps, value in values.items() if value is not None}
        lines[method] = np.array(list(known)), np.array(list(known.values()))
        faults = (runs.end / 2**k for k in range(COARSEST, FINEST + 1) if _failed(runs, method, 2**k))
        failed += [(dt, COLOURS[method]) for dt in faults]
    span = _span((values for _, values in lines.values()), runs.size)
    series = [_line(runs, method, dt, values, span) for method, (dt, values) in lines.items()]
    series += [_guide(order, runs, span) for order in (1, 2)]
    series.append(_crosses(failed, span[1]))
    ends = {"min": runs.end / 2**FINEST, "max": runs.end / 2**COARSEST}
    dts = _axis("dt", type="log", **ends, axisLabel=_labels("") | {"showMinLabel": False, "showMaxLabel": False})
    return _chart(f"largest {what} against dt", series, span) | {"xAxis": dts}


def _failed(runs: Compared, method: str, steps: int) -> bool:
    found = runs.known.get((method, steps))
    return found is not None and bool(found.fault)


def _values(found: Measured, what: What) -> Floats | None:
    values = found.error if what == "error" else found.overlap
    return values if values is not None and len(values) else None


def _span(values: Iterable[Floats], size: float) -> tuple[float, float]:
    """Return the lower and upper end of a chart, powers of 10, with room for what is 0."""
    seen = np.concatenate([np.zeros(0), *values])
    there = seen[(seen > ZERO) & (seen <= size)]
    if not len(there):
        return 10.0**-DECADES, 1.0
    high, low = math.ceil(math.log10(there.max())), math.floor(math.log10(there.min()))
    low = min(high - DECADES, low - bool((seen <= ZERO).any()))
    return 10.0 ** (high - min(ticks * math.ceil((high - low) / ticks) for ticks in TICKS)), 10.0**high


def _line(runs: Compared, method: str, x: Floats, values: Floats, span: tuple[float, float]) -> dict[str, Any]:
    points = np.column_stack((x, np.clip(values, span[0], LARGEST)))
    first = method == runs.pictured
    return {
        "type": "line",
        "name": method,
        "data": points.tolist(),
        "color": COLOURS[method],
        "lineStyle": {"width": 2.5 if first else 1.5},
        "symbol": "circle",
        "symbolSize": 6 if first else 5,
        "showSymbol": len(points) <= FEW,
        "z": 4 if first else 3,
    }


def _guide(order: int, runs: Compared, span: tuple[float, float]) -> dict[str, Any]:
    """Draw a line of slope ``order`` within the chart, from its upper right; the first one marks dt, too."""
    low, high = span
    largest = runs.end / 2**COARSEST
    last = max(runs.end / 2**FINEST, largest * (low / high) ** (1 / order))
    guide: dict[str, Any] = {
        "type": "line",
        "data": [[largest, high], [last, high * (last / largest) ** order]],
        "lineStyle": {"color": GREY, "type": "dotted", "width": 1},
        "symbol": "none",
        "silent": True,
        "tooltip": {"show": False},
        "endLabel": {"show": True, "formatter": f"{order}", "color": GREY, "offset": [2, -8]},
        "z": 1,
    }
    if order == 1:
        mark = {"lineStyle": {"color": "#333", "type": "solid", "width": 1}, "label": {"formatter": "dt"}}
        guide["markLine"] = mark | {"data": [{"xAxis": runs.end / runs.steps}], "symbol": "none", "silent": True}
    return guide


def _crosses(failed: Iterable[tuple[float, str]], high: float) -> dict[str, Any]:
    data = [{"value": [dt, high], "itemStyle": {"color": colour}} for dt, colour in failed]
    return {"type": "scatter", "data": data, "symbol": CROSS, "symbolSize": 9, "tooltip": {"show": False}, "z": 5}


def _chart(title: str, series: list[dict[str, Any]], span: tuple[float, float]) -> dict[str, Any]:
    decades = round(math.log10(span[1] / span[0]))
    value = f"v => v <= {span[0] * 1.01:g} ? 'at most {span[0]:.0e}' : v.toExponential(1)"
    return {
        "animation": False,
        "title": {"text": title, "left": 0, "top": 0, "textStyle": {"fontSize": 12, "fontWeight": "normal"}},
        "grid": {"left": 52, "right": 16, "top": 26, "bottom": 34},
        "tooltip": {"trigger": "axis", ":valueFormatter": value, "textStyle": {"fontSize": 11}, "confine": True},
        "yAxis": {
            "type": "log",
            "min": span[0],
            "max": span[1],
            "interval": next(decades // ticks for ticks in TICKS if decades % ticks == 0),
            "axisLabel": _labels("≤ ", span[0]),
        },
        "series": series,
    }


def _axis(name: str, **more: Any) -> dict[str, Any]:
    return {"name": name, "nameLocation": "middle", "nameGap": 20, "splitLine": {"show": False}, **more}


def _labels(at_least: str, least: float = 0.0) -> dict[str, Any]:
    """Return numbers at an axis, 0.01, 0.1, 1, 10 or 1e-3; the least one with words."""
    number = "(v >= 0.00999 && v < 1000 ? String(+v.toPrecision(3)) : v.toExponential(0))"
    return {":formatter": f"v => (v <= {least * 1.01:g} ? '{at_least}' : '') + {number}", "fontSize": 11}
