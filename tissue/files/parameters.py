"""All parameters of a tissue: read from TOML files with units, checked as a whole, handed on as plain numbers."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from functools import cache
from os import PathLike
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError, model_validator

from dincl.checks import describe
from dincl.checks import path as checked_path
from dincl.errors import InvalidProblem
from tissue.events.division import division_rules
from tissue.files import sections
from tissue.files.groups import CellGroup
from tissue.files.keys import all_keys, problems, refuse
from tissue.files.own_modules import imported, placed
from tissue.files.parameter_files import BASES, FOLDER, PRESETS, merged, nested, read, written
from tissue.files.quantities import Quantity
from tissue.files.together import check
from tissue.kernels.workspace import SOFT
from tissue.network.lattice import Lattice, ball_lattice, flat_lattice, round_lattice, rows_of
from tissue.plugins import DivisionRule
from tissue.state.basal_curve import LINE, BasalCurve
from tissue.state.cells import PARAMETERS
from tissue.state.numbers import Numbers, StartNumbers, UserNumbers
from tissue.state.space import SPATIAL

# The choices that are yes or no for kernels: the key, and its value that is yes.
CHOICES = {
    "noise_in_substeps": ("noise", "substep"),
    "enlarge_in_g2": ("enlarge_from", "G2"),
    "bridge_present": ("bridge", "distance"),
    "spring_gives": ("spring_above", "gives way"),
    "forced_below": ("at_depth", "forces"),
}
# At the boundary of an open sheet neighbours are apart by the range of nuclei at most, or by twice the largest distance
# of basal points. With 2/3 R_soft the edge of a sheet frays into fingers: its junctions grow longer than that.
LEAST_EDGE, EDGE = SOFT, 2.0


class Parameters(BaseModel):
    """The complete parameters of a run, with units; made by ``load``, ``preset`` and ``changed``, which check them.

    Each section of a file is an attribute, each of its keys an attribute of that: ``parameters.tissue.cells``.
    Quantities have a ``value`` and a ``unit``, which is um, R_soft, h or made of these.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    own: sections.Own = sections.Own.model_validate({})  # the first one: it brings what the others may name
    tissue: sections.Tissue
    cell: sections.Cell
    numerics: sections.Numerics
    rules: sections.Rules
    division: sections.Division
    start: sections.Start
    emt: sections.EmtGroup
    events: sections.Events
    forces: sections.Forces = sections.Forces.model_validate({})
    layer: sections.Layer = sections.Layer()
    space: sections.Space = sections.Space()
    types: sections.Types = sections.Types.model_validate({})

    @model_validator(mode="after")
    def _together(self) -> Parameters:
        check(self)
        return self

    def changed(self, changes: Mapping[str, Any]) -> Parameters:
        """Return these parameters with other values for some keys, checked anew as a whole.

        Parameters
        ----------
        changes
            Values as in a file by keys with section: {"numerics.mu": "0.1 h", "types.soft.cells": 5}.

        Raises
        ------
        InvalidProblem
            If a key is unknown, a value is bad or does not go with the others.
        """
        if not isinstance(changes, Mapping):
            raise InvalidProblem(f'changes = {describe(changes)}: must map keys such as "numerics.mu" to their values')
        return _checked(merged(self.as_dict(), nested(changes)), "changed parameters")

    def __setstate__(self, state: dict[Any, Any]) -> None:
        """Restore the parameters in another process, which imports the modules of users again."""
        super().__setstate__(state)
        for file in self.own.modules:
            imported(Path(file))

    def as_dict(self) -> dict[str, Any]:
        """Return all sections as in a file, with quantities as text in um, R_soft and h; equal for equal parameters."""
        return {section: table for section, table in self.model_dump(mode="json", exclude_none=True).items() if table}

    def as_toml(self) -> str:
        """Write a file without base that ``load`` makes equal parameters of; comments say what each value means."""
        return written(self.as_dict(), {name: facts.comment for name, facts in all_keys(type(self)).items()})

    # What runs compute with

    @property
    def t_end(self) -> float:
        """The end of the run [h]."""
        return self.numerics.t_end.value

    @property
    def in_space(self) -> bool:
        """Whether the tissue is in three dimensions."""
        return self.tissue.dimension == SPATIAL

    @property
    def type_names(self) -> tuple[str, ...]:
        """The types of cells by their numbers, as ``Cells.kind`` has them: control cells, EMT cells, then the named."""
        return (*sections.UNNAMED, *self.types.named())

    def numbers(self) -> Numbers:
        """Return what kernels compute with: lengths over R_soft, times in h, the variance 2 D of the noise per hour."""
        return self.numbers_of(self.tissue, self.cell)

    def named_numbers(self) -> tuple[Numbers, ...]:
        """Return the numbers of the cells of each named type, in the order of [types]."""
        return tuple(self.numbers_of(*self.of_type(one), one.own) for one in self.types.named().values())

    def of_type(self, one: sections.TypeKeys) -> tuple[sections.Tissue, sections.Cell]:
        """Return [tissue] and [cell] with what a type has of its own."""
        own: dict[str, dict[str, Any]] = {"tissue": {}, "cell": {}}
        for name, value in one.changes().items():
            own[sections.OWN_KEYS[name]][name] = value
        return self.tissue.model_copy(update=own["tissue"]), self.cell.model_copy(update=own["cell"])

    def _plain(self, *of: Iterable[tuple[str, Any]]) -> dict[str, Any]:
        """Return the values of sections by the names of their keys, quantities over R_soft and in h."""
        unit, values = self.cell.soft_radius, (pair for section in of for pair in section)
        return {name: value.over(unit) if isinstance(value, Quantity) else value for name, value in values}

    def numbers_of(self, tissue: sections.Tissue, cell: sections.Cell, own: sections.UserKeys | None = None) -> Numbers:
        """Fill the numbers by name from all sections, of which these may be those of a type."""
        found = self._plain(tissue, cell, self.numerics, self.rules, self.division, self.events)
        found |= {name: found[key] == yes for name, (key, yes) in CHOICES.items()}
        found |= {"variance": 2 * found["diffusion"], "repulsion": self.rules.repulsion_factor * cell.alpha_xx}
        of_users = self.own.values() | (own.given() if own else {})
        found["own"] = UserNumbers(*self._plain([(name, of_users[name]) for name in PARAMETERS]).values())
        return Numbers(**{name: found[name] for name in Numbers._fields})

    def start_numbers(self) -> StartNumbers:
        """Return what the first state is made from, lengths over R_soft. A ring is spread evenly over its layer."""
        found, curve = self._plain(self.tissue, self.cell, self.division, self.start), self.curve()
        if curve.ring:
            found["width"] = curve.length
            found["apical_spacing"] = found["basal_spacing"] = curve.length / self.tissue.cells
        low, high = self.start.nuclei_height
        found |= {"nuclei_low": low * found["height"], "nuclei_high": high * found["height"]}
        return StartNumbers(**{name: found[name] for name in StartNumbers._fields})

    def division_rule(self) -> DivisionRule:
        """Return the rule of what becomes of a cell at the end of its cycle."""
        return division_rules()[self.division.rule]

    def curve(self) -> BasalCurve:
        """Return the basal layer; in space it is a surface, and this the line."""
        return LINE if self.in_space else sections.curve_of(self.layer, self.cell.soft_radius)

    def rows(self) -> int:
        """Return the number of rows of cells of a plane or cylinder; raises InvalidProblem if the cells fill none."""
        return rows_of(self.tissue.cells, self.space.rows)

    def lattice(self) -> Lattice:
        """Return where the basal points of a tissue in space are at the start, and the surface that holds them."""
        found, cells, layer = self._plain(self.tissue, self.layer), self.tissue.cells, self.layer
        around, inside, periodic = found["perimeter"], layer.side == "inside", self.space.boundary == "periodic"
        if layer.shape == "sphere":
            return ball_lattice(cells, around, inside=inside)
        if layer.shape == "circle":
            return round_lattice(cells, self.rows(), around, inside=inside, periodic=periodic)
        return flat_lattice(cells, self.rows(), found["basal_spacing"], periodic=periodic)

    def longest_edge(self) -> float:
        """Return the longest edge at a free boundary of a tissue in space [R_soft]; inf without one."""
        longest = max(LEAST_EDGE, EDGE * self._plain(self.tissue)["max_basal_distance"])
        free = self.space.boundary == "open" and self.layer.shape != "sphere"
        return longest if free else math.inf

    def groups(self) -> tuple[CellGroup, ...]:
        """Return the groups that are no control cells: that of [emt], then each named type."""
        emt, rest = self.emt, self._plain(self.cell)["initial_rest_length"]
        place, divides, may_leave = 0.5, False, True
        of_emt = emt.cells, emt.inm, emt.times(), place, divides, may_leave, rest
        found = [CellGroup(sections.UNNAMED[-1], *of_emt)]
        for name, one in self.types.named().items():
            rest = self._plain(self.of_type(one)[1])["initial_rest_length"]
            own = one.place, one.divides, one.has_events, rest
            found.append(CellGroup(name, one.cells, one.inm, one.times(), *own))
        return tuple(found)


