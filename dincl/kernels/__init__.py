"""Compiled loops on plain arrays, loaded on first use so that importing ``dincl`` does not import numba.

Steps of schemes and searches for neighbours have plain reference implementations in ``tests/twins`` that do the same
floating-point operations in the same order, so that both agree bit for bit. The event-driven run is compared, to its
stated error, with a plain form by other libraries.
"""

from importlib import import_module
from types import ModuleType

SUBMODULES = ("neighbours", "products")


def __getattr__(name: str) -> ModuleType:
    """Import a submodule when it is first asked for (PEP 562)."""
    if name in SUBMODULES:
        return import_module(f"{__name__}.{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """Names this package offers."""
    return sorted(SUBMODULES)
