"""The projections: one back end per file, each imported when a solver is made."""

from dincl.projection.base import Projected, Projection

__all__ = ["Projected", "Projection"]
