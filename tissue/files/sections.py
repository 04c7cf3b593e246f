"""The sections of a parameter file: each key once, with its meaning, symbol, source, unit, range and default.

Messages, written files, ``tissue parameters`` and docs/reference/parameters.md take it from here (``keys.py``).
Validators of a section check its values against each other, ``tissue.files.together`` those of several sections.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    PlainSerializer,
    PlainValidator,
    Strict,
    create_model,
    model_validator,
)

from dincl.errors import InvalidProblem
from tissue.events.division import BESIDE, division_rules
from tissue.events.known import BUILT_IN, events, mark_of
from tissue.files import quantities as q
from tissue.files.own_modules import MODULES, read_modules
from tissue.files.quantities import NEVER, Allowed, Quantity, Timing, number, sized
from tissue.plugins import Force, registered
from tissue.state.basal_curve import LINE, BasalCurve, ellipse, through
from tissue.state.cells import PARAMETERS

T1, T2, T3, T5 = (f"Table {k} of chapter 3" for k in (1, 2, 3, 5))
CURVED = "chapter 3 names curved layers as further work"
DEEP = "chapter 3 names three dimensions as further work"
TYPESCRIPT = "the public TypeScript program"
# Two descriptions of one value, such as "1/3 R_soft" and "5/3 um", differ by rounding; so do 0.1 h + 0.2 h and 0.3 h.
ROUNDING = 1e-12
# Above this a whole number of steps cannot be told from a fraction.
MOST_STEPS = 1e9
# Output times of one interval.
MOST_TIMES = 100_000
MOST_TYPES = 8
# The types that have no name in files, by their numbers.
UNNAMED = ("control", "emt")
# Where a group is if not at a place: at random, or evenly over the tissue.
SCATTERED, APART = "scattered", "apart"
# The event that makes chains of cells.
CHAINS = "ac"
# The keys of a type of which a pair of cells has the mean, or the sum.
PAIR_KEYS = ("soft_radius", "alpha_xx", "max_basal_distance")


def key(meaning: str, source: str = "", symbol: str = "", default: Any = ...) -> Any:
    """Make the field of a key.

    ``meaning`` stands in a comment behind the value; ``source`` is where the thesis has it, or the row of the table of
    model variants; ``symbol`` is that of the thesis, such as "alpha^ax"; ``default`` is as in a file, and checked as a
    value from there, and without it the key has to be given.
    """
    return Field(default, title=symbol or None, description=meaning, json_schema_extra={"source": source})


def show(value: Any) -> str:
    """Write a checked value as a file would give it."""
    if isinstance(value, tuple):
        return f"[{', '.join(map(show, value))}]"
    return f'"{value}"' if isinstance(value, (str, Quantity, Timing)) else str(value)


def wrong(key: str, value: Any, allowed: str) -> InvalidProblem:
    """Make the error of a value that must be another one."""
    return InvalidProblem(f"{key} = {show(value)}: must be {allowed}")


def above(value: float, limit: float) -> bool:
    """Return whether a number is above a limit by more than rounding."""
    return value > limit * (1 + ROUNDING)


class Section(BaseModel):
    """A table of a file: all keys without default have to be given, no others, and nothing changes afterwards."""

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True)


def _known(names: Callable[[], Iterable[str]]) -> AfterValidator:
    """Allow names that are known when a file is read: files in own.modules register some."""

    def check(name: str) -> str:
        if name not in names():
            raise ValueError
        return name

    return AfterValidator(check)


def _place(raw: Any) -> float | str:
    if isinstance(raw, str) and raw in (APART, SCATTERED):
        return raw
    place = number(raw)
    if not isinstance(place, float) or not 0 <= place <= 1:
        raise ValueError
    return sized(place)


def _some_rules() -> str:
    return " or ".join(map(show, division_rules()))


EventName = Annotated[str, _known(lambda: [event.name for event in events()])]
ForceName = Annotated[str, _known(lambda: [force.name for force in registered(Force)])]
RuleName = Annotated[str, Allowed(_some_rules, "a name", (Strict(), _known(division_rules)))]
Modules = Annotated[tuple[str, ...], Allowed(MODULES, "files", (PlainValidator(read_modules), PlainSerializer(list)))]
PLACES = f'"{APART}" or "{SCATTERED}"'
Place = Annotated[
    float | str,
    Allowed(f"a number from 0 to 1, without unit, {PLACES}", f"0 to 1, {PLACES}", (PlainValidator(_place),)),
]


class UserKeys(Section):
    """Parameters that files of users register, by their names."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[
        Annotated[str, _known(lambda: PARAMETERS)],
        Annotated[Any, PlainSerializer(lambda value: str(value) if isinstance(value, Quantity) else value)],
    ]

    @model_validator(mode="after")
    def _values(self) -> UserKeys:
        for name, raw in self.__pydantic_extra__.items():
            with suppress(ValueError):
                self.__pydantic_extra__[name] = raw if isinstance(raw, Quantity) else PARAMETERS[name].read(raw)
                continue
            raise wrong(name, raw, PARAMETERS[name].allowed)
        return self

    def given(self) -> dict[str, Any]:
        """Return the values that are given, by name."""
        return dict(self.__pydantic_extra__)


