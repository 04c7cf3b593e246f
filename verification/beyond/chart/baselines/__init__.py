"""External programs as schemes: the baselines of the chart of speed against accuracy, one program per file."""

from verification.beyond.chart.baselines.chipmunk import Chipmunk
from verification.beyond.chart.baselines.lsoda import Lsoda

__all__ = ["Chipmunk", "Lsoda"]
