"""Plain numbers of the parameters of a file, which have units: what kernels and the start of a run compute with."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from tissue.files.units import Measure, reduced
from tissue.kernels.workspace import SOFT
from tissue.model.lattice import Lattice, ball_lattice, flat_lattice, round_lattice, rows_of
from tissue.state.basal_curve import BasalCurve
from tissue.state.numbers import Numbers, StartNumbers
from tissue.state.space import MEAN, PRESENT, Exchange

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters


def to_numbers(parameters: Parameters) -> Numbers:
    """Compute what kernels take: lengths over R_soft, times in h, 2 D as the variance of the noise per hour."""
    tissue, cell, numerics = parameters.tissue, parameters.cell, parameters.numerics
    rules, division, events = parameters.rules, parameters.division, parameters.events
    longest = cell.max_cytoskeleton
    return Numbers(
        dt=numerics.dt.value,
        substeps=numerics.substeps,
        mu=numerics.mu.value,
        variance=2 * reduced(tissue.diffusion, cell.soft_radius),
        noise_in_substeps=numerics.noise == "substep",
        power=rules.spring_power,
        junction_factor=rules.junction_factor,
        repulsion=rules.repulsion_factor * cell.alpha_xx,
        max_basal=reduced(tissue.max_basal_distance, cell.soft_radius),
        alpha_aa=cell.alpha_aa,
        alpha_ax=cell.alpha_ax,
        alpha_bx=cell.alpha_bx,
        alpha_axb=cell.alpha_axb,
        soft_radius=1.0,
        hard_radius=reduced(cell.hard_radius, cell.soft_radius),
        enlarged_radius=reduced(cell.enlarged_radius, cell.soft_radius),
        g2=cell.g2.value,
        mitosis=cell.mitosis.value,
        min_cycle=cell.min_cycle.value,
        max_cycle=cell.max_cycle.value,
        rate_aa=cell.rate_aa.value,
        rate_ax=cell.rate_ax.value,
        rate_bx=cell.rate_bx.value,
        max_cytoskeleton=math.inf if longest is None else reduced(longest, cell.soft_radius),
        two_daughters=tissue.two_daughters,
        division_offset=reduced(division.offset, cell.soft_radius),
        new_junction=reduced(division.new_junction, cell.soft_radius),
        floor_rest=rules.floor_rest_length,
        enlarge_in_g2=rules.enlarge_from == "G2",
        g2_stiffening=rules.g2_stiffening,
        resting_enlarge=rules.resting_cells_enlarge,
        freed_stiffness=events.freed_stiffness,
        bridge_present=events.bridge == "distance",
        bent_stiffness=events.bent_stiffness,
        run_speed=reduced(events.run_speed, cell.soft_radius),
        run_depth=reduced(events.run_depth, cell.soft_radius),
        spring_gives=events.spring_above == "gives way",
        contraction=events.contraction.value,
        forced_below=events.at_depth == "forces",
    )


def to_start_numbers(parameters: Parameters, curve: BasalCurve) -> StartNumbers:
    """Compute what the first state is made from: lengths over R_soft. A ring is spread evenly over its layer."""
    tissue, cell, start = parameters.tissue, parameters.cell, parameters.start
    soft_radius = cell.soft_radius
    even = Measure(curve.length / tissue.cells, "R_soft") if curve.ring else None
    height = reduced(tissue.height, soft_radius)
    low, high = start.nuclei_height
    return StartNumbers(
        cells=tissue.cells,
        height=height,
        width=curve.length if curve.ring else reduced(tissue.width, soft_radius),
        apical_spacing=reduced(even or tissue.apical_spacing, soft_radius),
        basal_spacing=reduced(even or tissue.basal_spacing, soft_radius),
        nuclei=start.nuclei,
        nuclei_low=low * height,
        nuclei_high=high * height,
        rest_length=reduced(cell.initial_rest_length, soft_radius),
        junction=reduced(parameters.division.new_junction, soft_radius),
    )


# At the boundary of an open sheet neighbours are apart by the range of nuclei at most, or by twice the largest distance
# of basal points. With 2/3 R_soft the edge of a sheet frays into fingers: its junctions grow longer than that.
LEAST_EDGE, EDGE = SOFT, 2.0


def to_lattice(parameters: Parameters) -> Lattice:
    """Place the basal points at the start; raises InvalidProblem if the cells do not fill their rows."""
    tissue, layer, space = parameters.tissue, parameters.layer, parameters.space
    soft_radius = parameters.cell.soft_radius
    cells, inside, periodic = tissue.cells, layer.side == "inside", space.boundary == "periodic"
    around = reduced(layer.perimeter, soft_radius)
    if layer.shape == "sphere":
        return ball_lattice(cells, around, inside=inside)
    rows = rows_of(cells, space.rows, strip=layer.shape == "circle" and not periodic)
    if layer.shape == "circle":
        return round_lattice(cells, rows, around, inside=inside, periodic=periodic)
    return flat_lattice(cells, rows, reduced(tissue.basal_spacing, soft_radius), periodic=periodic)


def to_exchange(parameters: Parameters) -> Exchange:
    """Compute how cells exchange neighbours."""
    largest, space = parameters.tissue.max_basal_distance, parameters.space
    return Exchange(
        margin=space.flip_margin,
        longest=max(LEAST_EDGE, EDGE * reduced(largest, parameters.cell.soft_radius)),
        new_rest=MEAN if space.new_rest == "mean" else PRESENT,
    )