class Own(UserKeys):
    """[own]: what is not in this package: files of users, and by their names the parameters that these register."""

    modules: Modules = key(
        "files, relative to this one, that register events, forces, observables or rules of divisions",
        "docs/tutorials/own_event.md",
        default=[],
    )

    def values(self) -> dict[str, Any]:
        """Return the values of all parameters of users, the default of one that is not given."""
        return {name: one.read(one.default) for name, one in PARAMETERS.items()} | self.given()


class Tissue(Section):
    """[tissue]: the layer of cells at the start, and its noise."""

    cells: q.Count = key("cells at the start", T1, "N^init")
    height: q.Length = key("height of the tissue at the start", T1, "h^init")
    width: q.Length = key("width of the box of the nuclei at the start", T1, "w^init")
    apical_spacing: q.Length = key("distance between apical points at the start", T1, "d^init-apical")
    basal_spacing: q.Length = key(
        "distance between basal points at the start", 'row "apical and basal spacing at start"'
    )
    max_basal_distance: q.Length = key(
        "maximal distance between neighbouring basal points", f"{T1}, (C2)", "d^max-basal"
    )
    two_daughters: q.Probability = key(
        "probability that both daughters of a division stay in the plane",
        "Table 1 and section 2.2.5 of chapter 3",
        "p^div",
    )
    diffusion: q.DiffusionOrZero = key("diffusion coefficient of the noise of nuclei", f"{T1}, (3.17)", "D")
    dimension: Literal[2, 3] = key(
        "dimension: a slice of the tissue, or the tissue in space, as [space] tells", DEEP, default=2
    )


