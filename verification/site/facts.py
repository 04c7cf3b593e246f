"""Facts on which numbers depend besides the code: the machine, and the versions of libraries."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterator
from pathlib import Path

from dincl.study.record import libraries


def machine() -> Iterator[tuple[str, str]]:
    """Yield the machine, and the versions of the libraries that make numbers."""
    yield "Processor", f"{_processor()}, {os.cpu_count()} cores"
    yield "System", f"{platform.system()} {platform.release()}, Python {platform.python_version()}"
    yield "Versions", ", ".join(map(" ".join, libraries().items()))


def _processor() -> str:
    """Return the model of the processor, if the system tells it."""
    information = Path("/proc/cpuinfo")
    lines = information.read_text("utf-8").splitlines() if information.exists() else []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor() or platform.machine()
