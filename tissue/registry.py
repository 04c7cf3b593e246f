"""The shelf of what users have added to the tissue, by kind and name; see ``tissue.registration``."""

from __future__ import annotations

from typing import Any, TypeVar

Thing = TypeVar("Thing")
_REGISTERED: dict[type, dict[str, Any]] = {}


def shelf(kind: type) -> dict[str, Any]:
    """What was registered of a kind, by name, the first one first."""
    return _REGISTERED.setdefault(kind, {})


def registered(kind: type[Thing]) -> tuple[Thing, ...]:
    """The same in the order of the names: that in which modules are imported may be another one in another process."""
    return tuple(thing for _, thing in sorted(shelf(kind).items()))
