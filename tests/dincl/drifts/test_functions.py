"""Drifts called by their address: every number is checked, and the machine code serves any address."""

import ctypes
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from dincl.constants import LARGEST
from dincl.drifts.functions import FAILED, NOT_A_NUMBER, OK
from tests.dincl.system.drift_runs import asked

WORD, PLACE = ctypes.c_int64, ctypes.POINTER(ctypes.c_double)
DRIFT = ctypes.CFUNCTYPE(WORD, ctypes.c_double, PLACE, PLACE, WORD, WORD, PLACE)
ROOT = Path(__file__).parents[3]
PROGRAM = """
import ctypes, sys
import numpy as np
from caller import total

WORD, PLACE = ctypes.c_int64, ctypes.c_void_p
DRIFT = ctypes.CFUNCTYPE(WORD, ctypes.c_double, PLACE, PLACE, WORD, WORD, PLACE)
function = DRIFT(lambda t, x, out, n, d, data: int(sys.argv[1]))
address = ctypes.cast(function, ctypes.c_void_p).value
print(total(address, np.zeros((2, 2)), np.zeros(1)), sum(total.stats.cache_misses.values()))
"""
CALLER = """
from dincl.compiled import kernel
from dincl.drifts.functions import call_drift


@kernel
def total(address, x, data):
    return call_drift(address, 0.0, x, x, 2, 2, data)
"""


def address(function):
    return ctypes.cast(function, ctypes.c_void_p).value


@pytest.mark.parametrize(
    ("value", "code"),
    [
        (1.0, OK),
        (LARGEST, OK),
        (-LARGEST, OK),
        (np.nextafter(LARGEST, np.inf), NOT_A_NUMBER),
        (-np.inf, NOT_A_NUMBER),
        (np.nan, NOT_A_NUMBER),
    ],
)
@pytest.mark.parametrize("place", [0, 3, 5])
def test_every_number_is_checked(place, value, code):
    def drift(t, x, out, n, d, data):
        for k in range(6):
            out[k] = value if k == place else 0.0
        return 0

    function = DRIFT(drift)
    assert asked(address(function), 0.0, np.zeros((3, 2)), np.zeros((3, 2)), 3, 2, np.zeros(1)) == code


@pytest.mark.parametrize(("returned", "code"), [(1, FAILED), (-1, FAILED), (0, NOT_A_NUMBER)])
def test_a_drift_that_does_not_answer_is_seen(returned, code):
    function, out = DRIFT(lambda *_: returned), np.zeros((3, 2))
    assert asked(address(function), 0.0, np.zeros((3, 2)), out, 3, 2, np.zeros(1)) == code


@pytest.mark.slow
def test_one_machine_code_serves_any_address_in_any_process(tmp_path):
    (tmp_path / "caller.py").write_text(CALLER)
    env = os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])}
    found = []
    for code in ("3", "4"):
        run = subprocess.run(
            [sys.executable, "-c", PROGRAM, code], env=env, cwd=ROOT, capture_output=True, text=True, check=True
        )
        found.append(run.stdout.split())
    assert found == [["3", "1"], ["4", "0"]]
