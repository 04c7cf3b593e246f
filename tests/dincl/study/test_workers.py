"""Workers end with the process that started them, however that ends; so does all else that it started."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

# Under nohup a hangup is ignored, by all that is started there, too.
PROGRAM = """
import signal
import time
from dincl.study import workers

if __name__ == "__main__":
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    with workers() as executor:
        busy = [executor.submit(time.sleep, 600) for _ in range(2)]
        while not all(one.running() for one in busy):
            time.sleep(0.01)
        assert executor.submit(abs, 1) is not None
        print("busy", flush=True)
        busy[0].result()
"""
PATIENCE = 60  # seconds, on a busy machine


def of_session(session: int) -> list[int]:
    """The processes of a session, but for those that have ended and only wait to be told of."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, _, belongs = stat.read_text().rpartition(")")[2].split()[:4]
        except OSError:
            continue  # it has ended meanwhile
        if int(belongs) == session and state != "Z":
            found.append(int(stat.parent.name))
    return found


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="asks /proc for the processes")
@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGKILL, signal.SIGHUP])
def test_nothing_is_left_behind(how: signal.Signals, tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text(PROGRAM)
    process = subprocess.Popen(
        [sys.executable, "program.py"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[3])},
        stdout=subprocess.PIPE,
        start_new_session=True,
        text=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "busy\n"
    assert len(of_session(process.pid)) == 4  # itself, two workers, what tidies up after them
    process.send_signal(how)
    assert process.wait(PATIENCE) == -how
    until = time.monotonic() + PATIENCE
    while (left := of_session(process.pid)) and time.monotonic() < until:
        time.sleep(0.02)
    for one in left:
        os.kill(one, signal.SIGKILL)
    process.stdout.close()
    assert left == []
