# Needs Python >= 3.11 and make, nothing else. The first target makes the environment .venv, and each target adds what it
# needs to it: the extra of pyproject.toml that its stamp is named after, in the versions of requirements.lock.
#
#   make report           run the experiments, write the site, report/index.html    (FULL=1: the complete studies)
#   make test             run the tests                                    (ARGS=--slow: all but those of minutes)
#   make numba-range      run the tests of kernels with the oldest and the newest numba that pyproject.toml allows
#   make lint             check style, format, imports and types
#   make docs             run the tutorials, draw the gallery, write the site with both; a warning is an error
#   make bench            measure steps of PBD and substeps of a tissue on this machine
#   make everything       install what all targets need, and what tests are skipped without
#   make dist             build the wheels and source archives of the last commit into dist/, and check them
#   make lock             fix the newest versions of all dependencies in requirements.lock
#   make clean            remove the environment and the caches; report/ and results/ stay
#
# PYTHON=python3.12 chooses the interpreter .venv is made with.

PYTHON ?= python3
BIN := .venv/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check
PIP_TOOLS := pip-tools==7.6.2
COMPILE := .venv-lock/bin/python -m piptools compile --quiet --upgrade --extra dev --allow-unsafe --strip-extras \
	--no-emit-index-url --no-emit-find-links --no-emit-trusted-host --no-emit-options --annotation-style line

# The tests run in two processes: a library that starts threads of its own would only take turns with them. The tests of
# one file stay together, for they share what takes long to make; the files are begun in the order of their names, not the
# shortest last, since it is those with few tests that take longest.
ONE_THREAD := OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
# Tests and reports start dozens of processes, each of which would compile all modules that it imports.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: report test numba-range lint docs bench everything dist lock clean
.DELETE_ON_ERROR:

# With none of its sources newer, the site is not written again: $(BIN)/verification report does so.
SITE := $(shell find dincl meanfield tissue verification docs *.md *.cff pyproject.toml requirements.lock -type f \
	! -path '*/__pycache__/*' ! -path 'docs/made/*')
IN_FULL := $(if $(filter-out 0,$(FULL)),-full)

report: report/.written$(IN_FULL)
	@echo 'report/index.html is complete'

report/.written$(IN_FULL): $(SITE) | .venv/thesis
	$(BIN)/verification report $(if $(IN_FULL),--full)
	@touch $@

test: .venv/test
	$(ONE_THREAD) $(BIN)/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder -q $(ARGS)

# One process: most of the time goes into compiling, and processes would compile the same kernels.
numba-range: .venv/test
	$(ONE_THREAD) $(BIN)/python -m tools.numba_range

lint: .venv/lint
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports --no-cache
	$(BIN)/mypy

docs: .venv/test
	$(ONE_THREAD) $(BIN)/python -m docs.building.shown
	$(ONE_THREAD) $(BIN)/python -m docs.building.gallery
	$(BIN)/verification report --strict

bench: .venv/thesis
	$(BIN)/python -m verification.thesis.bench

everything: .venv/dev

# One wheel is for all machines; the other brings the machine code of the usual kernels, for Linux on x86-64-v3 and the
# libraries of requirements.lock, and is taken by pip where it fits.
# From a copy of the last commit: setuptools would put leftovers of the working tree into the archives. The audit and its
# tables, which only the report needs, are a distribution of their own.
dist: .venv/dist
	rm -rf dist build/dist build/audit
	mkdir -p build/dist build/audit/verification
	git archive HEAD | tar -x -C build/dist
	mv build/dist/verification/thesis build/dist/verification/methods build/dist/verification/tissues build/audit/verification
	mv build/dist/verification/data build/audit/dincl_testbed_data
	cp -r build/dist/docs build/dist/*.md build/dist/*.cff build/audit/dincl_testbed_data
	mv build/audit/dincl_testbed_data/pyproject.toml build/audit
	$(BIN)/python -m build --no-isolation --outdir dist build/dist
	cd build/dist && NUMBA_CPU_NAME=x86-64-v3 NUMBA_CPU_FEATURES= NUMBA_CACHE_DIR=dincl/compiled/shipped \
		../../$(BIN)/python -m tools.usual_kernels
	$(BIN)/python -m build --no-isolation --wheel --outdir dist build/dist \
		"--config-setting=--build-option=--plat-name=manylinux_2_28_x86_64 \
		--python-tag=$$($(BIN)/python -c 'import sys; print("cp%d%d" % sys.version_info[:2])')"
	$(BIN)/python -m build --no-isolation --outdir dist build/audit
	$(BIN)/python -m twine check --strict dist/*

# Each stamp is touched last, so an install that broke off is made again from the start.
.venv/made: requirements.lock
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
		echo 'Python >= 3.11 is needed, but PYTHON=$(PYTHON) is missing or older; try: make PYTHON=python3.12' >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' || { \
		echo 'PYTHON=$(PYTHON) comes without venv; on Debian and Ubuntu: apt install python3-venv' >&2; exit 1; }
	rm -rf .venv
	$(PYTHON) -m venv .venv
	$(PIP) install --quiet --constraint requirements.lock setuptools
	@touch $@

# Without --no-compile, code that nobody imports would take half a minute and a tenth of the disk.
.venv/%: .venv/made pyproject.toml
	$(PIP) install --quiet --no-compile --no-build-isolation --constraint requirements.lock --editable '.[$*]'
	$(BIN)/python -m tools.link_copies
	@touch $@

# The lock is made with the oldest Python supported: newer ones take the same versions, but not the other way round.
lock:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' || { \
		echo 'make lock needs Python 3.11, the oldest supported; try: make lock PYTHON=python3.11' >&2; exit 1; }
	$(PYTHON) -m venv --clear .venv-lock
	.venv-lock/bin/python -m pip --disable-pip-version-check install --quiet $(PIP_TOOLS)
	CUSTOM_COMPILE_COMMAND='make lock' $(COMPILE) --output-file requirements.lock pyproject.toml
	sed -i '/^dincl-testbed @/d' requirements.lock  # extras name the project itself
	rm -rf .venv-lock

clean:
	rm -rf .venv .venv-lock build dist docs/made *.egg-info .hypothesis .mypy_cache .pytest_cache .ruff_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
