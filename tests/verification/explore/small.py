"""A tissue that grows in no time, for tests of the page."""

SMALL = {
    "tissue.cells": 12,
    "tissue.width": "20 um",
    "numerics.t_end": "4 h",
    "emt.cells": 3,
    "emt.a": "1 h to 3 h",
    "emt.b": "1 h to 3 h",
}