class Cell(Section):
    """[cell]: one cell, its cycle and its forces."""

    soft_radius: q.MetricLength = key(
        "radius of the soft repulsion; that of [cell] is the unit of length R_soft", f"{T2}, (3.13)", "R^soft"
    )
    hard_radius: q.LengthOrZero = key("radius of non-overlap; 0: none", f"{T2}, (C1)", "R^hard")
    enlarged_radius: q.LengthOrZero = key("radius of non-overlap before division; 0: none", f"{T2}, (3.4)", "R^hard,G2")
    initial_rest_length: q.LengthOrZero = key("rest length of both cytoskeleton springs at the start", T2, "eta^init")
    max_cytoskeleton: q.LengthOrNone = key(
        "length that eta_ax + eta_bx tend to at most, or none", "none in chapter 3", default="none"
    )
    g2: q.DurationOrZero = key("duration of the G2 phase", "Table 2 and section 2.2.1 of chapter 3", "T^G2")
    mitosis: q.DurationOrZero = key("duration of mitosis", "Table 2 and section 2.2.1 of chapter 3", "T^mitosis")
    min_cycle: q.Duration = key("shortest duration of a cell cycle", f"{T2}, (3.1)", "T^min-cycle")
    max_cycle: q.Duration = key("longest duration of a cell cycle", f"{T2}, (3.1)", "T^max-cycle")
    rate_aa: q.RateOrZero = key("rate at which the rest length of an apical junction adapts", f"{T2}, (3.6)", "k^aa")
    rate_ax: q.RateOrZero = key(
        "rate at which the rest length of the apical-nuclei spring adapts", f"{T2}, (3.2)", "k^ax"
    )
    rate_bx: q.RateOrZero = key(
        "rate at which the rest length of the basal-nuclei spring adapts", f"{T2}, (3.3)", "k^bx"
    )
    alpha_aa: q.NonNegative = key("stiffness of the apical junctions", f"{T2}, (3.11)", "alpha^aa")
    alpha_ax: q.NonNegative = key("stiffness of the apical-nuclei spring", f"{T2}, (3.9)", "alpha^ax")
    alpha_bx: q.NonNegative = key("stiffness of the basal-nuclei spring", f"{T2}, (3.10)", "alpha^bx")
    alpha_xx: q.NonNegative = key("stiffness of the soft repulsion of nuclei", f"{T2}, (3.13)", "alpha^xx")
    alpha_axb: q.NonNegative = key(
        "stiffness of the bending spring, which keeps a cell straight", f"{T2}, (3.12)", "alpha^axb"
    )

    @model_validator(mode="after")
    def _together(self) -> Cell:
        self.check(self.soft_radius)
        return self

    def check(self, unit: Quantity) -> None:
        """Check radii and durations against each other; ``unit`` is R_soft."""
        hard, enlarged, soft = (one.over(unit) for one in (self.hard_radius, self.enlarged_radius, self.soft_radius))
        if above(enlarged, soft):
            raise wrong("enlarged_radius", self.enlarged_radius, f"at most soft_radius = {show(self.soft_radius)}")
        if above(hard, enlarged):
            raise wrong("enlarged_radius", self.enlarged_radius, f"at least hard_radius = {show(self.hard_radius)}")
        if above(self.min_cycle.value, self.max_cycle.value):
            raise wrong("max_cycle", self.max_cycle, f"at least min_cycle = {show(self.min_cycle)}")
        if above(self.g2.value + self.mitosis.value, self.min_cycle.value):
            phases = f"g2 + mitosis = {show(self.g2)} + {show(self.mitosis)}"
            raise wrong("min_cycle", self.min_cycle, f"at least {phases}")


class Numerics(Section):
    """[numerics]: the steps, and what is kept of a run."""

    dt: q.Duration = key("time between updates of rules and events", T3, "Delta t")
    substeps: q.Count = key("PBD steps in one dt", f"{T5}, (3.34)", "n^sub-steps")
    mu: q.Duration = key("damping coefficient", f"{T5}, (3.33)", "mu")
    noise: Literal["step", "substep"] = key("how often noise is added", "(3.35)")
    t_end: q.Duration = key("end of the run", 'row "end of runs"', "t^end")
    keep: q.OutputTimes = key("time between saved states, or the output times; start and end are among them")
    folded: Literal["leave out", "keep", "stop"] = key(
        "measures of a folded apical layer: left out of tables and answers, kept, or the run stops",
        "tissue/model/measures.py",
        default="leave out",
    )

    @model_validator(mode="after")
    def _together(self) -> Numerics:
        kept = self.keep if isinstance(self.keep, tuple) else (self.keep,)
        end = self.t_end.value
        for name, time in (("t_end", self.t_end), *(("keep", time) for time in kept)):
            steps = time.value / self.dt.value
            if steps > MOST_STEPS or abs(steps - round(steps)) > ROUNDING * steps:
                whole = f"a whole number of steps dt = {show(self.dt)}, at most {MOST_STEPS:g} of them"
                raise wrong(name, getattr(self, name), whole)
        if not isinstance(self.keep, tuple):
            if end > MOST_TIMES * self.keep.value:
                raise wrong("keep", self.keep, f"at least t_end/{MOST_TIMES:,}")
        elif above(kept[-1].value, end):
            raise wrong("keep", kept, f"a list of times up to t_end = {show(self.t_end)}")
        elif any(
            f"{a:g}" == f"{b:g}" and above(b, a) for a, b in pairwise(sorted({0.0, *(t.value for t in kept), end}))
        ):
            raise wrong("keep", kept, "times that differ in six digits, which the names of columns have")
        return self


