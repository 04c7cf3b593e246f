"""Programs of others, as schemes: the yardsticks of the chart of speed against accuracy. One program per file."""

from verification.thesis.chapter2.yardsticks.chipmunk import Chipmunk
from verification.thesis.chapter2.yardsticks.lsoda import Lsoda

__all__ = ["Chipmunk", "Lsoda"]
