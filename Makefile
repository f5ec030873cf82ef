# Two commands matter: `make pareto` runs the main job, `make test` the tests. Both set everything up first.
PYTHON ?= $(shell for p in python3 python3.14 python3.13 python3.12 python3.11 python; do \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && { echo $$p; break; }; done)
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.set-up
# Two processes: what the machine in the documentation has; override with `make test JOBS=8`.
JOBS ?= 2
# In the order of the folders: files of few tests, which take longest, would come last and leave a process idle.
SHARED := -n $(JOBS) --dist loadfile --no-loadscope-reorder

.PHONY: pareto test test-long lint format docs bench setup clean help
.DEFAULT_GOAL := help

help:
	@echo "make pareto     set up, then: actuator map, three fronts, report, knee design, its CAD"
	@echo "make test       set up, then the tests (seven minutes on two cores)"
	@echo "make test-long  the tests that take longer, too"
	@echo "make lint       ruff and mypy"
	@echo "make docs       the documentation as a site: build/docs/index.html"
	@echo "make bench      the benchmarks in benchmarks/"
	@echo "make clean      remove the virtual environment"

setup: $(STAMP)

$(STAMP): pyproject.toml constraints.txt setup.py tools/system_libraries.sh tools/install.sh
	@test -n "$(PYTHON)" || { echo "error: no Python 3.11 or later found; install one, or name it: make PYTHON=/path/to/python3" >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || { echo "error: $(PYTHON) cannot make virtual environments; on Debian or Ubuntu: sudo apt-get install python3-venv" >&2; exit 1; }
	@echo "setting up $(VENV), once: about 2 GB of disk and some minutes" >&2
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@sh tools/install.sh $(BIN)/python $(VENV)/install.log "1 of 3: search, simulation, report" -c constraints.txt -e . >&2
	@sh tools/install.sh $(BIN)/python $(VENV)/install.log "2 of 3: CAD" -c constraints.txt -e '.[cad]' >&2
	@sh tools/install.sh $(BIN)/python $(VENV)/install.log "3 of 3: tools for tests and documents" -c constraints.txt -e '.[dev,docs]' >&2
	@sh tools/system_libraries.sh $(BIN)/python
	@touch $@

pareto: setup
	@$(BIN)/pareto-monoped pareto

# Rewritten assertions and compiled modules are kept, also where the environment says otherwise.
test test-long: export PYTHONDONTWRITEBYTECODE :=

test: setup
	$(BIN)/python -m pytest $(SHARED) -m "not long"

test-long: setup
	$(BIN)/python -m pytest $(SHARED)

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

format: setup
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

docs: setup
	@echo "building the site; notebooks that changed are run, which takes two minutes for all" >&2
	@$(BIN)/python -m sphinx -b html -c docs -n -W --keep-going -q -d build/doctrees . build/docs
	@echo "open build/docs/index.html"

bench: setup
	@for b in benchmarks/*.py; do echo "== $$b"; $(BIN)/python $$b || exit 1; done

clean:
	rm -rf $(VENV)