class Rules(Section):
    """[rules]: where the variants of the model differ in more than a number."""

    spring_power: Literal[1, 2] = key(
        "power of l in the energy alpha (d - l)^2/l^p of a cytoskeleton spring", "(3.9), (3.10)"
    )
    junction_factor: q.NonNegative = key("stiffness of a junction over the mean alpha_aa of its two cells", "(3.11)")
    repulsion_factor: q.NonNegative = key("stiffness of the soft repulsion over alpha_xx", "(3.13)")
    floor_rest_length: q.Flag = key(
        "whether the desired rest length is max(0, d - R_soft) in place of d - R_soft", "section 2.2.2 of chapter 3"
    )
    enlarge_from: Literal["mitosis", "G2"] = key("phase in which the enlarged radius begins", "(3.4)")
    g2_stiffening: q.NonNegative = key(
        "factor of alpha_aa of a cell from G2 to division",
        'row "stiffness alpha_aa of the apical junction from G2 to division"',
    )
    resting_cells_enlarge: q.Flag = key(
        "whether a cell without INM enlarges and stiffens all the same", 'row "cell without INM"'
    )


class Division(Section):
    """[division]: the division of a cell."""

    offset: q.Length = key("distance of each daughter from the place of the mother", "(3.7)", "Delta X")
    new_junction: q.LengthOrZero = key(
        "rest length of the junction between daughters, and of all junctions at the start", "section 2.2.5 of chapter 3"
    )
    rule: RuleName = key(
        "rule that says whether a cell splits, and where its daughters are",
        "section 2.2.5 of chapter 3",
        default=BESIDE.name,
    )


class Start(Section):
    """[start]: where the nuclei are."""

    nuclei: Literal["box", "even", "own_basal"] = key(
        "rule of the horizontal places of nuclei", 'row "nuclei at start"'
    )
    nuclei_height: q.Fractions = key("parts of the height between which nuclei begin", 'row "nuclei at start"')


class EmtGroup(Section):
    """[emt]: the group of cells in the middle of the tissue that undergoes EMT (section 2.3 of chapter 4).

    Each event that a file of own.modules registers is a key, too. An event that is not given never begins.

    An event fires in the step dt that ends at its time, or in which its time lies: it acts from the beginning of this
    step, so up to dt before its time.
    """

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[EventName, q.Begin]

    cells: q.CountOrZero = key("cells of this group at the start", "section 2.2 of chapter 4", "N^EMT")
    inm: q.Probability = key(
        "probability that a cell of the start performs interkinetic nuclear movement",
        "section 2.1 of chapter 4",
        default=1,
    )

    @model_validator(mode="before")
    @classmethod
    def _with_events(cls, given: Any) -> Any:
        """Add the built-in events that are not given: they never begin."""
        return {**{event.name: NEVER for event in BUILT_IN}, **given} if isinstance(given, Mapping) else given

    @model_validator(mode="after")
    def _in_order(self) -> EmtGroup:
        """Check that an event that waits for another one may begin."""
        times = self.times()
        for event in events():
            time, first = times.get(event.name, Timing()), times.get(event.after or "", Timing())
            if event.after and time.ever and not first.ever:
                waits = f"[{event.mark}] waits for [{mark_of(event.after)}], and {event.after} = {show(first)}"
                raise wrong(event.name, time, f"{show(NEVER)}: {waits}")
        return self

    def times(self) -> dict[str, Timing]:
        """Return when the events begin, by name."""
        return {name: value for name, value in self if isinstance(value, Timing)}

    @property
    def has_events(self) -> bool:
        """Whether one may begin: then its cells are EMT cells."""
        return any(timing.ever for timing in self.times().values())

    @property
    def lets_go(self) -> bool:
        """Whether an event may take its cells out of a layer."""
        timed = [one for one in events() if self.times().get(one.name, Timing()).ever]
        names = {name for one in timed for name in (one.name, *one.starts)}
        return any(one.frees or one.name == CHAINS for one in events() if one.name in names)


