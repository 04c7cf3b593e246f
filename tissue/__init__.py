"""Growing epithelium: cells with apical point, nucleus and basal point, stepped by position based dynamics."""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tissue.parameters import Parameters, load, preset
    from tissue.run import Frame, Run, RunFailed
    from tissue.simulate import simulate

__all__ = ["Frame", "Parameters", "Run", "RunFailed", "load", "preset", "simulate"]

HOMES = {
    "Frame": "run",
    "Parameters": "parameters",
    "Run": "run",
    "RunFailed": "run",
    "load": "parameters",
    "preset": "parameters",
    "simulate": "simulate",
}


class _Package(ModuleType):
    """A package that imports its public names, and with them numba and pydantic, when they are first asked for."""

    def __getattr__(self, name: str) -> Any:
        if name not in HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        found = getattr(import_module(f"{__name__}.{HOMES[name]}"), name)
        setattr(self, name, found)
        return found

    def __setattr__(self, name: str, value: Any) -> None:
        # Python stores a module of the package under its name: ``simulate`` shall stay the function.
        if name not in HOMES or not isinstance(value, ModuleType):
            super().__setattr__(name, value)

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *__all__})


sys.modules[__name__].__class__ = _Package
