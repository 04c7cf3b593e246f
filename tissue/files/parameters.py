"""All parameters of a tissue: read from TOML files with units, checked as a whole, handed on as plain numbers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from os import PathLike
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError, model_serializer, model_validator

from dincl.checks import describe
from dincl.checks import path as checked_path
from dincl.errors import InvalidProblem
from tissue.events.division import division_rules
from tissue.events.known import events
from tissue.files.cell_types import UNNAMED, TypesSection
from tissue.files.combinations import broken
from tissue.files.emt_sections import EmtSection, EventsSection
from tissue.files.forces import ForcesSection
from tissue.files.keys import all_keys, optional_sections
from tissue.files.layer import curve_of
from tissue.files.messages import known_keys, known_only, problems, refuse, unknown
from tissue.files.own_modules import bring, imported, placed
from tissue.files.parameter_files import BASES, FOLDER, PRESETS, general, merged, nested, read, written
from tissue.files.plain_numbers import to_exchange, to_lattice, to_numbers, to_start_numbers
from tissue.files.scenario import CellGroup, Scenario
from tissue.files.sections import (
    CellSection,
    DahaSection,
    DivisionSection,
    LayerSection,
    NumericsSection,
    OwnSection,
    RulesSection,
    SpaceSection,
    StartSection,
    TissueSection,
)
from tissue.files.space_rules import becomes_space, fewest_cells
from tissue.files.timing import Timing
from tissue.files.type_rules import broken_types, wrong_names
from tissue.model.lattice import Lattice
from tissue.plugins import DivisionRule
from tissue.state.basal_curve import LINE, BasalCurve
from tissue.state.numbers import Daha, Numbers, StartNumbers
from tissue.state.space import SPATIAL, Exchange


class Parameters(BaseModel):
    """The complete parameters of a run, with units; made by ``load``, ``preset`` and ``changed``, which check them.

    Each section of a file is an attribute, each of its keys an attribute of that: ``parameters.tissue.cells``.
    Quantities have a ``value`` and a ``unit``, which is um, R_soft, h or made of these.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    own: OwnSection = OwnSection()  # the first one: it brings what the others may name
    tissue: TissueSection
    cell: CellSection
    numerics: NumericsSection
    rules: RulesSection
    division: DivisionSection
    start: StartSection
    emt: EmtSection
    events: EventsSection
    forces: ForcesSection
    daha: DahaSection
    layer: LayerSection
    space: SpaceSection
    types: TypesSection

    @model_validator(mode="before")
    @classmethod
    def _with_defaults(cls, tables: Any) -> Any:
        """Add the sections that are left out as a whole, if all of their keys have a default."""
        return {**optional_sections(cls), **tables} if isinstance(tables, Mapping) else tables

    @model_validator(mode="after")
    def _together(self) -> Parameters:
        values: dict[str, Any] = {f"emt.{event.name}": Timing() for event in events()}
        values |= {f"{section}.{name}": value for section, fields in self for name, value in fields}
        if lines := [*broken(values), *broken_types(values)]:
            raise ValueError("; ".join(lines))
        return self

    @model_serializer(mode="wrap")
    def _as_file(self, write: Any) -> dict[str, Any]:
        """Write the sections that are not empty."""
        return {section: table for section, table in write(self).items() if table}

    def changed(self, changes: Mapping[str, Any]) -> Parameters:
        """Return these parameters with other values for some keys, checked anew as a whole.

        A slice of which {"tissue.dimension": 3} makes a tissue in space gets as many cells as it needs there, unless
        "tissue.cells" is changed, too.

        Parameters
        ----------
        changes
            Values as in a file by keys with section: {"numerics.mu": "0.1 h", "types.soft.cells": 5}.

        Raises
        ------
        InvalidProblem
            If a key is unknown, a value is bad or does not go with the others; all of it in one message.
        """
        if not isinstance(changes, Mapping):
            raise InvalidProblem(f'changes = {describe(changes)}: must map keys such as "numerics.mu" to their values')
        bring(changes.get("own.modules"))
        keys = known_keys(Parameters)
        known = {key: value for key, value in changes.items() if isinstance(key, str) and general(key) in keys}
        wrong = ((key, value) for key, value in changes.items() if key not in known)
        lines = [unknown(key if isinstance(key, str) else describe(key), value, keys) for key, value in wrong]
        base, new = self.as_dict(), nested(known)
        return _checked(merged(base, new), "changed parameters", lines, widen=becomes_space(base, new))

    def __setstate__(self, state: dict[Any, Any]) -> None:
        """Restore the parameters in another process, which imports the modules of users again."""
        super().__setstate__(state)
        for file in self.own.modules:
            imported(Path(file))

    def division_rule(self) -> DivisionRule:
        """Return the rule of what becomes of a cell at the end of its cycle."""
        return division_rules()[self.division.rule]

    def as_dict(self) -> dict[str, Any]:
        """Return all sections as in a file, with quantities as text in um, R_soft and h; equal for equal parameters."""
        return self.model_dump(mode="json")

    def as_toml(self) -> str:
        """Write a file without base that ``load`` makes equal parameters of; comments say what each value means."""
        return written(self.as_dict(), {name: facts.comment for name, facts in all_keys(type(self)).items()})

    @property
    def t_end(self) -> float:
        """The end of the run [h]."""
        return self.numerics.t_end.value

    def numbers(self) -> Numbers:
        """Return what kernels compute with: lengths over R_soft, times in h, the variance 2 D of the noise per hour."""
        return to_numbers(self)

    def named_numbers(self) -> tuple[Numbers, ...]:
        """Return the numbers of the cells of each named type, in the order of [types]."""
        named, unit = self.types.named().values(), self.cell.soft_radius
        pairs = zip(self._of_types(), named, strict=True)
        return tuple(of.numbers()._replace(soft_radius=one.soft_radius_over(unit)) for of, one in pairs)

    @property
    def type_names(self) -> tuple[str, ...]:
        """The types of cells by their numbers, as ``Cells.kind`` has them: control cells, EMT cells, then the named."""
        return (*UNNAMED, *self.types.named())

    def curve(self) -> BasalCurve:
        """Return the basal layer; in space it is a surface, and this the line."""
        layer = self.layer
        if self.in_space:
            return LINE
        shape = layer.shape, layer.perimeter, layer.aspect, layer.points, layer.side, layer.closed
        return curve_of(*shape, self.cell.soft_radius)

    @property
    def in_space(self) -> bool:
        """Whether the tissue is in three dimensions."""
        return self.tissue.dimension == SPATIAL

    def lattice(self) -> Lattice:
        """Return where the basal points of a tissue in space are at the start, and the surface that holds them."""
        return to_lattice(self)

    def exchange(self) -> Exchange:
        """Return how cells in space exchange neighbours."""
        return to_exchange(self)

    def start_numbers(self) -> StartNumbers:
        """Return what the first state is made from, lengths over R_soft. A ring is spread evenly over its layer."""
        return to_start_numbers(self, self.curve())

    def scenario(self) -> Scenario:
        """Return what the EMT cells are drawn from, times in h."""
        emt = self.emt
        return Scenario(emt.cells, emt.inm, emt.times(), self.events.together)

    def groups(self) -> tuple[CellGroup, ...]:
        """Return the groups that are no control cells: that of [emt], then each named type."""
        rest, named = self.start_numbers().rest_length, self.types.named().items()
        emt = CellGroup(UNNAMED[-1], self.scenario(), 0.5, divides=False, may_leave=True, rest_length=rest)
        rests = (one.start_numbers().rest_length for one in self._of_types())
        together = self.events.together
        return emt, *(one.group(name, rest, together) for (name, one), rest in zip(named, rests, strict=True))

    def _of_types(self) -> Iterator[Parameters]:
        """Give the parameters of the cells of each type, with the soft radius of [cell]: the unit stays."""
        for one in self.types.named().values():
            tables = one.own_tables().items()
            yield self.model_copy(update={name: getattr(self, name).model_copy(update=table) for name, table in tables})

    def daha_numbers(self) -> Daha:
        """Return the parameters of the solver of the quasi-steady model."""
        return Daha(**dict(self.daha))