class TypeKeys(EmtGroup):
    """[types.NAME]: a group with a name, without the keys of [cell] and [tissue] that it may have of its own."""

    place: Place = key(
        f"middle of the group, from left to right; {APART}: evenly over the tissue; {SCATTERED}: at random",
        TYPESCRIPT,
        default=0.5,
    )
    divides: q.Flag = key(
        "whether its cells divide; daughters have the events of their mother",
        "section 2.2.5 of chapter 3",
        default=True,
    )
    own: UserKeys | None = key("parameters of users, in place of those of [own]", default=None)

    def changes(self) -> dict[str, Any]:
        """Return the values that the type gives itself, by keys of OWN_KEYS."""
        return {name: value for name in OWN_KEYS if (value := getattr(self, name)) is not None}


# The keys that a type may have of its own, and their sections.
OWN_KEYS = dict.fromkeys(Cell.model_fields, "cell") | dict.fromkeys(("two_daughters", "max_basal_distance"), "tissue")


def _optional(name: str) -> Any:
    """Return a key of [cell] or [tissue] as one of a type, where None stands for the value of all cells."""
    field = (Cell if OWN_KEYS[name] == "cell" else Tissue).model_fields[name]
    source: Any = field.json_schema_extra
    about = Field(None, validate_default=False, title=field.title, description=field.description)
    return Annotated[(field.annotation, *field.metadata, Field(json_schema_extra=source))], about


if TYPE_CHECKING:
    CellType = TypeKeys
else:
    CellType = create_model(
        "CellType", __base__=TypeKeys, __module__=__name__, **{name: _optional(name) for name in OWN_KEYS}
    )


class Types(Section):
    """[types]: groups of cells with a name, parameters and events of their own, each a table [types.NAME].

    Up to eight. A key of [cell] holds for a type that does not have it; the unit R_soft is always that of [cell]. Two
    nuclei have the sum of their soft radii and the mean of their alpha_xx, basal neighbours the mean of their maximal
    distances. Cells of a type with events are EMT cells, as those of [emt] are, for tables, outcomes and studies, but
    may divide. Daughters are of the type of their mother, and have her events at her times; studies follow the EMT
    cells of the start.
    """

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, CellType]

    @model_validator(mode="after")
    def _names(self) -> Types:
        for name in self.named():
            if not re.fullmatch("[A-Za-z_][A-Za-z0-9_]*", name) or name in UNNAMED:
                other = f"must have another name, of letters, digits and _, and neither {' nor '.join(UNNAMED)}"
                raise ValueError(f"{name}: {other}")
        if len(self.named()) > MOST_TYPES:
            raise ValueError(f"{', '.join(self.named())}: must be {MOST_TYPES} types at most")
        return self

    def named(self) -> Mapping[str, TypeKeys]:
        """Return the types by name, in the order of the file."""
        return self.__pydantic_extra__


class Events(Section):
    """[events]: how the variants of the model carry out the events (section 2.2 of chapter 4)."""

    freed_stiffness: q.NonNegative = key(
        "factor of the stiffness of the spring to a freed point, after [A] and [B]",
        'row "[A], [B]: stiffness of the freed spring"',
    )
    bridge: Literal["sum", "distance"] = key(
        "rest length of the junction that bridges a cell after [A]: that of the two removed, or the distance",
        "section 2.2.1 of chapter 4",
    )
    bent_stiffness: q.NonNegative = key(
        "stiffness of the bending spring after [S]", "section 2.2.3 of chapter 4", "alpha^axb"
    )
    run_speed: q.Speed = key("speed of the basal point in [P]", "(4.1)", "v^run")
    run_depth: q.Length = key("depth below the basal layer at which its run ends", "(4.1)")
    spring_above: Literal["no force", "gives way"] = key(
        "basal-nuclei spring in [P] while the basal point is above the layer", "section 2.2.4 of chapter 4"
    )
    contraction: q.DurationOrZero = key(
        "time constant of its rest length once the point is below the layer; 0: at once", "section 2.2.4 of chapter 4"
    )
    at_depth: Literal["stays", "forces"] = key("what the basal point does at run_depth", "(4.1)")


