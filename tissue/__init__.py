"""Growing epithelium: cells with apical point, nucleus and basal point, stepped by position based dynamics."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tissue.division import DivisionRule
    from tissue.events.event import EmtEvent
    from tissue.files.parameters import Parameters, load, preset
    from tissue.first_order import simulate
    from tissue.force import Force
    from tissue.many import simulate_many
    from tissue.observable import Observable
    from tissue.registration import register
    from tissue.run import Run, RunFailed
    from tissue.slopes import force_error
    from tissue.state.frame import Frame
    from tissue.study.run import run_study

__all__ = [
    "DivisionRule",
    "EmtEvent",
    "Force",
    "Frame",
    "Observable",
    "Parameters",
    "Run",
    "RunFailed",
    "force_error",
    "load",
    "preset",
    "register",
    "run_study",
    "simulate",
    "simulate_many",
]

_HOMES = {
    "DivisionRule": "division",
    "EmtEvent": "events.event",
    "Force": "force",
    "Frame": "state.frame",
    "Observable": "observable",
    "Parameters": "files.parameters",
    "Run": "run",
    "RunFailed": "run",
    "force_error": "slopes",
    "load": "files.parameters",
    "preset": "files.parameters",
    "register": "registration",
    "run_study": "study.run",
    "simulate": "first_order",
    "simulate_many": "many",
}


def __getattr__(name: str) -> Any:
    """Import a public name, and with it numba and pydantic, when it is first asked for."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from dincl.extras import needs

    with needs(f"tissue.{name}", "tissue"):
        return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
