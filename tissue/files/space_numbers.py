"""Plain numbers of the parameters of a file that there are in space alone."""

from __future__ import annotations

from tissue.files.emt_sections import EventsSection
from tissue.files.sections import LayerSection, SpaceSection, TissueSection
from tissue.files.units import Measure, reduced
from tissue.model.lattice import Lattice, ball_lattice, flat_lattice, round_lattice, rows_of
from tissue.model.repulsion import SOFT
from tissue.state.space import MEAN, PRESENT, Exchange

# At the boundary of an open sheet neighbours are apart by the range of nuclei at most, or by twice the largest distance
# of basal points. With 2/3 R_soft the edge of a sheet frays into fingers: its junctions grow longer than that.
LEAST_REACH, REACH = SOFT, 2.0


def to_lattice(tissue: TissueSection, layer: LayerSection, space: SpaceSection, soft_radius: Measure) -> Lattice:
    """The basal points at the start.

    Raises
    ------
    InvalidProblem
        If the cells do not fill their rows.
    """
    cells, inside, periodic = tissue.cells, layer.side == "inside", space.boundary == "periodic"
    around = reduced(layer.perimeter, soft_radius)
    if layer.shape == "sphere":
        return ball_lattice(cells, around, inside=inside)
    rows = rows_of(cells, space.rows, strip=layer.shape == "circle" and not periodic)
    if layer.shape == "circle":
        return round_lattice(cells, rows, around, inside=inside, periodic=periodic)
    return flat_lattice(cells, rows, reduced(tissue.basal_spacing, soft_radius), periodic=periodic)


def to_exchange(tissue: TissueSection, space: SpaceSection, events: EventsSection, soft_radius: Measure) -> Exchange:
    """How cells exchange neighbours."""
    return Exchange(
        margin=space.flip_margin,
        reach=max(LEAST_REACH, REACH * reduced(tissue.max_basal_distance, soft_radius)),
        new_rest=MEAN if space.new_rest == "mean" else PRESENT,
    )
