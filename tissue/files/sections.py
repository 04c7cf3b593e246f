"""The sections of a parameter file: which keys there are and what each value may be.

A section says nothing about combinations of values: ``tissue.files.combinations`` does.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, PlainValidator, ValidationInfo, field_validator

from tissue.files.fields import (
    MOST_CELLS,
    Begin,
    Count,
    DiffusionOrZero,
    Duration,
    DurationOrZero,
    Flag,
    Fractions,
    Kept,
    Length,
    LengthOrZero,
    MetricLength,
    NonNegative,
    OneOf,
    Points,
    Positive,
    Probability,
    RateOrZero,
    Speed,
)
from tissue.files.units import Measure


class ParameterSection(BaseModel):
    """A table of a file: all keys have to be given, no others, and nothing changes afterwards."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    @field_validator("*")
    @classmethod
    def _note(cls, value: Any, info: ValidationInfo) -> Any:
        """Note each good value in the context, so that combinations are checked although other values are bad."""
        if info.context is not None:
            info.context[cls, info.field_name] = value
        return value


class TissueSection(ParameterSection):
    """[tissue]: Table 1 of chapter 3."""

    cells: Annotated[int, PlainValidator(Count(MOST_CELLS))]  # N^init
    height: Length  # h^init
    width: Length  # w^init, of the box of the nuclei
    apical_spacing: Length  # d^init-apical
    basal_spacing: Length  # of the basal points at the start
    max_basal_distance: Length  # d^max-basal (C2)
    two_daughters: Probability  # p^div, that both daughters stay in the plane (section 2.2.5 of chapter 3)
    diffusion: DiffusionOrZero  # D


class CellSection(ParameterSection):
    """[cell]: Table 2 of chapter 3."""

    soft_radius: MetricLength  # R^soft, the unit of length R_soft
    hard_radius: Length  # R^hard
    enlarged_radius: Length  # R^hard,G2 (3.4)
    initial_rest_length: LengthOrZero  # eta^init of both cytoskeleton springs
    g2: DurationOrZero  # T^G2
    mitosis: DurationOrZero  # T^mitosis
    min_cycle: Duration  # T^min-cycle
    max_cycle: Duration  # T^max-cycle
    rate_aa: RateOrZero  # k^aa (3.6)
    rate_ax: RateOrZero  # k^ax (3.2)
    rate_bx: RateOrZero  # k^bx (3.3)
    alpha_aa: NonNegative  # stiffness of the apical junctions
    alpha_ax: NonNegative  # of the apical-nuclei spring
    alpha_bx: NonNegative  # of the basal-nuclei spring
    alpha_xx: NonNegative  # of the soft repulsion of nuclei
    alpha_axb: NonNegative  # of the bending spring


class NumericsSection(ParameterSection):
    """[numerics]: Tables 3 and 5 of chapter 3, and what is kept of a run."""

    dt: Duration  # between updates of rules and events
    substeps: Annotated[int, PlainValidator(Count(MOST_CELLS))]  # PBD steps in one dt
    mu: Duration  # damping coefficient
    noise: Annotated[str, PlainValidator(OneOf(("step", "substep")))]  # how often it is added
    t_end: Duration
    keep: Kept  # a state is kept every so often, or at these times; at the start and at the end in any case


class RulesSection(ParameterSection):
    """[rules]: where the variants of the model differ in more than a number."""

    spring_power: Annotated[int, PlainValidator(OneOf((1, 2)))]  # p of W = alpha (d - l)^2/l^p (3.9), (3.10)
    junction_factor: NonNegative  # k of a junction (3.11) over the mean alpha_aa of its two cells
    repulsion_factor: NonNegative  # k of the soft repulsion (3.13) over alpha_xx
    floor_rest_length: Flag  # desired rest length max(0, d - R_soft) in place of d - R_soft
    enlarge_from: Annotated[str, PlainValidator(OneOf(("mitosis", "G2")))]  # when the enlarged radius begins
    g2_stiffening: NonNegative  # factor of alpha_aa of a cell from G2 to division
    resting_cells_enlarge: Flag  # whether a cell without INM enlarges and stiffens all the same


class LayerSection(ParameterSection):
    """[layer]: the basal layer (further work of chapter 3); a file may leave it out for the line of the thesis."""

    shape: Annotated[str, PlainValidator(OneOf(("line", "circle", "ellipse", "points")))] = "line"
    perimeter: Length = Measure(300.0, "um")  # of the circle or ellipse
    aspect: Positive = 1.0  # of the ellipse: its vertical over its horizontal half axis; 1 is a circle
    side: Annotated[str, PlainValidator(OneOf(("inside", "outside")))] = "inside"  # of the closed curve: of the tissue
    closed: Flag = False  # whether the tissue is a closed tube; else it is an arc, or an open curve
    points: Points = ()  # of a smooth curve through them; the tissue is on its left if it is not closed


class DivisionSection(ParameterSection):
    """[division]: section 2.2.5 of chapter 3."""

    offset: Length  # of each daughter from the mother (3.7); at 0 the daughters would coincide
    new_junction: LengthOrZero  # rest length of the junction between daughters, and of all junctions at the start


class StartSection(ParameterSection):
    """[start]: where the nuclei are."""

    nuclei: Annotated[str, PlainValidator(OneOf(("box", "even", "own_basal")))]  # rule of their x
    nuclei_height: Fractions  # between which their y are drawn, of the height


class EmtSection(ParameterSection):
    """[emt]: the group of cells in the middle of the tissue that undergoes EMT (section 2.3 of chapter 4).

    An event fires in the step dt that ends at its time, or in which its time lies: it acts from the beginning of this
    step, so up to dt before its time.
    """

    cells: Annotated[int, PlainValidator(Count(MOST_CELLS, least=0))]  # N^EMT
    inm: Probability  # that an EMT cell performs interkinetic nuclear movement
    a: Begin  # T^A, loss of apical adhesion
    b: Begin  # T^B, loss of basal adhesion
    s: Begin  # T^S, loss of straightness
    p: Begin  # T^P, protrusions; they wait for [B]


class EventsSection(ParameterSection):
    """[events]: how the variants of the model carry out the events (section 2.2 of chapter 4)."""

    freed_stiffness: NonNegative  # factor of the stiffness of the spring to a freed point: [A], [B]
    bridge: Annotated[str, PlainValidator(OneOf(("sum", "distance")))]  # rest length of the junction that bridges [A]
    bent_stiffness: NonNegative  # of the bending spring after [S]
    run_speed: Speed  # v^run (4.1) of the basal point in [P]
    run_depth: Length  # below the basal line, where its run ends
    spring_above: Annotated[str, PlainValidator(OneOf(("no force", "gives way")))]  # while the point is above the line
    contraction: DurationOrZero  # time constant of the rest length below it; 0: at once
    at_depth: Annotated[str, PlainValidator(OneOf(("stays", "forces")))]  # the point at run_depth


class DahaSection(ParameterSection):
    """[daha]: Table 4 of chapter 3, the damped Arrow-Hurwicz method of the quasi-steady model."""

    alpha: Positive
    beta: Positive
    gamma: NonNegative
    c: Positive
    dtau: Positive
    eps: Positive
    most_iterations: Annotated[int, PlainValidator(Count(1_000_000_000))]
