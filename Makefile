# Every target makes what it needs: an environment in .venv from pinned, hashed requirements, then the package itself.
PYTHON ?= python3
VENV ?= .venv
SEED ?= 1
OUT ?= runs

# A reference of the real recording (a .trc file), where you have one: make demo-real REFERENCE=markers.trc
REFERENCE ?=
COMPARE = $(if $(REFERENCE),--set reference.file=$(abspath $(REFERENCE)))

BIN := $(VENV)/bin
READY := $(VENV)/.ready
# Threads inside BLAS only get in the way of those over particles. Compiled kernels are kept beside their sources.
export OPENBLAS_NUM_THREADS ?= 1
# Where this is set, every import compiles anew and takes three times as long.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo demo-real test lint layers types docs-check bench requirements clean help

help:
	@echo "make demo        render a scene, track it, compare it with its truth"
	@echo "make demo-real   fetch a real recording with four cameras and track the person in it"
	@echo "make test        lint, layers, types, and every test"
	@echo "make lint | types | layers | docs-check | bench | requirements | clean"

demo: $(READY)
	$(BIN)/muybridge demo --out $(OUT)/demo --seed $(SEED)

demo-real: $(READY)
	$(BIN)/muybridge sample beam --out samples/beam
	$(BIN)/muybridge track samples/beam/JOB.toml --out $(OUT)/beam --seed $(SEED) $(COMPARE)

test: lint layers types
	$(BIN)/python -m pytest

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(READY)
	$(BIN)/mypy

layers: $(READY)
	$(BIN)/lint-imports --no-cache

docs-check: $(READY)
	$(BIN)/python -m pytest tests/test_docs.py

bench: $(READY)
	$(BIN)/muybridge bench --out $(OUT)/bench

requirements: $(READY)
	$(PYTHON) scripts/compile_requirements.py

$(READY): requirements.txt pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "muybridge needs Python 3.11 or newer, $(PYTHON) is $$($(PYTHON) -V 2>&1); try: make PYTHON=python3.12" >&2; exit 2; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || \
	  { echo "$(PYTHON) has no venv module; remedy: sudo apt-get install python3-venv" >&2; exit 2; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes -r requirements.txt
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	@touch $@

clean:
	rm -rf $(VENV) build dist .pytest_cache .mypy_cache .ruff_cache
