"""Short runs of the tissue."""

from tissue.files.parameters import preset
from tissue.runs.simulate import simulate


def simulated(name, seed, end, **changes):
    """A run of a preset until ``end`` [h], kept every hour, with some keys changed."""
    parameters = preset(name).changed({"numerics.t_end": f"{end} h", "numerics.keep": "1 h", **changes})
    return simulate(parameters, seed, throw=False)
