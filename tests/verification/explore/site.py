"""The server of the page in a process of its own, and what tests ask of its pages."""

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from verification.explore.tissues.dialogs import parameters_text

COMMAND = [sys.executable, "-c", "from tissue.cli import main; main()", "explore", "--no-browser"]
ROOT = Path(__file__).parents[3]


@contextmanager
def served(folder: Path, *arguments: str) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """The address of a server of this folder, and its process, which is ended at the end."""
    free = {key: value for key, value in os.environ.items() if not key.startswith("PYTEST")}
    process = subprocess.Popen(
        [*COMMAND, *arguments],
        cwd=folder,
        env=free | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    try:
        yield process.stdout.readline().strip(), process
    finally:
        process.terminate()
        process.wait(60)
        process.stdout.close()


def write_base(folder: Path, setting) -> None:
    """A parameter file that a page begins with."""
    (folder / "small.toml").write_text(parameters_text(setting))


def cpu_ticks(pid: int) -> int:
    """CPU time of a process, all its threads."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return int(fields[11]) + int(fields[12])


def numbers(page) -> dict[str, list[str]]:
    """The table of the answer: texts by name."""
    cells = page.evaluate(
        "[...document.querySelectorAll('.numbers tbody tr')].map(r => [...r.cells].map(c => c.innerText))"
    )
    return {first: rest for first, *rest in cells if rest}


def wait_for_runs(page, runs: int, name: str = "") -> None:
    """Until so many runs are in the answer, and no more come."""
    page.wait_for_function(
        """([runs, name]) => {
            const told = document.querySelector('[data-is=runs]');
            return told?.dataset.runs == runs && told.innerText.startsWith(name) && !told.innerText.includes('...');
        }""",
        arg=[runs, name],
    )


def interval(text: str) -> list[float]:
    """The numbers in a text such as "14.4 % [10.0, 20.3]"."""
    return [float(number) for number in re.findall(r"-?[0-9.]+", text)]


def field(page, key: str):
    """The text field of a knob."""
    return page.get_by_label(key, exact=True).and_(page.locator("input"))


def enter(page, key: str, text: str) -> None:
    """Type into the field of a knob, and leave it."""
    field(page, key).fill(text)
    field(page, key).press("Enter")
    field(page, key).blur()


def change(page, key: str, text: str) -> None:
    """Enter what is accepted, and wait until its picture is there."""
    before = run_of(page)
    enter(page, key, text)
    wait_for_run(page, before)


def run_of(page) -> int:
    """How many runs have been shown."""
    return int(page.locator(".player").get_attribute("data-run"))


def wait_for_run(page, before: int) -> None:
    """Until another run is shown."""
    page.wait_for_function("before => Number(document.querySelector('.player')?.dataset.run) > before", arg=before)
