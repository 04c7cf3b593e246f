"""The sections of a parameter file: which keys there are, what each one means and what its value may be.

This and ``tissue.files.emt_sections`` are the only places that say so: lists, messages, written files and
docs/reference/parameters.md take it from here, see ``tissue.files.keys``; types of cells do, too
(``tissue.files.cell_types``). A section says nothing about combinations of values: ``tissue.files.combinations`` does.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, ValidationInfo, field_validator

from tissue.events.division import BESIDE
from tissue.files.fields import (
    MOST_CELLS,
    DiffusionOrZero,
    DivisionRuleName,
    Duration,
    DurationOrZero,
    Flag,
    Fractions,
    Length,
    LengthOrNone,
    LengthOrZero,
    MetricLength,
    Modules,
    NonNegative,
    OutputTimes,
    Points,
    Positive,
    Probability,
    RateOrZero,
    count,
    one_of,
)
from tissue.files.keys import KeyFacts, key

TABLE_1 = "Table 1 of chapter 3"
TABLE_2 = "Table 2 of chapter 3"
TABLE_3 = "Table 3 of chapter 3"
TABLE_4 = "Table 4 of chapter 3"
TABLE_5 = "Table 5 of chapter 3"
CURVED = "chapter 3 names curved layers as further work"
SPATIAL = "chapter 3 names three dimensions as further work"


class ParameterSection(BaseModel):
    """A table of a file: all keys without default have to be given, no others, and nothing changes afterwards."""

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True)

    @classmethod
    def all_keys(cls) -> list[str]:
        """List all keys that it may have."""
        return [*cls.model_fields, *(facts.name.partition(".")[2] for facts in cls.further_keys())]

    @classmethod
    def further_keys(cls) -> tuple[KeyFacts, ...]:
        """Return the keys that are no attributes."""
        return ()

    @field_validator("*")
    @classmethod
    def _note(cls, value: Any, info: ValidationInfo) -> Any:
        """Note each good value in the context, so that combinations are checked although other values are bad."""
        if info.context is not None:
            info.context[cls, info.field_name] = value
        return value


class OwnSection(ParameterSection):
    """[own]: what is not in this package."""

    modules: Modules = key(
        "files, relative to this one, that register events, forces, observables or rules of divisions",
        "",
        "docs/tutorials/own_event.md",
        [],
    )


class TissueSection(ParameterSection):
    """[tissue]: the layer of cells at the start, and its noise."""

    cells: Annotated[int, count(MOST_CELLS)] = key("cells at the start", "N^init", TABLE_1)
    height: Length = key("height of the tissue at the start", "h^init", TABLE_1)
    width: Length = key("width of the box of the nuclei at the start", "w^init", TABLE_1)
    apical_spacing: Length = key("distance between apical points at the start", "d^init-apical", TABLE_1)
    basal_spacing: Length = key(
        "distance between basal points at the start", "", 'row "apical and basal spacing at start"'
    )
    max_basal_distance: Length = key(
        "maximal distance between neighbouring basal points", "d^max-basal", f"{TABLE_1}, (C2)"
    )
    two_daughters: Probability = key(
        "probability that both daughters of a division stay in the plane",
        "p^div",
        "Table 1 and section 2.2.5 of chapter 3",
    )
    diffusion: DiffusionOrZero = key("diffusion coefficient of the noise of nuclei", "D", f"{TABLE_1}, (3.17)")
    dimension: Annotated[int, one_of(2, 3)] = key(
        "dimension: a slice of the tissue, or the tissue in space, as [space] tells", "", SPATIAL, 2
    )


class CellSection(ParameterSection):
    """[cell]: one cell, its cycle and its forces."""

    soft_radius: MetricLength = key(
        "radius of the soft repulsion; that of [cell] is the unit of length R_soft", "R^soft", f"{TABLE_2}, (3.13)"
    )
    hard_radius: LengthOrZero = key("radius of non-overlap; 0: none", "R^hard", f"{TABLE_2}, (C1)")
    enlarged_radius: LengthOrZero = key(
        "radius of non-overlap before division; 0: none", "R^hard,G2", f"{TABLE_2}, (3.4)"
    )
    initial_rest_length: LengthOrZero = key(
        "rest length of both cytoskeleton springs at the start", "eta^init", TABLE_2
    )
    max_cytoskeleton: LengthOrNone = key(
        "length that eta_ax + eta_bx tend to at most, or none", "", "none in chapter 3", "none"
    )
    g2: DurationOrZero = key("duration of the G2 phase", "T^G2", "Table 2 and section 2.2.1 of chapter 3")
    mitosis: DurationOrZero = key("duration of mitosis", "T^mitosis", "Table 2 and section 2.2.1 of chapter 3")
    min_cycle: Duration = key("shortest duration of a cell cycle", "T^min-cycle", f"{TABLE_2}, (3.1)")
    max_cycle: Duration = key("longest duration of a cell cycle", "T^max-cycle", f"{TABLE_2}, (3.1)")
    rate_aa: RateOrZero = key("rate at which the rest length of an apical junction adapts", "k^aa", f"{TABLE_2}, (3.6)")
    rate_ax: RateOrZero = key(
        "rate at which the rest length of the apical-nuclei spring adapts", "k^ax", f"{TABLE_2}, (3.2)"
    )
    rate_bx: RateOrZero = key(
        "rate at which the rest length of the basal-nuclei spring adapts", "k^bx", f"{TABLE_2}, (3.3)"
    )
    alpha_aa: NonNegative = key("stiffness of the apical junctions", "alpha^aa", f"{TABLE_2}, (3.11)")
    alpha_ax: NonNegative = key("stiffness of the apical-nuclei spring", "alpha^ax", f"{TABLE_2}, (3.9)")
    alpha_bx: NonNegative = key("stiffness of the basal-nuclei spring", "alpha^bx", f"{TABLE_2}, (3.10)")
    alpha_xx: NonNegative = key("stiffness of the soft repulsion of nuclei", "alpha^xx", f"{TABLE_2}, (3.13)")
    alpha_axb: NonNegative = key(
        "stiffness of the bending spring, which keeps a cell straight", "alpha^axb", f"{TABLE_2}, (3.12)"
    )


class NumericsSection(ParameterSection):
    """[numerics]: the steps, and what is kept of a run."""

    dt: Duration = key("time between updates of rules and events", "Delta t", TABLE_3)
    substeps: Annotated[int, count(MOST_CELLS)] = key("PBD steps in one dt", "n^sub-steps", f"{TABLE_5}, (3.34)")
    mu: Duration = key("damping coefficient", "mu", f"{TABLE_5}, (3.33)")
    noise: Annotated[str, one_of("step", "substep")] = key("how often noise is added", "", "(3.35)")
    t_end: Duration = key("end of the run", "t^end", 'row "end of runs"')
    keep: OutputTimes = key("time between saved states, or the output times; start and end are among them")


class RulesSection(ParameterSection):
    """[rules]: where the variants of the model differ in more than a number."""

    spring_power: Annotated[int, one_of(1, 2)] = key(
        "power of l in the energy alpha (d - l)^2/l^p of a cytoskeleton spring", "", "(3.9), (3.10)"
    )
    junction_factor: NonNegative = key("stiffness of a junction over the mean alpha_aa of its two cells", "", "(3.11)")
    repulsion_factor: NonNegative = key("stiffness of the soft repulsion over alpha_xx", "", "(3.13)")
    floor_rest_length: Flag = key(
        "whether the desired rest length is max(0, d - R_soft) in place of d - R_soft", "", "section 2.2.2 of chapter 3"
    )
    enlarge_from: Annotated[str, one_of("mitosis", "G2")] = key(
        "phase in which the enlarged radius begins", "", "(3.4)"
    )
    g2_stiffening: NonNegative = key(
        "factor of alpha_aa of a cell from G2 to division",
        "",
        'row "stiffness alpha_aa of the apical junction from G2 to division"',
    )
    resting_cells_enlarge: Flag = key(
        "whether a cell without INM enlarges and stiffens all the same", "", 'row "cell without INM"'
    )


class LayerSection(ParameterSection):
    """[layer]: the basal layer, a line in the thesis."""

    shape: Annotated[str, one_of("line", "circle", "ellipse", "points", "sphere")] = key(
        "shape of the basal layer; in space a line is a plane, a circle a cylinder", "", CURVED, "line"
    )
    perimeter: Length = key("perimeter of the circle, ellipse or sphere", "", CURVED, "300 um")
    aspect: Positive = key("vertical half axis of the ellipse over the horizontal one", "", CURVED, 1)
    side: Annotated[str, one_of("inside", "outside")] = key(
        "side of a closed curve on which the tissue is", "", CURVED, "inside"
    )
    closed: Flag = key("whether the tissue is a closed tube; else it is an arc, or an open curve", "", CURVED, False)
    points: Points = key("points of a smooth curve; if it is not closed, the tissue is on its left", "", CURVED, [])


class SpaceSection(ParameterSection):
    """[space]: what there is in three dimensions alone.

    tissue.dimension = 3 makes a sheet of any slice. Of a base it needs no other key: a slice has too few cells for a
    sheet, so without a tissue.cells of its own the sheet gets the fewest that fill an even number of rows, wider than
    twice the range of nuclei: 182 with the preset "thesis". What else matters:

    tissue.two_daughters  1: all daughters stay, as there is no slice to leave; 0.2 is for a slice
    tissue.cells          columns times rows, such as 182, 196, 400, 784
    space.boundary        "open": a patch with a free edge, which may spread
    layer.shape           "line": a plane; "circle": a cylinder; "sphere"
    emt.ac                "never": chains of cells are of a slice alone
    """

    rows: Annotated[int, count(MOST_CELLS, least=0)] = key(
        "rows of cells across the sheet or along the cylinder, an even number; 0: a sheet that is about square",
        "",
        SPATIAL,
        0,
    )
    boundary: Annotated[str, one_of("periodic", "open")] = key(
        "what is beyond the ends of a plane or of a cylinder: the tissue again, or nothing", "", SPATIAL, "periodic"
    )
    flip_margin: Probability = key(
        "neighbours change where the other diagonal of four is shorter than theirs by more than this part of it",
        "",
        SPATIAL,
        0.1,
    )
    new_rest: Annotated[str, one_of("mean", "distance")] = key(
        "rest length of the junction of new neighbours: the mean of the four around, or their distance",
        "",
        SPATIAL,
        "mean",
    )


class DivisionSection(ParameterSection):
    """[division]: the division of a cell."""

    offset: Length = key("distance of each daughter from the place of the mother", "Delta X", "(3.7)")
    new_junction: LengthOrZero = key(
        "rest length of the junction between daughters, and of all junctions at the start",
        "",
        "section 2.2.5 of chapter 3",
    )
    rule: DivisionRuleName = key(
        "rule that says whether a cell splits, and where its daughters are",
        "",
        "section 2.2.5 of chapter 3",
        BESIDE.name,
    )


class StartSection(ParameterSection):
    """[start]: where the nuclei are."""

    nuclei: Annotated[str, one_of("box", "even", "own_basal")] = key(
        "rule of the horizontal places of nuclei", "", 'row "nuclei at start"'
    )
    nuclei_height: Fractions = key("parts of the height between which nuclei begin", "", 'row "nuclei at start"')


class DahaSection(ParameterSection):
    """[daha]: the damped Arrow-Hurwicz method of the quasi-steady model."""

    alpha: Positive = key("weight of the energy and of the multipliers", "alpha", f"{TABLE_4}, (3.25)")
    beta: Positive = key("rate of the multipliers", "beta", f"{TABLE_4}, Method 3.4")
    gamma: NonNegative = key("weight of the term against oscillations", "gamma", f"{TABLE_4}, (3.25)")
    c: Positive = key("damping", "c", f"{TABLE_4}, (3.25)")
    dtau: Positive = key("step", "Delta tau", f"{TABLE_4}, (3.25)")
    eps: Positive = key("relative move at which the iteration ends", "epsilon", f"{TABLE_4}, (3.24)")
    most_iterations: Annotated[int, count(1_000_000_000)] = key("iterations after which it gives up")
