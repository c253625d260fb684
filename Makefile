# Every target does its own set-up: Python 3.10 or newer with venv, and a C compiler, are enough.
PYTHON ?= python3
BIN := .venv/bin
# setuptools warns of every editable installation
INSTALL := PYTHONWARNINGS=ignore $(BIN)/python -m pip install --quiet

# tests start Python some hundred times: modules are compiled once
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo test sweep fuzz lint docs dist-check figures bench clean
.DELETE_ON_ERROR:

demo: .venv/installed
	@$(BIN)/moro-codegen puma560

test: .venv/tests
	@echo "all tests but the long ones of make sweep: eight to ten minutes on two idle cores"
	$(BIN)/pytest -n auto -m "not sweep"

# every function of many robots, random ones and long ones; packages, built and installed
sweep: .venv/tests
	@echo "the long tests: about seven minutes on two idle cores"
	$(BIN)/pytest -n auto -m sweep

# robot files, expressions and names that nobody would think of, for so many seconds
FUZZ ?= 300
fuzz: .venv/tests
	$(BIN)/python -m tests.fuzz $(FUZZ)

lint: .venv/tests
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	mkdir -p .venv/types  # mypy cannot follow the names that setuptools maps to folders
	ln -sfn ../../moro .venv/types/moro
	ln -sfn ../../codegen .venv/types/moro_codegen
	$(BIN)/mypy

docs: .venv/docs
	$(BIN)/sphinx-build -q -W --keep-going -b html docs docs/_build/html
	@echo docs/_build/html/index.html

# sdist and wheel, built, installed and used in a temporary folder
dist-check: .venv/dist
	$(BIN)/python .ci/dist_check.py

figures: .venv/docs .venv/tests
	$(BIN)/python docs/figures/draw.py
	$(BIN)/python docs/figures/data_way.py
	$(BIN)/python -m docs.figures.howto

bench: benchmarks/.peers/installed
	@benchmarks/.peers/bin/python -m benchmarks $(BENCH)

clean:
	rm -rf docs/_build .venv benchmarks/.peers build/bdist.* build/lib* build/temp.* *.egg-info codegen/*.so

.venv/bin/python:
	@echo "setting up .venv (half a minute or so)"
	@$(PYTHON) -m venv .venv
	@$(BIN)/python -m pip install --quiet --upgrade pip

.venv/installed: .venv/bin/python pyproject.toml setup.py codegen/_runtime.pyx
	@$(INSTALL) --editable .
	@touch $@

.venv/tests: .venv/installed
	@$(INSTALL) --editable ".[test,lint]"
	@touch $@

.venv/docs: .venv/installed
	@$(INSTALL) --editable ".[docs]"
	touch $@

.venv/dist: .venv/installed
	@$(INSTALL) --group dist
	touch $@

# an environment of its own: moro never needs its peers; one that cannot be installed is left out
benchmarks/.peers/installed: pyproject.toml setup.py codegen/_runtime.pyx
	@echo "setting up the peers in benchmarks/.peers (a minute or two)"
	@test -x $(@D)/bin/python || $(PYTHON) -m venv $(@D)
	@$(@D)/bin/python -m pip install --quiet --upgrade pip
	@PYTHONWARNINGS=ignore $(@D)/bin/python -m pip install --quiet --editable . --group charts
	@for peer in pinocchio casadi mujoco toolbox; do \
	    $(@D)/bin/python -m pip install --quiet --group $$peer || \
	    echo "$$peer cannot be installed here: it is left out"; \
	done
	@touch $@
