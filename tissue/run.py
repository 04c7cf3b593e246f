"""What a simulation returns: the kept states, how it ended, and the counted work."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from dincl.status import Status
from tissue.frame import Frame
from tissue.start import Parted

if TYPE_CHECKING:
    import pandas as pd

    from tissue.parameters import Parameters


@dataclass(frozen=True, eq=False, repr=False)
class Run:
    """The tissue at the kept times.

    Attributes
    ----------
    parameters, seed
        What the run is a function of.
    frames
        The kept states in the order of time, the first at t = 0; after a failure those before it and last the state
        that failed.
    status, detail
        How the run ended, and the particulars in words ("" on success).
    stats
        Counted work by name.
    parted
        What made the drawn first state feasible.
    """

    parameters: Parameters
    seed: int
    frames: tuple[Frame, ...]
    status: Status
    detail: str
    stats: dict[str, int]
    parted: Parted

    @property
    def final(self) -> Frame:
        """The last state."""
        return self.frames[-1]

    def table(self) -> pd.DataFrame:
        """One row for each kept time and cell: phase, age, positions in um; the columns of ``tissue.tables``."""
        from tissue.tables import cell_table

        return cell_table(self.frames, self.parameters)

    def summary(self) -> pd.DataFrame:
        """One row for each kept time: cells, height, widths, extrusions; the columns of ``tissue.tables``."""
        from tissue.tables import summary_table

        return summary_table(self.frames, self.parameters)

    def __repr__(self) -> str:
        return f"Run({self.status.name}, t = {self.final.t:g} h, {len(self.final.cells.x)} cells, seed {self.seed})"


class RunFailed(RuntimeError):
    """A simulation that stopped early; ``run`` holds everything up to then."""

    def __init__(self, run: Run) -> None:
        super().__init__(f"{run.status.value} {run.detail}")
        self.run = run
