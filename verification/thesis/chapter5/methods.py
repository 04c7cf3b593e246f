"""The ways from a start to y(t) that the studies compare."""

from __future__ import annotations

from meanfield import Model, Positions, reduce
from verification.instruments.meanfield_methods import density_methods, particle_methods

# By their names in tables; with the settings for given particles where there are any.
METHODS = density_methods() | particle_methods()
LABELS = {name: method.label for name, method in METHODS.items()}


def applies(method: str, model: Model) -> bool:
    """Return whether a method can solve a model: only some models can be reduced."""
    return method != "reduced" or reduce(model).positions is not Positions.FLOW
