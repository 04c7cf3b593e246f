"""What tests of forces of users share."""

import numpy as np

import tissue
from tissue.plugins import registered
from tissue.state.cells import COORDINATES

NAME = "own_forces_copy"
WALL, POINT = 6.0, (1.0, 3.0)  # as there: who imports it registers its forces
SHORT = {"numerics.t_end": "4 h", "numerics.keep": "1 h", "tissue.cells": 30, "tissue.width": "8 R_soft"}
# Every cell divides once or twice, so that the stores grow.
LIVELY = {"cell.min_cycle": "1 h", "cell.max_cycle": "3 h", "cell.g2": "0.4 h", "cell.mitosis": "0.4 h"}
EMT = {"emt.cells": 4, "emt.b": "0.5 h to 2 h", "emt.p": "2 h"}
TUBE = {"layer.shape": "circle", "layer.perimeter": "60 R_soft", "layer.side": "outside", "tissue.cells": 180}
LAYERS = {"line": {}, "arc": {**TUBE, "tissue.cells": 60}, "tube": {**TUBE, "layer.closed": True}}


def named(name):
    return next(force for force in registered(tissue.Force) if force.name == name)


def published(own, **changes):
    return tissue.preset("published").changed({"own.modules": [str(own)], **SHORT, **changes})


def distance(a, b):
    return max(np.abs(getattr(a, name) - getattr(b, name)).max() for name in COORDINATES)


def nothing(store, on, strength, numbers):
    pass
