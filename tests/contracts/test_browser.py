"""What is missing lets tests be skipped with a reason, but never in CI, which installs it first."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.browser import launched
from tests.optional import NEEDED, need_module

CI = Path(__file__).parents[2] / ".ci" / "run"
# Says what it is called with, and that nothing may be missing, if so.
TOLD = f'#!/bin/sh\necho "${{0##*/}} $* ${NEEDED}"\n'


@pytest.mark.parametrize(("needed", "outcome"), [(None, pytest.skip.Exception), ("1", pytest.fail.Exception)])
def test_missing_browser(needed: str | None, outcome: type[BaseException], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv(NEEDED, raising=False)
    if needed:
        monkeypatch.setenv(NEEDED, needed)
    with pytest.raises(outcome, match="no Chromium"), launched():
        pass


@pytest.mark.parametrize(("needed", "outcome"), [(None, pytest.skip.Exception), ("1", pytest.fail.Exception)])
def test_missing_module(needed: str | None, outcome: type[BaseException], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(NEEDED, raising=False)
    if needed:
        monkeypatch.setenv(NEEDED, needed)
    need_module("pytest")
    with pytest.raises(outcome, match="make everything"):
        need_module("no_such_module")


@pytest.mark.parametrize("there", [False, True])
def test_ci_installs_a_browser_if_there_is_none_and_needs_it(there: bool, tmp_path: Path) -> None:
    for name in ("apt-get", "make", *(["chromium"] if there else [])):
        (tmp_path / name).write_text(TOLD, "utf-8")
        (tmp_path / name).chmod(0o755)
    (tmp_path / "dirname").symlink_to(shutil.which("dirname"))
    env = {key: value for key, value in os.environ.items() if key != NEEDED} | {"PATH": str(tmp_path)}
    said = subprocess.run([shutil.which("bash"), CI], env=env, capture_output=True, text=True, check=True).stdout
    apt, tests = "apt-get install -qy --no-install-recommends chromium libegl1", "make test ARGS=--slow 1"
    assert said.index("make everything 1") < said.index(tests)
    assert (apt in said[: said.index(tests)]) is not there
