"""Programs of others, as schemes: the yardsticks of the chart of speed against accuracy. One program per file."""

from verification.yardsticks.chipmunk import Chipmunk
from verification.yardsticks.lsoda import Lsoda

__all__ = ["Chipmunk", "Lsoda"]
