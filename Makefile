# Every target prepares .venv from requirements/lock.txt when it is missing.
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
DOCS_READY := $(VENV)/.docs_ready
EXTRAS_READY := $(VENV)/.extras_ready
WORKERS ?= 2
DEMO := demo_report
# Byte code must be kept: without it every program reads the sources of all packages again.
export PYTHONDONTWRITEBYTECODE :=

.DEFAULT_GOAL := help
.PHONY: always help setup demo kernels test extras claims sample validate mutants bench docs lint format clean

help:  ## list the targets
	@grep -hE '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*## /\t/'

$(READY): requirements/lock.txt pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "Python 3.11 or newer is needed: make PYTHON=python3.12 ..." >&2; exit 1; }
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile -r requirements/lock.txt
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	touch $@

setup: $(READY)  ## create the virtual environment

demo: kernels  ## simulate the 12-tooth motor from parameters and from a CAD profile, with reports
	mkdir -p $(DEMO)
	@$(MAKE) --no-print-directory $(filter --output-sync,$(.FEATURES:%=--%)) -j $(WORKERS) $(DEMO)/egm12_motor.html $(DEMO)/egm12_motor_profile.html
	@printf '%s\n' "" "Open in a browser:" "  $(CURDIR)/$(DEMO)/egm12_motor.html" \
		"  $(CURDIR)/$(DEMO)/egm12_motor_profile.html"

$(DEMO)/%.html: always
	$(BIN)/toothspace run cases/$*.toml -o $(DEMO)/$*.nc --force
	$(BIN)/toothspace report $(DEMO)/$*.nc -o $@ --force

kernels: $(READY)  ## compile all equations into the library that runs take them from
	$(BIN)/python -m native.build

test: kernels  ## run the test suite (without the slow validation runs)
	$(BIN)/python -m pytest -q -n $(WORKERS) --dist worksteal

PARTS := 13
PART ?= $(shell echo $$(( ($$(git rev-list --count HEAD 2>/dev/null || echo 0) + $$(date +%s) / 86400) % $(PARTS) )))
MINUTES ?= 30

$(EXTRAS_READY): requirements/extras.txt $(READY)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile -r requirements/extras.txt
	touch $@

extras: $(EXTRAS_READY) kernels  ## test what the optional extras bring, with all of them installed; a skipped test fails
	$(BIN)/python -m pytest -q -n $(WORKERS) --dist worksteal --skip-nothing \
		tests/unit/app tests/unit/circuit/test_foreign_units.py tests/unit/cli/test_export.py tests/unit/fmi tests/unit/geometry \
		tests/unit/machines/test_gerotor_cad.py tests/unit/case/test_case_draft.py tests/unit/model tests/unit/plotting \
		tests/unit/results/test_technical_data.py tests/unit/studies
	$(BIN)/python -m pytest -q -n $(WORKERS) --skip-nothing -m "slow or not slow" tests/end_to_end tests/verification/test_solid_file.py tests/unit/studies/test_cluster.py

sample: kernels  ## run a thirteenth of the slow tests, another one for every commit and day
	@echo "make sample PART=$(PART)"
	$(BIN)/python -m pytest -q -n $(WORKERS) -m slow --part $(PART)/$(PARTS) --minutes $(MINUTES)

claims: kernels  ## hold a short version of every claim against published numbers
	mkdir -p build
	$(BIN)/toothspace validate --short -o build/claims.html --force --workers $(WORKERS)

validate: kernels  ## run slow tests and validation against published numbers
	$(BIN)/python -m pytest -q -n $(WORKERS) --dist worksteal -m slow --deselect tests/validation/test_claims.py
	mkdir -p build
	$(BIN)/toothspace validate -o build/validation_book.html --force --workers $(WORKERS)

mutants: kernels  ## spoil lines of the equations one by one; every one must be noticed by a test
	$(BIN)/python -m benchmarks.mutants

bench: kernels  ## print the table of benchmarks, write the speed pages
	$(BIN)/python -m benchmarks
	for part in speed goals steps scaling; do $(BIN)/python -m benchmarks.$$part --store || exit 1; done

$(DOCS_READY): $(READY) requirements/docs.txt
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements/lock.txt -r requirements/docs.txt
	touch $@

docs: $(DOCS_READY)  ## build the documentation into docs/_build/html; a broken link is an error
	$(BIN)/python -m sphinx -q -W --keep-going -j auto -b html docs docs/_build/html
	@printf '%s\n' "Open in a browser:" "  $(CURDIR)/docs/_build/html/index.html"

lint: $(READY)  ## style, types and layers
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: $(READY)  ## apply the style
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

clean:  ## remove what can be rebuilt
	rm -rf $(DEMO) build src/toothspace/native docs/_build docs/api .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis
