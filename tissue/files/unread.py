"""Keys of [layer] and [space] that nothing reads: those of another shape or dimension."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from tissue.files.rule import show
from tissue.files.sections import LayerSection, SpaceSection

if TYPE_CHECKING:
    from tissue.files.parameters import Parameters

MAKES_NO_NUMBERS = True

# The keys of [layer] that each shape reads in a slice; in three dimensions a surface is neither "closed" nor open.
OF_SHAPE = {
    "line": (),
    "circle": ("perimeter", "side", "closed"),
    "ellipse": ("perimeter", "aspect", "side", "closed"),
    "points": ("points", "side", "closed"),
    "sphere": ("perimeter", "side"),
}
OF_SHEETS = ("rows", "boundary")  # a sphere has neither


def idle_keys(parameters: Parameters) -> list[str]:
    """Return a sentence for each key of [layer] and [space] that is not at its default, though nothing reads it."""
    defaults = {"layer": LayerSection(), "space": SpaceSection()}
    lines = []
    for key, why in idle_values(parameters):
        section, _, name = key.partition(".")
        value: Any = getattr(getattr(parameters, section), name)
        if value != getattr(defaults[section], name):
            lines.append(f"nothing reads {key} = {str(value).lower() if value is True else show(value)}: {why}")
    return lines


def idle_values(parameters: Parameters) -> Iterator[tuple[str, str]]:
    """Give the keys of [layer] and [space] that nothing reads, each with the value of the key that decides it."""
    layer, in_space = parameters.layer, parameters.in_space
    shape = f"layer.shape = {show(layer.shape)}"
    dimension = f"tissue.dimension = {parameters.tissue.dimension}"
    for name in LayerSection.model_fields:
        if name == "closed" and in_space:
            yield "layer.closed", dimension
        elif name == "side" and layer.shape == "points" and not layer.closed:
            yield "layer.side", "layer.closed = false"
        elif name != "shape" and name not in OF_SHAPE[layer.shape]:
            yield f"layer.{name}", shape
    for name in SpaceSection.model_fields:
        if not in_space:
            yield f"space.{name}", dimension
        elif name in OF_SHEETS and layer.shape == "sphere":
            yield f"space.{name}", shape
