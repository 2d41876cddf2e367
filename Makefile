# Needs Python 3.11 or later and make, nothing else.
PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV := .venv
BIN := $(VENV)/bin
CELLS := 40962
RUN := runs/tc5

.PHONY: tc5 test lint format wheel-test clean

tc5: $(VENV)/installed runs/mesh.$(CELLS).nc  ## Williamson test case 5 to day 50, with figures
	$(BIN)/trisk run williamson5 --mesh runs/mesh.$(CELLS).nc --days 50 --force -o $(RUN)
	$(BIN)/trisk plot $(RUN)

runs/mesh.$(CELLS).nc: | $(VENV)/installed
	mkdir -p runs
	$(BIN)/trisk mesh --cells $(CELLS) -o $@

test: $(VENV)/installed-dev  ## The test suite
	$(BIN)/python -m pytest

lint: $(VENV)/installed-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

format: $(VENV)/installed-dev
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

wheel-test: $(VENV)/installed-dev  ## Build the wheel, install it elsewhere, run a tiny case from there
	tests/wheel_test.sh $(abspath $(BIN))/python

$(VENV)/installed: pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "trisk needs Python 3.11 or later; name one with make PYTHON=..."; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	PYTHONWARNINGS=ignore $(BIN)/python -m pip install --quiet --editable .
	touch $@

$(VENV)/installed-dev: pyproject.toml $(VENV)/installed
	PYTHONWARNINGS=ignore $(BIN)/python -m pip install --quiet --editable '.[dev]'
	touch $@

clean:
	rm -rf $(VENV) build dist *.egg-info
