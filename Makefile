# Needs Python >= 3.11 and make, nothing else. The environment .venv is made by the first target that wants it.
#
#   make report           run the experiments, write report/index.html    (FULL=1: the complete studies)
#   make test             run the tests                                    (ARGS=--slow: all but those of minutes)
#   make numba-range      run the tests of kernels with the oldest and the newest numba that pyproject.toml allows
#   make lint             check style, format and types
#   make docs             write the documentation to site/index.html, with the outputs of its tutorials
#   make bench            measure the time per disc and step, and of the tissue
#   make mutants          see whether tests notice random faults in the code   (ARGS="50 dincl/rows": how many, and where)
#   make lock             fix the newest versions of all dependencies in requirements.lock
#   make clean            remove the environment and the caches; report/ and results/ stay
#
# PYTHON=python3.12 chooses the interpreter .venv is made with.

PYTHON ?= python3
BIN := .venv/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check
PIP_TOOLS := pip-tools==7.6.2
EXTRAS := $(addprefix --extra ,dev meanfield proofs report tissue views yardsticks)
COMPILE := .venv-lock/bin/python -m piptools compile --quiet --upgrade $(EXTRAS) --allow-unsafe --strip-extras \
	--no-emit-index-url --no-emit-find-links --no-emit-trusted-host --no-emit-options --annotation-style line

# The tests run in two processes: a library that starts threads of its own would only take turns with them. The tests of
# one file stay together, for they share what takes long to make; the files are begun in the order of their names, not the
# shortest last, since it is those with few tests that take longest.
ONE_THREAD := OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
# Tests and reports start dozens of processes, each of which would compile all modules that it imports.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: report test numba-range lint docs bench mutants lock clean
.DELETE_ON_ERROR:

report: .venv/installed
	$(BIN)/verification report $(if $(filter-out 0,$(FULL)),--full)

test: .venv/installed
	$(ONE_THREAD) $(BIN)/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder -q $(ARGS)

# One process: most of the time goes into compiling, and processes would compile the same kernels.
numba-range: .venv/installed
	$(ONE_THREAD) $(BIN)/python -m tests.numba_range

lint: .venv/installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

docs: .venv/installed
	rm -rf site docs/made build/doctrees
	$(ONE_THREAD) $(BIN)/python -m sphinx -q -W -c docs -d build/doctrees . site

bench: .venv/installed
	$(BIN)/verification bench

mutants: .venv/installed
	$(ONE_THREAD) $(BIN)/python -m tests.mutants $(or $(ARGS),20)

# Each stamp is touched last, so an install that broke off is made again from the start.
.venv/locked: requirements.lock
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
		echo 'Python >= 3.11 is needed, but PYTHON=$(PYTHON) is missing or older; try: make PYTHON=python3.12' >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' || { \
		echo 'PYTHON=$(PYTHON) comes without venv; on Debian and Ubuntu: apt install python3-venv' >&2; exit 1; }
	rm -rf .venv
	$(PYTHON) -m venv .venv
	$(PIP) install --quiet -r requirements.lock
	@touch $@

.venv/installed: .venv/locked pyproject.toml
	$(PIP) install --quiet --no-deps --no-build-isolation --editable .
	@touch $@

# The lock is made with the oldest Python supported: newer ones take the same versions, but not the other way round.
lock:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' || { \
		echo 'make lock needs Python 3.11, the oldest supported; try: make lock PYTHON=python3.11' >&2; exit 1; }
	$(PYTHON) -m venv --clear .venv-lock
	.venv-lock/bin/python -m pip --disable-pip-version-check install --quiet $(PIP_TOOLS)
	CUSTOM_COMPILE_COMMAND='make lock' $(COMPILE) --output-file requirements.lock pyproject.toml
	rm -rf .venv-lock

clean:
	rm -rf .venv .venv-lock build site docs/made *.egg-info .hypothesis .mypy_cache .pytest_cache .ruff_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