def load(path: str | PathLike[str]) -> Parameters:
    """Load the parameters in a TOML file.

    Parameters
    ----------
    path
        The file. Its top key ``base`` names a preset or another file, relative to this one; this one changes some
        of its values. Without a base all values without default have to be given, as in the presets themselves.

    Raises
    ------
    InvalidProblem
        If it cannot be read, lacks a key, has an unknown one, or a value that is bad or does not go with the others;
        all of it in one message that names the file, each key, its value and what is allowed.
    """
    return _loaded(checked_path("path", path), ())


def _loaded(path: Path, above: tuple[Path, ...]) -> Parameters:
    """Load the parameters in a file; ``above``: the files that have it as their base."""
    tables = read(path)
    base = tables.pop("base", None)
    if base is None:
        return _checked(placed(tables, path.parent), str(path))
    try:
        changed = based_on(base, path.parent, (*above, path.resolve()))
    except NoBase as error:
        return _checked(tables, str(path), [str(error)], missing=False)
    own = placed(tables, path.parent, changed.own.modules)
    before = changed.as_dict()
    return _checked(merged(before, own), str(path), widen=becomes_space(before, own))


class NoBase(ValueError):
    """Base of a parameter file that cannot be used; the message is a line for the errors of the file."""


def based_on(base: Any, folder: Path, above: tuple[Path, ...] = ()) -> Parameters:
    """Load the preset or the file that a file in ``folder`` names as its base; ``above``: those that are based on it.

    Raises NoBase if there is no such preset or file, InvalidProblem if the file is not in order.
    """
    if base in PRESETS:
        return preset(base)
    path = folder / base if isinstance(base, str) else folder
    if not path.is_file():
        what = "" if path == folder else f"; {path} does not exist"
        raise NoBase(f"base = {describe(base)}: must be {BASES}, or a parameter file{what}")
    if path.resolve() in above:
        raise NoBase(f"base = {describe(base)}: must be another file: {path} is based on this one")
    return _loaded(path, above)


