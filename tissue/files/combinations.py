"""Which values of a parameter file go together: each rule compares a few of them.

A rule that lacks one of its values, because that one is bad by itself, is left out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from itertools import pairwise
from typing import Any

from tissue.events.known import events, mark_of
from tissue.files.layer import Points, curve_of
from tissue.files.rule import Rule, show
from tissue.files.space_rules import SPACE_RULES, no_forces
from tissue.files.timing import NEVER, Timing
from tissue.files.units import Measure, reduced
from tissue.model.stiffness import LIMIT, cell_stiffness, junction_stiffness, least_substeps
from tissue.plugins import EmtEvent
from tissue.state.basal_curve import LINE, BasalCurve
from tissue.state.space import FLAT, SPATIAL

# Two descriptions of one value, such as "1/3 R_soft" and "5/3 um", differ by rounding; so do 0.1 h + 0.2 h and 0.3 h.
ROUNDING = 1e-12
# The unit of length among the values: types have a soft radius of their own, but not another unit.
UNIT = "R_soft"
# Above this a whole number of steps cannot be told from a fraction.
MOST_STEPS = 1e9
# Output times of one interval up to which their texts of six digits differ; of more the last are compared.
FEW_TIMES, LAST_TIMES = 1e5, 1000


def broken(values: Mapping[str, Any]) -> list[str]:
    """Return a line for each rule that the values break; ``values`` by keys such as "tissue.cells"."""
    return broken_of((*RULES, *SPACE_RULES, *waiting(), *no_forces()), values)


def waiting() -> list[Rule]:
    """Return the rules of events that wait for others."""
    return [_waits(event) for event in events() if event.after]


def broken_of(rules: Iterable[Rule], values: Mapping[str, Any]) -> list[str]:
    """Return a line for each of these rules that the values break."""
    lines = []
    if "cell.soft_radius" in values and UNIT not in values:
        values = {**values, UNIT: values["cell.soft_radius"]}
    for rule in rules:
        if not all(key in values for key in rule.keys):
            continue
        allowed = rule.allowed(*(values[key] for key in rule.keys))
        if allowed is not None:
            lines.append(f"{rule.keys[0]} = {show(values[rule.keys[0]])}: must be {allowed}")
    return lines


def _above(value: float, limit: float) -> bool:
    return value > limit * (1 + ROUNDING)


def _within(what: str, least: str = "") -> Callable[[Measure, Measure, Measure], str | None]:
    """Make the rule value <= limit for two lengths; ``what`` names the limit."""

    def allowed(value: Measure, limit: Measure, soft_radius: Measure) -> str | None:
        ok = not _above(reduced(value, soft_radius), reduced(limit, soft_radius))
        return None if ok else f"at most {what} = {show(limit)}{least}"

    return allowed


def _enlarged(enlarged: Measure, hard: Measure, soft: Measure) -> str | None:
    ok = not _above(reduced(hard, soft), reduced(enlarged, soft))
    return None if ok else f"at least cell.hard_radius = {show(hard)}"


def _cycle(longest: Measure, shortest: Measure) -> str | None:
    return f"at least cell.min_cycle = {show(shortest)}" if _above(shortest.value, longest.value) else None


def _phases(shortest: Measure, g2: Measure, mitosis: Measure) -> str | None:
    ok = not _above(g2.value + mitosis.value, shortest.value)
    return None if ok else f"at least cell.g2 + cell.mitosis = {show(g2)} + {show(mitosis)}"


def _whole_steps(time: Measure, dt: Measure) -> str | None:
    steps = time.value / dt.value
    ok = steps <= MOST_STEPS and abs(steps - round(steps)) <= ROUNDING * steps
    return None if ok else f"a whole number of steps numerics.dt = {show(dt)}, at most {MOST_STEPS:g} of them"


def _kept(keep: Measure | tuple[Measure, ...], dt: Measure) -> str | None:
    wrong = [_whole_steps(time, dt) for time in (keep if isinstance(keep, tuple) else (keep,))]
    return next(filter(None, wrong), None)


def _before_the_end(keep: Measure | tuple[Measure, ...], end: Measure) -> str | None:
    ok = not isinstance(keep, tuple) or not _above(keep[-1].value, end.value)
    return None if ok else f"a list of times up to numerics.t_end = {show(end)}"


def _apart(keep: Measure | tuple[Measure, ...], end: Measure, dt: Measure) -> str | None:
    """Check that tables of studies, whose columns end in the output time as ":g", have one for each."""
    if _whole_steps(end, dt) or _kept(keep, dt):
        return None  # other rules say so
    if isinstance(keep, tuple):
        times = sorted({0.0, *(time.value for time in keep), end.value})
    elif keep.value >= end.value / FEW_TIMES:
        return None
    else:
        last = math.floor(end.value / keep.value * (1 + ROUNDING))
        times = [keep.value * k for k in range(max(0, last - LAST_TIMES), last + 1)]
    for one, other in pairwise(times):
        if f"{one:g}" == f"{other:g}" and _above(other, one):
            return f"times that differ in six digits: {one!r} h and {other!r} h are both written {one:g} h"
    return None


def _short_for_cells(
    substeps: int,
    dt: Measure,
    mu: Measure,
    power: int,
    factor: float,
    repulsion: float,
    bending: float,
    apical: float,
    basal: float,
    soft: Measure,
    unit: Measure,
) -> str | None:
    """Check that substeps are stable for cells by themselves and for pairs of nuclei."""
    found = cell_stiffness(bending, apical, basal, factor * repulsion, power, reduced(soft, unit))
    return _short(substeps, dt, mu, found, "of cells (cell.alpha_ax, alpha_bx, alpha_axb, alpha_xx)")


def _short_for_junctions(
    substeps: int, dt: Measure, mu: Measure, factor: float, alpha: float, cells: int, dimension: int
) -> str | None:
    found = junction_stiffness(factor * alpha, cells, in_space=dimension == SPATIAL)
    return _short(substeps, dt, mu, found, "of junctions (cell.alpha_aa)")


def _short(substeps: int, dt: Measure, mu: Measure, stiffness: float, of: str) -> str | None:
    least = least_substeps(dt.value, mu.value, stiffness)
    if substeps >= least:
        return None
    step = f"dt/(substeps mu) = {dt.value / mu.value / substeps:.3g}"
    return f"at least {least}: {step} must be below {LIMIT / stiffness:.3g}, 2 over the stiffness {of}, to be stable"


def _fit(
    cells: int, dimension: int, shape: str, nuclei: str, part: tuple[float, float], *lengths: Measure
) -> str | None:
    """Check the number of discs: at most 1 + h/d + w (2 h/(sqrt(3) d^2) + 1/d) in a rectangle w x h  (Oler, 1961).

    The rectangle is the box of the nuclei at the start; its width is (cells - 1) spacing where each nucleus begins
    above its own basal point. Fewer may fit, and cells that start in mitosis need more room; but above this number no
    start without overlap exists. Where the layer bends, and in space, only drawing tells.
    """
    height, width, spacing, radius, _ = (reduced(length, lengths[-1]) for length in lengths)
    if shape != "line" or dimension != FLAT or radius == 0:
        return None
    up, d = (part[1] - part[0]) * height, 2 * radius
    per_width = 2 * up / (math.sqrt(3) * d**2) + 1 / d
    if nuclei == "own_basal":
        per_cell = spacing * per_width
        most = 1 + up / d / (1 - per_cell) if per_cell < 1 else math.inf
    else:
        most = 1 + up / d + width * per_width
    if not _above(cells, most):
        return None
    return (
        f"at most {math.floor(most * (1 + ROUNDING))}: more hard discs of radius {radius:.4g} R_soft do not fit where "
        f"start.nuclei = {show(nuclei)} puts their centres"
    )


def _curve(_: Points, *layer: Any) -> str | None:
    """``layer``: as of ``curve_of``."""
    try:
        curve_of(*layer)
    except ValueError as error:
        return str(error)
    return None


def _bends(height: Measure, *layer: Any) -> str | None:
    """Below a height the normals of the inner side of a curve do not meet."""
    largest = _curve_or_line(*layer).largest_curvature
    if largest * reduced(height, layer[-1]) < 1:
        return None
    return f"below {1 / largest:.4g} R_soft, the smallest curvature radius of the basal layer on the side of the tissue"


def _spread(cells: int, dimension: int, largest: Measure, *layer: Any) -> str | None:
    """Check that the basal points of a ring go around it within (C2)."""
    if dimension != FLAT:
        return None
    curve, most = _curve_or_line(*layer), reduced(largest, layer[-1])
    if not curve.ring or cells * most >= curve.length * (1 - ROUNDING):
        return None
    least = math.ceil(curve.length / most * (1 - ROUNDING))
    return f"at least {least}: of fewer the basal points do not go around, {curve.length:.4g} R_soft, within (C2)"


def _curve_or_line(*layer: Any) -> BasalCurve:
    """Return the curve, or the line where ``_curve`` refuses the values."""
    try:
        return curve_of(*layer)
    except ValueError:
        return LINE


def _in_the_middle(group: int, cells: int) -> str | None:
    """Check that EMT cells have neighbours: without control cells no layer would be left to measure in."""
    most = max(0, cells - 2)
    return None if group <= most else f"at most {most}: EMT cells have control cells on both sides"


def _waits(event: EmtEvent) -> Rule:
    """Make the rule of an event that waits for another one: it never begins without that one."""
    keys = (f"emt.{event.name}", f"emt.{event.after}")

    def allowed(waiting: Timing, first: Timing) -> str | None:
        if not waiting.ever or first.ever:
            return None
        return f'"{NEVER}": [{event.mark}] waits for [{mark_of(str(event.after))}], and {keys[1]} = {show(first)}'

    return Rule(keys, allowed)


# How long substeps may be for cells: also for those of each type.
SHORT_FOR_CELLS = Rule(
    (
        *("numerics.substeps", "numerics.dt", "numerics.mu", "rules.spring_power", "rules.repulsion_factor"),
        *("cell.alpha_xx", "cell.alpha_axb", "cell.alpha_ax", "cell.alpha_bx", "cell.soft_radius", UNIT),
    ),
    _short_for_cells,
)
SHAPE = tuple(f"layer.{name}" for name in ("shape", "perimeter", "aspect", "points", "side", "closed"))
LAYER = (*SHAPE, "cell.soft_radius")
# Of the distance of basal neighbours.
OF_NEIGHBOURS = (
    Rule(("tissue.cells", "tissue.dimension", "tissue.max_basal_distance", *SHAPE, UNIT), _spread),
    Rule(
        ("tissue.basal_spacing", "tissue.max_basal_distance", UNIT),
        _within("tissue.max_basal_distance", ": otherwise the start breaks (C2)"),
    ),
)
RULES = (
    Rule(("layer.points", *LAYER), _curve),
    Rule(("tissue.height", *LAYER), _bends),
    Rule(("emt.cells", "tissue.cells"), _in_the_middle),
    Rule(("cell.hard_radius", "cell.soft_radius", UNIT), _within("cell.soft_radius")),
    Rule(("cell.enlarged_radius", "cell.soft_radius", UNIT), _within("cell.soft_radius")),
    Rule(("cell.enlarged_radius", "cell.hard_radius", UNIT), _enlarged),
    Rule(("cell.max_cycle", "cell.min_cycle"), _cycle),
    Rule(("cell.min_cycle", "cell.g2", "cell.mitosis"), _phases),
    *OF_NEIGHBOURS,
    SHORT_FOR_CELLS,
    Rule(
        (
            *("numerics.substeps", "numerics.dt", "numerics.mu", "rules.junction_factor", "cell.alpha_aa"),
            *("tissue.cells", "tissue.dimension"),
        ),
        _short_for_junctions,
    ),
    Rule(("numerics.t_end", "numerics.dt"), _whole_steps),
    Rule(("numerics.keep", "numerics.dt"), _kept),
    Rule(("numerics.keep", "numerics.t_end"), _before_the_end),
    Rule(("numerics.keep", "numerics.t_end", "numerics.dt"), _apart),
    Rule(
        (
            "tissue.cells",
            "tissue.dimension",
            "layer.shape",
            "start.nuclei",
            "start.nuclei_height",
            "tissue.height",
            "tissue.width",
            "tissue.basal_spacing",
            "cell.hard_radius",
            "cell.soft_radius",
        ),
        _fit,
    ),
)
