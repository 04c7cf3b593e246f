"""Growing epithelium: cells with apical point, nucleus and basal point, stepped by position based dynamics."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dincl.compiled import inner
    from tissue.files.parameters import Parameters, load, preset
    from tissue.fitting.results import fit, sensitivity
    from tissue.frames.frame import Frame
    from tissue.plugins import DivisionRule, EmtEvent, Force, Observable, Parameter, Variable
    from tissue.runs.force_error import force_error
    from tissue.runs.registration import register
    from tissue.runs.run import Run, RunFailed
    from tissue.runs.simulate import simulate, simulate_many
    from tissue.study.run import run_study
    from tissue.study.simplify import simplify

__all__ = [
    "DivisionRule",
    "EmtEvent",
    "Force",
    "Frame",
    "Observable",
    "Parameter",
    "Parameters",
    "Run",
    "RunFailed",
    "Variable",
    "fit",
    "force_error",
    "inner",
    "load",
    "preset",
    "register",
    "run_study",
    "sensitivity",
    "simplify",
    "simulate",
    "simulate_many",
]

_HOMES = {
    "DivisionRule": "plugins",
    "EmtEvent": "plugins",
    "Force": "plugins",
    "Frame": "frames.frame",
    "Observable": "plugins",
    "Parameter": "plugins",
    "Parameters": "files.parameters",
    "Run": "runs.run",
    "RunFailed": "runs.run",
    "Variable": "plugins",
    "fit": "fitting.results",
    "force_error": "runs.force_error",
    "inner": "plugins",
    "load": "files.parameters",
    "preset": "files.parameters",
    "register": "runs.registration",
    "run_study": "study.run",
    "sensitivity": "fitting.results",
    "simplify": "study.simplify",
    "simulate": "runs.simulate",
    "simulate_many": "runs.simulate",
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
