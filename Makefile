# Needs Python 3.11 or later and make, nothing else.
PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV := .venv
BIN := $(VENV)/bin
CELLS := 40962
RUN := runs/tc5
STUDY := runs/verification
GALEWSKY_CELLS := 2562 10242 40962 163842
SCHEMES := --scheme ringler2010 --scheme consistent
MUTANTS := 200
SEED := 1

.SECONDARY:
.PHONY: tc5 test test-all mutants lint format wheel-test verification reliability references mesh-page scaling north-atlantic docs clean

tc5: $(VENV)/installed runs/mesh.$(CELLS).nc  ## Williamson test case 5 to day 50, with figures and a page for the browser
	$(BIN)/trisk run williamson5 --mesh runs/mesh.$(CELLS).nc --days 50 --force -o $(RUN)
	$(BIN)/trisk plot $(RUN)
	$(BIN)/trisk view $(RUN) -o $(RUN)/run.html --quiet
	@echo "open $(abspath $(RUN)/run.html) in a browser to look at the run"

runs/mesh.%.nc: | $(VENV)/installed
	mkdir -p runs
	$(BIN)/trisk mesh --cells $* -o $@

test: $(VENV)/installed-dev  ## The quick tests, in some minutes
	$(BIN)/python -m pytest -m "not slow" -n 2 --dist loadfile

test-all: test  ## The slow tests too
	$(BIN)/python -m pytest -m slow -n 2 --dist loadfile

mutants: $(VENV)/installed-dev  ## How many small faults the quick tests notice; hours, and goes on where it stopped
	$(BIN)/python tests/mutation/mutants.py runs/mutants --count $(MUTANTS) --seed $(SEED)

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

$(VENV)/installed-docs: pyproject.toml $(VENV)/installed
	PYTHONWARNINGS=ignore $(BIN)/python -m pip install --quiet --editable '.[docs]'
	touch $@

verification: $(VENV)/installed-dev $(GALEWSKY_CELLS:%=$(STUDY)/jet-%.done)  ## All of docs/verification.md; hours
	$(BIN)/trisk study mesh williamson2 $(SCHEMES) --cells 2562 --cells 10242 --cells 40962 \
		-o $(STUDY)/williamson2
	$(BIN)/trisk study mesh williamson5 $(SCHEMES) --cells 2562 --cells 10242 --cells 40962 --family scvt \
		--family refined-circle --family nested --days 50 --error-day 15 -o $(STUDY)/williamson5
	$(BIN)/trisk study mesh williamson6 $(SCHEMES) --cells 2562 --cells 10242 --family scvt \
		-o $(STUDY)/williamson6
	$(BIN)/trisk study mesh galewsky $(SCHEMES) $(GALEWSKY_CELLS:%=--cells %) --family scvt -o $(STUDY)/galewsky
	$(BIN)/trisk study time williamson5 --cells 2562 --dt 150 --dt 300 --dt 600 --dt 1200 -o $(STUDY)/time
	$(BIN)/trisk compare $(GALEWSKY_CELLS:%=$(STUDY)/galewsky/runs/scvt-%) -o $(STUDY)/galewsky/maps
	$(BIN)/trisk compare $(GALEWSKY_CELLS:%=$(STUDY)/jet-%) $(foreach day,1 2 3 4 5 6,--day $(day)) -o $(STUDY)/jet
	$(BIN)/python docs/tools/hollingsworth_page.py $(STUDY)/hollingsworth
	$(BIN)/python docs/tools/basins_page.py > $(STUDY)/basins.md
	$(BIN)/trisk spectra $(STUDY)/williamson5/runs/scvt-40962 --day 15 --day 50 -o $(STUDY)/spectra

$(STUDY)/jet-%.done: runs/mesh.%.nc
	mkdir -p $(STUDY)
	$(BIN)/trisk run galewsky --set perturbed=false --mesh $< --force -o $(STUDY)/jet-$*
	touch $@

reliability: $(VENV)/installed-dev  ## The tables of docs/reliability.md made anew; half an hour
	$(BIN)/python tests/reliability/conservation.py runs/reliability
	$(BIN)/python -m tests.reliability.closed_sea 10242
	$(BIN)/python -m tests.reliability.closed_sea 10242 world-ocean
	$(BIN)/python -m tests.reliability.closed_sea 10242 north-atlantic
	$(BIN)/python tests/reliability/kill_runs.py 20
	$(BIN)/python tests/reliability/mutate_meshes.py 2000

north-atlantic: $(VENV)/installed-dev  ## Fig. 10 of Ju, Ringler and Gunzburger (2011): meshes, table and pictures in runs/north-atlantic
	$(BIN)/python docs/tools/north_atlantic.py runs/north-atlantic

references: $(VENV)/installed-dev  ## The stored solutions of the spectral model made anew; hours
	$(BIN)/trisk reference williamson5 --truncation 341 -o postprocess/reference/stored/williamson5.nc
	$(BIN)/trisk reference williamson6 --truncation 170 --damping-hours 24 -o postprocess/reference/stored/williamson6.nc
	$(BIN)/trisk reference galewsky --truncation 255 -o postprocess/reference/stored/galewsky.nc

mesh-page: $(VENV)/installed-dev  ## docs/meshes made anew; an hour
	$(BIN)/python docs/tools/mesh_page.py docs/meshes --max-level 9

scaling: $(VENV)/installed-dev  ## The tables and the figure of docs/scaling.md made anew; a quarter of an hour, 3 GB
	$(BIN)/python docs/tools/scaling_page.py runs/scaling

docs: $(VENV)/installed-docs  ## The documentation site in docs/_build/html, its gallery run; some minutes
	$(BIN)/sphinx-build -W --keep-going --quiet docs docs/_build/html

clean:
	rm -rf $(VENV) build dist *.egg-info docs/_build docs/api/names docs/examples
