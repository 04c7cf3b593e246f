"""Try random mutants in a copy of the tree: ``python -m tests.mutants COUNT [PATH ...]``, or ``make mutants``.

Each mutant is tried by the tests that reach its module, nearest first, until one fails. A row of the table says which,
"survived", or "time out". Mutants that have a row are not tried again; their order depends on their text only.
"""

import csv
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from hashlib import sha256
from pathlib import Path

from tests.mutants.operators import Mutant, mutants
from tests.mutants.reach import ROOT, tests_of

SEED = b"20261126"
HOME = ROOT / "build" / "mutants"
COPY, TABLE, TIMES = HOME / "tree", HOME / "mutants.csv", HOME / "times.json"
HEADER = ("file", "line", "scope", "before", "after", "outcome", "seconds")
COPIED = ("dincl", "docs", "meanfield", "tests", "tissue", "verification", "pyproject.toml", "README.md")
# The modules that compute, or decide what a result is worth.
MUTATED = tuple(
    f"{package}/{name}"
    for package, names in {
        "dincl": "compiled/cache.py constraints drifts equivalence events files.py geometry matrices minimise "
        "neighbours norms.py projection rows scenes schemes solvers steps study system trajectory.py",
        "meanfield": "density forces model solvers transport weights.py",
        "tissue": "events files/cell_types.py files/type_rules.py kernels model network quasi_steady rules "
        "runs/force_error.py runs/start.py runs/tables.py state statistics step study/outcomes.py study/sensitivity.py",
        "verification": "claims/evidence.py instruments proofs",
    }.items()
    for name in names.split()
)
# The tests of a mutant take so many seconds on the clean tree, first without those marked slow, then with them.
BUDGETS = {"": 40.0, "-m slow --slow": 20.0}
# A file that takes longer on its own is left out. A mutant that takes so many times as long has lost its end.
LONGEST, TIMES_AS_LONG, COMPILING = 60.0, 3.0, 60.0
TEST = [sys.executable, "-m", "pytest", "-x", "-q", "--no-header", "-p", "no:cacheprovider"]
FAILED = re.compile(r"^(?:FAILED|ERROR) (\S+)", re.MULTILINE)


def pytest_run(files: list[Path], flag: str, limit: float) -> tuple[str, float]:
    """Run files of tests in the copy: "" if all pass, else what failed or "time out"; and the seconds."""
    paths = {"PYTHONPATH": str(COPY), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    command = [*TEST, *flag.split(), *(str(file.relative_to(ROOT)) for file in files)]
    begin = time.monotonic()
    log = HOME / "last.log"
    with log.open("w") as out:
        process = subprocess.Popen(command, cwd=COPY, env=os.environ | paths, stdout=out, stderr=out, process_group=0)
        try:
            code = process.wait(limit)
        except subprocess.TimeoutExpired:
            return "time out", time.monotonic() - begin
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
    failed = FAILED.search(log.read_text("utf-8", errors="replace"))
    outcome = "" if code in (0, 5) else f"killed by {failed[1] if failed else f'exit code {code}'}"
    return outcome, time.monotonic() - begin


def chosen(module: Path, flag: str, times: dict[str, float]) -> tuple[list[Path], float]:
    """The nearest files of tests that fit into the budget, and the seconds that they take on the clean tree."""
    files: list[Path] = []
    total = 0.0
    for file in tests_of(module):
        key = f"{file.relative_to(ROOT)} {flag}"
        if key not in times:
            times[key] = clean_time(file, flag)
            TIMES.write_text(json.dumps(times, indent=1))
        if times[key] > LONGEST:
            continue
        files.append(file)
        total += times[key]
        if total > BUDGETS[flag]:
            break
    return files, total


def clean_time(file: Path, flag: str) -> float:
    """Seconds of a file of tests on the clean tree, once its kernels are compiled; infinite if it fails there."""
    for last in (False, True):
        outcome, seconds = pytest_run([file], flag, 4 * LONGEST)
        if outcome or last or seconds < BUDGETS[""] / 4:
            return float("inf") if outcome else seconds
    raise AssertionError


def tried(path: Path, mutant: Mutant, times: dict[str, float]) -> tuple[str, float]:
    """The outcome for one mutant, and its seconds."""
    target, spent = COPY / path, 0.0
    original, dates = target.read_bytes(), target.stat()
    for flag in BUDGETS:
        files, seconds = chosen(ROOT / path, flag, times)
        try:
            target.write_text(mutant.text, "utf-8")
            outcome, took = pytest_run(files, flag, COMPILING + TIMES_AS_LONG * seconds) if files else ("", 0.0)
        finally:
            target.write_bytes(original)
            os.utime(target, ns=(dates.st_atime_ns, dates.st_mtime_ns))  # what Python compiled of it is right again
        spent += took
        if outcome:
            return outcome, spent
    return "survived", spent


def candidates(paths: list[str]) -> list[tuple[Path, Mutant]]:
    """All mutants of the code that makes and keeps numbers beneath some paths, in a random order that stays."""
    folders = [ROOT / path for path in MUTATED]
    files = {file for place in folders for file in ([place] if place.suffix else place.rglob("*.py"))}
    inside = [file for file in files if any(file.is_relative_to(ROOT / path) for path in paths or ".")]
    found = [(file.relative_to(ROOT), each) for file in inside for each in mutants(file.read_text("utf-8"))]
    by_identity = {identity(*item): item for item in found}
    return [by_identity[key] for key in sorted(by_identity, key=lambda key: sha256(SEED + repr(key).encode()).digest())]


def identity(path: Path, mutant: Mutant) -> tuple[str, str, str, str]:
    """What is left of a mutant when other lines of its file change; one stands for all that are alike."""
    return str(path), mutant.scope, mutant.before, mutant.after


def main(count: int, paths: list[str]) -> None:
    """Try mutants that have no row yet, and append a row for each."""
    HOME.mkdir(parents=True, exist_ok=True)
    for name in COPIED:
        copy = shutil.copytree if (ROOT / name).is_dir() else shutil.copy2
        copy(ROOT / name, COPY / name, **({"dirs_exist_ok": True} if copy is shutil.copytree else {}))
    times = json.loads(TIMES.read_text()) if TIMES.exists() else {}
    rows = list(csv.DictReader(TABLE.open(newline=""))) if TABLE.exists() else []
    known = {(row["file"], row["scope"], row["before"], row["after"]) for row in rows}
    todo = [item for item in candidates(paths) if identity(*item) not in known][:count]
    for path, mutant in todo:
        outcome, seconds = tried(path, mutant, times)
        row = (str(path), mutant.line, mutant.scope, mutant.before, mutant.after, outcome, f"{seconds:.0f}")
        with TABLE.open("a", newline="") as out:
            writer = csv.writer(out)
            writer.writerows([row] if rows else [HEADER, row])
        rows.append(dict(zip(HEADER, row, strict=False)))
        print(*row, sep=" | ", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2:])
