"""Programs of others, as schemes: the yardsticks of the chart of speed against accuracy. One program per file."""

from verification.beyond.chart.baselines.chipmunk import Chipmunk
from verification.beyond.chart.baselines.lsoda import Lsoda

__all__ = ["Chipmunk", "Lsoda"]
