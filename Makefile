# Everything that a person or the continuous integration runs. Needs make and Python 3.11, 3.12 or 3.13; `make PYTHON=...`
# names the interpreter, `make VENV=...` the folder of the environment.

SHELL := /bin/sh
VENV ?= .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready

# The first interpreter that is new enough and can make environments (Debian keeps ensurepip in python3-venv).
SUITABLE := import sys, venv, ensurepip; sys.exit(not (3, 11) <= sys.version_info < (3, 14))
PYTHON ?= $(shell for p in python3 python3.13 python3.12 python3.11 python; do \
	$$p -c '$(SUITABLE)' >/dev/null 2>&1 && echo $$p && break; done)

export PIP_DISABLE_PIP_VERSION_CHECK := 1
# Pyright runs on the Node.js of the lock, whatever the machine has.
export PYRIGHT_PYTHON_GLOBAL_NODE := 0
export PYRIGHT_PYTHON_IGNORE_WARNINGS := 1

.PHONY: help setup demo test lint types layers tests test-slow bench lock clean

help: ## List the targets
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1 \2/p' Makefile | awk '{t=$$2; $$1=$$2=""; printf "  make %-10s%s\n", t, $$0}'

setup: $(READY) ## Make .venv from requirements.lock

$(READY): requirements.lock pyproject.toml
	@test -n "$(PYTHON)" || { echo "make: no Python 3.11 to 3.13 with venv and ensurepip on the PATH;" \
		"install one (Debian, Ubuntu: python3-venv) or name it: make PYTHON=/path/to/python3" >&2; exit 2; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --require-hashes --only-binary :all: --requirement requirements.lock
	$(BIN)/python -m pip install --quiet --no-deps --no-build-isolation --editable .
	@touch $(READY)

demo: $(READY) ## Reconstruct the paper's object D on its bench with FRA-NBV; the report is runs/demo/report.html
	$(BIN)/franbv reconstruct --part D --bench paper --planner fra --seed 0 --out runs/demo

test: lint layers ## Lint, layers, then types and tests beside each other
	$(MAKE) --jobs 2 types tests

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(READY)
	$(BIN)/pyright --pythonpath $(BIN)/python

layers: $(READY)
	$(BIN)/lint-imports

tests: $(READY)
	$(BIN)/python -m pytest -m "not slow and not benchmark" --numprocesses auto --dist loadfile --durations 10 \
		--cov --cov-report=
	$(BIN)/coverage report --include 'franbv/*' --fail-under 97
	$(BIN)/coverage report --fail-under 92

test-slow: $(READY) ## The physics and the studies that take minutes
	$(BIN)/python -m pytest -m slow --durations 10

bench: $(READY) ## Print median times and the peak memory; run it on an idle machine
	$(BIN)/python -m pytest -m benchmark -s tests/benchmarks

lock: ## Resolve the dependencies into requirements.lock (all to their newest: make lock UPGRADE=--upgrade)
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet 'uv>=0.9'
	$(BIN)/uv pip compile --quiet --universal --generate-hashes $(UPGRADE) --no-header --no-emit-index-url \
		--no-emit-find-links --extra studies --extra test --extra docs --output-file requirements.lock pyproject.toml

clean: ## Remove the environment, the caches and the demo's result
	rm -rf $(VENV) .pytest_cache .ruff_cache .hypothesis .import_linter_cache runs/demo
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
