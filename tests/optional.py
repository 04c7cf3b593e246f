"""What some tests need and a machine may lack: without it they are skipped, with the reason, but in CI they fail."""

from __future__ import annotations

import os
from ctypes.util import find_library
from importlib.util import find_spec

import pytest

# With this in the environment a test may not be skipped for what is missing: .ci/run says so.
NEEDED = "NOTHING_MISSING"


def lacking(reason: str) -> None:
    """Skip the test, or fail it where nothing may be missing."""
    (pytest.fail if os.environ.get(NEEDED) else pytest.skip)(reason)


def need_module(module: str) -> None:
    """Skip the test unless a module of Python is installed."""
    if find_spec(module) is None:
        lacking(f"{module} is not installed: make everything")


def need_rendering() -> None:
    """Skip the test unless VTK is installed and renders, by EGL."""
    need_module("pyvista")
    if find_library("EGL") is None:
        lacking("EGL is not installed, by which VTK renders; on Debian and Ubuntu: apt install libegl1")
