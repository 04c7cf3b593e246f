"""A signal that ends a command, or a program with workers, ends all processes that it started, whatever they do."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
REPORT = "import sys; from verification.command import main; sys.argv[1:] = ['report']; main()"
STUDY = "import sys; from tissue.cli import main; sys.argv[1:] = ['study', 'table5_7', '--out', 'out']; main()"
# Two workers that hold the interpreter's lock, as libraries in C may do for minutes.
HOLDING = """
import signal
import time
from dincl.study import workers

signal.signal(signal.SIGHUP, signal.SIG_DFL)  # under nohup a hangup is ignored, by workers, too
executor = workers()
sums = [executor.submit(sum, range(10**12)) for _ in range(2)]
time.sleep(60)
"""
# Each program, and how many processes of its own it has at work: of a report and its workers also the one that tracks
# what they share. A study computes in threads.
LOCKED = "workers that hold the lock"
PROGRAMS = {"report": (REPORT, 4), "study": (STUDY, 1), LOCKED: (HOLDING, 4)}
BEGUN, AT_WORK, GONE = 60.0, 3.0, 2.0  # seconds: to have all processes, to let them begin, to be gone


def processes(session: int) -> list[int]:
    """List the processes of a session that have not ended."""
    found = []
    for file in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, _, its = file.read_text().rpartition(")")[2].split()[:4]
        except OSError:  # it ended while this looked
            continue
        if int(its) == session and state not in "ZX":
            found.append(int(file.parent.name))
    return found


def wait_until(condition: Callable[[], bool], seconds: float) -> bool:
    """Return whether a condition came true in time."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.05)
    return True


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="processes are counted in /proc")
@pytest.mark.parametrize(
    ("name", "how"),
    [*((name, signal.SIGTERM) for name in PROGRAMS), (LOCKED, signal.SIGKILL), (LOCKED, signal.SIGHUP)],
)
def test_no_process_is_left(name: str, how: signal.Signals, tmp_path: Path) -> None:
    program, count = PROGRAMS[name]
    env = os.environ | {"PYTHONPATH": str(ROOT)}
    with (tmp_path / "said").open("wb") as said:
        command = [sys.executable, "-c", program]
        main = subprocess.Popen(command, cwd=tmp_path, env=env, stdout=said, stderr=said, start_new_session=True)
    try:
        assert wait_until(lambda: len(processes(main.pid)) >= count, BEGUN), (tmp_path / "said").read_text()
        time.sleep(AT_WORK)
        assert main.poll() is None, (tmp_path / "said").read_text()
        main.send_signal(how)
        assert wait_until(lambda: not processes(main.pid), GONE), processes(main.pid)
        assert main.wait(GONE) == -how
    finally:
        for process in processes(main.pid):
            os.kill(process, signal.SIGKILL)
        main.wait()
