"""Where there is no browser its tests are skipped with a reason, but never in CI, which installs one first."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.browser import NEEDED, launched

CI = Path(__file__).parents[2] / ".ci" / "run"
# Says what it is called with, and that a browser is needed, if it is.
TOLD = f'#!/bin/sh\necho "${{0##*/}} $* ${NEEDED}"\n'


@pytest.mark.parametrize(("needed", "outcome"), [(None, pytest.skip.Exception), ("1", pytest.fail.Exception)])
def test_missing_browser(needed: str | None, outcome: type[BaseException], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv(NEEDED, raising=False)
    if needed:
        monkeypatch.setenv(NEEDED, needed)
    with pytest.raises(outcome, match="no Chromium"), launched():
        pass


@pytest.mark.parametrize("there", [False, True])
def test_ci_installs_a_browser_if_there_is_none_and_needs_it(there: bool, tmp_path: Path) -> None:
    for name in ("apt-get", "make", *(["chromium"] if there else [])):
        (tmp_path / name).write_text(TOLD, "utf-8")
        (tmp_path / name).chmod(0o755)
    (tmp_path / "dirname").symlink_to(shutil.which("dirname"))
    env = {key: value for key, value in os.environ.items() if key != NEEDED} | {"PATH": str(tmp_path)}
    said = subprocess.run([shutil.which("bash"), CI], env=env, capture_output=True, text=True, check=True).stdout
    apt, tests = "apt-get install -qy --no-install-recommends chromium", "make test ARGS=--slow 1"
    assert tests in said
    assert (apt in said[: said.index(tests)]) is not there
