# Needed beforehand: make, Python 3.11 or newer with venv, and a package registry that pip can reach.
.DEFAULT_GOAL := help
SHELL := /bin/sh

PYTHON ?= $(shell for each in python3.11 python3 python3.12 python3.13 python; do \
	$$each -c 'import sys, venv; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1 && echo $$each && break; done)
BIN := .venv/bin
JOBS ?= 2
# Every process gets half of the tests in their order, so that what a file's tests share is made once; who is done first takes from the other.
PYTEST = $(BIN)/python -m pytest -n $(JOBS) --dist worksteal

# Many small matrices: a second BLAS thread costs far more than it gives, and tests already run side by side.
export OPENBLAS_NUM_THREADS := 1
export OMP_NUM_THREADS := 1
export MKL_NUM_THREADS := 1
export PYTHONNOUSERSITE := 1
unexport PYTHONPATH PYTHONHOME
# The tests start some hundred processes: none need translate flexstage anew.
unexport PYTHONDONTWRITEBYTECODE

COMPILE := $(BIN)/uv pip compile -q --universal --python-version 3.11 --generate-hashes --no-header --no-annotate --no-emit-index-url

.PHONY: help demo quick test check-all bench lint style format types contracts docs examples validation pictures lock web web-types setup-runtime setup-dev setup-oracles

help: ## list the targets
	@sed -n 's/^\([a-z-]*\):.*## /  make \1\t/p' $(MAKEFILE_LIST) | expand -t 20

setup-runtime setup-dev setup-oracles: setup-%:
	@test -n "$(PYTHON)" || { echo "flexstage needs Python 3.11 or newer with venv; none was found on the PATH." >&2; exit 1; }
	@$(PYTHON) tools/setup.py $*

demo: setup-runtime ## analyse the shipped stage: tables here, the report in demo/report.html
	@mkdir -p demo
	@test -f demo/stage.toml || $(BIN)/flexstage new demo/stage.toml
	$(BIN)/flexstage analyse demo/stage.toml --report demo/report.html

quick: setup-dev ## a minute: closed forms, laws, the public surface; no finite elements
	FLEXSTAGE_TESTS=quick $(PYTEST) tests/analytic tests/laws tests/hygiene/test_surface.py tests/hygiene/test_contracts.py -k "not solid and not buildable and not strategies and not loop_study"

test: setup-dev ## the tests, but for the examples of the documentation
	$(PYTEST) --ignore=tests/docs

check-all: setup-oracles ## the tests with full counts and sizes, with other kernels, versions of packages, and programs; writes docs/validation
	FLEXSTAGE_TESTS=full $(PYTEST)
	JOBS=$(JOBS) $(BIN)/python -m tools.processors
	$(BIN)/python -m tools.versions
	$(BIN)/python benchmarks/oracles.py
	$(BIN)/python -m tools.validation --solids

validation: setup-dev ## compute docs/validation anew: every number against its authority
	$(BIN)/python -m tools.validation

pictures: setup-dev ## draw the pictures of the documentation anew
	$(BIN)/python -m tools.pictures

bench: setup-oracles ## times and ratios, one process each
	@for each in $(wildcard benchmarks/*.py); do echo "== $$each" && $(BIN)/python $$each || exit 1; done

lint: style types contracts ## style, types and import contracts

style: setup-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

format: setup-dev ## put the code into the common form
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

types: setup-dev
	$(BIN)/basedpyright

contracts: setup-dev
	$(BIN)/lint-imports --no-logo

docs: setup-dev ## build the documentation into docs/_build/html; warnings are errors
	$(BIN)/sphinx-build -q -W --keep-going -b html docs docs/_build/html

examples: setup-dev ## run every example of README.md and docs
	$(PYTEST) tests/docs

web: web-types ## build the pages' bundles from web/ anew: node, npm and its registry are needed
	cd web && npm run --silent build

web-types:
	cd web && npm ci --no-fund --no-audit && npm run --silent check

lock: setup-dev ## pin the requirements anew (newer versions: make lock UPGRADE=--upgrade)
	$(COMPILE) $(UPGRADE) pyproject.toml requirements/build.in --extra dev -o requirements/dev.txt
	$(COMPILE) pyproject.toml requirements/build.in --extra control --extra solid --extra tables -c requirements/dev.txt -o requirements/runtime.txt
	$(COMPILE) pyproject.toml --extra oracles -c requirements/dev.txt -o requirements/oracles.txt