class NoBase(InvalidProblem):
    """Base of a parameter file that cannot be used; the message does not name the file."""


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
        the message names the file, the key, its value and what is allowed.
    """
    return _loaded(checked_path("path", path), ())


def _loaded(path: Path, above: tuple[Path, ...]) -> Parameters:
    """Load the parameters in a file; ``above``: the files that have it as their base."""
    tables = read(path)
    base = tables.pop("base", None)
    if base is None:
        return _checked(placed(tables, path.parent), str(path))
    try:
        first = based_on(base, path.parent, (*above, path.resolve()))
    except NoBase as error:
        raise InvalidProblem(f"{path}: {error}") from None
    return _checked(merged(first.as_dict(), placed(tables, path.parent, first.own.modules)), str(path))


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
    are of the public TypeScript program; "sheet" is in three dimensions, with a height and an area of a cell that are
    published for pseudostratified epithelia.
    """
    if not isinstance(name, str) or name not in PRESETS:
        raise InvalidProblem(f"preset {describe(name)}: must be {BASES}")
    return _preset(name)


@cache
def _preset(name: str) -> Parameters:
    return load(FOLDER / f"{name}.toml")


def _checked(tables: Mapping[str, Any], source: str) -> Parameters:
    """Return the parameters in these tables; raises InvalidProblem with what is wrong with them."""
    try:
        return Parameters.model_validate(tables)
    except ValidationError as error:
        lines = problems(error, tables, Parameters)
    raise refuse(source, lines)
