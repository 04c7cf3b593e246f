"""The parameters of a run as plain numbers: lengths in units of R_soft, times in hours, energies without unit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, get_type_hints

from dincl.compiled import StructPointer, reader, struct_type
from dincl.compiled.structs import struct_after
from tissue.state.cells import PARAMETERS


class UserNumbers(NamedTuple):
    """The parameters that users registered, in this order; 0 where there are fewer."""

    p0: float = 0.0
    p1: float = 0.0
    p2: float = 0.0
    p3: float = 0.0
    p4: float = 0.0
    p5: float = 0.0
    p6: float = 0.0
    p7: float = 0.0


class Numbers(NamedTuple):
    """Numbers that the kernels compute with; made from the parameters of a file by ``Parameters.numbers``."""

    # Time stepping (Tables 3 and 5 of chapter 3)
    dt: float  # between updates of rules and events [h]
    substeps: int  # PBD steps in one dt
    mu: float  # damping [h]: mu dZ/dt = -grad W, energies having no unit
    variance: float  # 2 D: of the noise per coordinate and hour [1/h]
    noise_in_substeps: bool  # noise in each substep, in place of once before them
    # Energies
    spring_power: int  # p of the springs, W = alpha (d - l)^2 / l^p with l = 1 + eta
    junction_factor: float  # k of a junction over the mean alpha_aa of its cells, force k (d - eta)
    repulsion: float  # k of the soft repulsion of two such cells, force k (2 - d) for d < 2
    max_basal_distance: float  # largest distance of neighbours in the basal layer (C2); of two types the mean
    # Cells (Table 2 of chapter 3)
    alpha_aa: float
    alpha_ax: float
    alpha_bx: float
    alpha_axb: float
    soft_radius: float  # R_soft of these cells, 1 but for types with one of their own
    hard_radius: float
    enlarged_radius: float
    g2: float  # durations [h]
    mitosis: float
    min_cycle: float
    max_cycle: float
    rate_aa: float  # speeds of adaptation k [1/h]
    rate_ax: float
    rate_bx: float
    max_cytoskeleton: float  # largest sum of the desired rest lengths eta_ax + eta_bx, inf for none
    # Rules
    two_daughters: float  # probability that both daughters stay in the plane
    offset: float
    new_junction: float  # rest length of the junction between two daughters
    floor_rest_length: bool  # desired rest length max(0, d - 1) in place of d - 1
    enlarge_in_g2: bool  # the enlarged radius from G2 on, in place of from mitosis on
    g2_stiffening: float  # factor of alpha_aa of a cell from G2 to division
    resting_cells_enlarge: bool  # cells without INM enlarge and stiffen like the others
    # EMT events
    freed_stiffness: float  # factor of the spring to a freed point: [A], [B]
    bridge_present: bool  # the junction that bridges [A] rests at the present distance, in place of the sum of both
    bent_stiffness: float  # of the bending spring after [S]
    run_speed: float  # of the basal point in [P] [1/h]
    run_depth: float  # below the basal line, where its run ends
    spring_gives: bool  # above the basal line the basal spring grows at run_speed, in place of being without force
    contraction: float  # time in which its rest length decreases to 1/e below the line [h]; 0: at once
    forced_below: bool  # at run_depth the point follows the forces, in place of staying where it is
    own: UserNumbers = UserNumbers()  # each also a field of its name

    @staticmethod
    def entries() -> dict[str, tuple[str, int]]:
        """Return the names of parameters of users, which kernels read as fields."""
        return {name: ("own", k) for k, name in enumerate(PARAMETERS)}

    @property
    def scale(self) -> float:
        """h / mu, the time step of a substep over the damping: a force moves a point by it."""
        return self.dt / self.substeps / self.mu

    @property
    def substep_variance(self) -> float:
        """The variance of the noise in a substep, 0 if noise comes once per dt."""
        return self.variance * self.dt / self.substeps if self.noise_in_substeps else 0.0


class StartNumbers(NamedTuple):
    """Numbers that the first state is made from; ``Parameters.start_numbers`` makes them from a file.

    Apical points lie at y = height, basal points at y = 0, each row evenly spaced and centred on the box of the nuclei.
    """

    cells: int
    height: float
    width: float  # of the box of the nuclei
    apical_spacing: float
    basal_spacing: float
    nuclei: str  # x: "box" anywhere in the width, "even" spacing dx = width/(cells + 1) plus U(-dx, dx), "own_basal"
    nuclei_low: float  # y: between these two heights
    nuclei_high: float
    initial_rest_length: float  # eta of both cytoskeleton springs, without the radius R_soft
    new_junction: float  # eta of the apical junctions


# Yes and no are integers in memory.
_PLAIN: Any = (0.0 if kind is float else 0 for kind in [*get_type_hints(Numbers).values()][:-1])
_EXAMPLE: Any = Numbers(*_PLAIN)
NUMBERS = struct_type(_EXAMPLE)
numbers_at = reader(_EXAMPLE)
# numbers_of(numbers, kind): the numbers of the cells of a kind, from those that ``numbers_pointer`` passes to kernels.
numbers_of = struct_after


def numbers_pointer(numbers: Numbers, named: Sequence[Numbers] = ()) -> Any:
    """Make the struct of the numbers of a run: for kernels it is ``Numbers``, those of control cells.

    Behind these lie those of EMT cells, the same, and of the named types, so that ``Cells.kind`` says where.
    """
    kinds = (numbers, numbers, *named)
    return StructPointer(
        tuple(
            (*(type(one)(value) for one, value in zip(_EXAMPLE[:-1], kind, strict=False)), kind.own) for kind in kinds
        ),
        NUMBERS,
    )
