"""Compile what tests of several files call, before they are read: ``python -m tests.compile_kernels HALF [tissue]``.

Two processes compile a half each, of about the same time: later each process with tests would compile all it needs.
"""

import sys
from importlib import import_module

import dincl


def steps(tissue: bool) -> None:
    """Compile the steps of all schemes, where they are defined, and what is called when tests are read."""
    if tissue:
        import_module("tests.borders.tissue_calls")
    for name in ("catch_up", "programs", "sweeping"):
        import_module(f"dincl.steps.{name}")
    import_module("tests.borders.dincl_calls")


def events(tissue: bool) -> None:
    """Compile the event-driven scheme and the kernels of the tissue that are called first in a test."""
    scene = dincl.scenes.two_disks()
    dincl.solve(scene, dincl.EventDriven(1e-6), scene.times)
    if tissue:
        import_module("verification.thesis.chapter3.page").prepare()


HALVES = {half.__name__: half for half in (steps, events)}

if __name__ == "__main__":
    half, *about = sys.argv[1:]
    HALVES[half]("tissue" in about)
