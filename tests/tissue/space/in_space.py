"""Small tissues in space for tests."""

from tissue.files.parameters import preset

SMALL = {
    "tissue.dimension": 3,
    "tissue.cells": 64,
    "numerics.t_end": "2 h",
    "tissue.two_daughters": 1,
    **dict.fromkeys(("tissue.apical_spacing", "tissue.basal_spacing", "tissue.max_basal_distance"), "2/3 R_soft"),
}
OF_CYLINDER = {
    "tissue.cells": 256,
    "space.rows": 8,
    "layer.shape": "circle",
    "layer.perimeter": "20 R_soft",
    "tissue.max_basal_distance": "2/3 R_soft",
    "tissue.height": "2 R_soft",
}
OF_SPHERE = {
    "tissue.cells": 200,
    "layer.shape": "sphere",
    "layer.perimeter": "15 R_soft",
    "layer.side": "outside",
    "tissue.max_basal_distance": "2/3 R_soft",
    "tissue.height": "3 R_soft",
}
SURFACES = {"plane": {}, "open": {"space.boundary": "open"}, "cylinder": OF_CYLINDER, "sphere": OF_SPHERE}


def parameters(**changes):
    """The published runs in space with other values, by keys with two underscores for the point."""
    return preset("published").changed(SMALL | {key.replace("__", "."): value for key, value in changes.items()})


def of_surface(name, **changes):
    """The same on a surface."""
    return parameters().changed(SURFACES[name] | {key.replace("__", "."): value for key, value in changes.items()})