def preset(name: str) -> Parameters:
    """Return the parameters of a preset; raises InvalidProblem if there is none of this name.

    "thesis" is as printed with misprints corrected, but for the energies; "corrected" is "thesis" with the energies
    without dimension, and nothing else; "published" is as in the published runs; "chick", "gastrulation" and "cuboidal"
    are of the public TypeScript program.
    """
    if not isinstance(name, str) or name not in PRESETS:
        raise InvalidProblem(f"preset {describe(name)}: must be {BASES}")
    return _preset(name)


@cache
def _preset(name: str) -> Parameters:
    return load(FOLDER / f"{name}.toml")


def _checked(
    tables: Mapping[str, Any], source: str, lines: Iterable[str] = (), *, missing: bool = True, widen: bool = False
) -> Parameters:
    """Return the parameters in these tables, or raise one error with ``lines`` and all that is wrong with them.

    ``widen``: a slice becomes a tissue in space, and gets the cells that it needs there.
    """
    own = tables.get("own")
    bring(own.get("modules") if isinstance(own, Mapping) else None)
    noted: dict[tuple[type[BaseModel], str], Any] = {}
    tables, unknown_lines = known_only(tables, Parameters)
    found = [*lines, *unknown_lines, *wrong_names(tables.get("types"))]
    try:
        parameters = Parameters.model_validate(tables, context=noted)
    except ValidationError as error:
        names = {field.annotation: section for section, field in Parameters.model_fields.items()}
        good = {f"{names[section]}.{name}": value for (section, name), value in noted.items() if section in names}
        if widen and not found and (cells := fewest_cells(good)):
            return _checked(merged(tables, {"tissue": {"cells": cells}}), source)
        found += problems(error, Parameters, missing=missing) + broken(good) + broken_types(good)
    if found:
        raise refuse(source, sorted(found, key=lambda line: not line.startswith("own.")))  # others follow from it
    return parameters