class Forces(Section):
    """[forces]: the strengths of forces that files in own.modules register, by their names.

    Forces of the thesis have theirs in [cell] and [rules]. A force whose strength is 0, or not given, is not called.
    """

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[ForceName, q.NonNegative]

    def acting(self) -> tuple[tuple[Force, float], ...]:
        """Return the forces whose strength is not 0, with the strength, in the order of their names."""
        known = {force.name: force for force in registered(Force)}
        return tuple((known[name], strength) for name, strength in sorted(self) if strength > 0)


class Layer(Section):
    """[layer]: the basal layer, a line in the thesis."""

    shape: Literal["line", "circle", "ellipse", "points", "sphere"] = key(
        "shape of the basal layer; in space a line is a plane, a circle a cylinder", CURVED, default="line"
    )
    perimeter: q.Length = key("perimeter of the circle, ellipse or sphere", CURVED, default="300 um")
    aspect: q.Positive = key("vertical half axis of the ellipse over the horizontal one", CURVED, default=1)
    side: Literal["inside", "outside"] = key("side of a closed curve on which the tissue is", CURVED, default="inside")
    closed: q.Flag = key(
        "whether the tissue is a closed tube; else it is an arc, or an open curve", CURVED, default=False
    )
    points: q.Points = key(
        "points of a smooth curve; if it is not closed, the tissue is on its left", CURVED, default=[]
    )


@lru_cache(maxsize=64)
def curve_of(layer: Layer, unit: Quantity) -> BasalCurve:
    """Make the curve of a slice; the same one for equal values. ``unit``: R_soft.

    Raises ValueError if the points are none of a curve: fewer than four, or one twice in a row.
    """
    if layer.shape in ("line", "sphere"):
        return LINE
    inside = layer.side == "inside"
    if layer.shape != "points":
        aspect = 1.0 if layer.shape == "circle" else layer.aspect
        return ellipse(layer.perimeter.over(unit), aspect, inside=inside, ring=layer.closed)
    if len(layer.points) < 4:
        raise ValueError(f"layer.points = {len(layer.points)} points: must be a list of at least four points")
    points = np.array([[length.over(unit) for length in point] for point in layer.points])
    if layer.closed:  # the tissue on its left: counterclockwise for a tissue inside
        (x, y), (next_x, next_y) = points.T, np.roll(points, -1, axis=0).T
        if ((x * next_y - y * next_x).sum() > 0) != inside:
            points = np.vstack((points[:1], points[:0:-1]))
        points = np.vstack((points, points[:1]))
    if not np.hypot(*np.diff(points, axis=0).T).all():
        raise ValueError(f"layer.points = {len(points)} points: must be points of which none is there twice in a row")
    return through(points, around=layer.closed)


class Space(Section):
    """[space]: what there is in three dimensions alone.

    The preset "sheet" is fitted to a height and an area of a cell that are published. tissue.dimension = 3 makes a
    sheet of any slice with enough cells, but a crowded one: constants of slices are not those of sheets. What matters:

    tissue.two_daughters  0 keeps the number of cells; 1: all daughters stay, and a sheet that cannot spread crowds
    tissue.cells          columns times an even number of rows, wide enough; messages name the nearest numbers
    space.boundary        "open": a patch with a free edge, which may spread
    layer.shape           "line": a plane; "circle": a cylinder; "sphere"
    emt.ac                "never": chains of cells are of a slice alone
    """

    rows: q.CountOrZero = key(
        "rows of cells across the sheet or along the cylinder, an even number; 0: a sheet that is about square",
        DEEP,
        default=0,
    )
    boundary: Literal["periodic", "open"] = key(
        "what is beyond the ends of a plane or of a cylinder: the tissue again, or nothing",
        DEEP,
        default="periodic",
    )
