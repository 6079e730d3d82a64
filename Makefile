# make demo and make test each work as the first command on a fresh machine with
# Python and make: they set up a virtual environment first, and again when
# pyproject.toml changes. PYTHON= names another interpreter, VENV= another folder,
# BENCHMARKS= the scripts that make bench runs.

VENV ?= .venv
SCENE ?= scenes/wineglass.yaml
PYTHON ?= $(shell for python in python3 python3.13 python3.12 python3.11 python3.10; do \
	$$python -c $(SUPPORTED) >/dev/null 2>&1 && echo $$python && break; done)
BENCHMARKS ?= $(filter-out benchmarks/_% benchmarks/make_%,$(sort $(wildcard \
	benchmarks/*.py)))
SUPPORTED = 'import sys; sys.exit(not (3, 10) <= sys.version_info[:2] < (3, 14))'

.PHONY: demo test lint format docs bench clean

demo: $(VENV)/.installed
	$(VENV)/bin/mmplan solve $(SCENE) --seed 7 -o plan.json
	$(VENV)/bin/mmplan verify plan.json

test: $(VENV)/.installed-test
	$(VENV)/bin/python -m pytest

lint: $(VENV)/.installed-dev
	$(VENV)/bin/ruff format --check
	$(VENV)/bin/ruff check
	$(VENV)/bin/mypy
	$(VENV)/bin/lint-imports

format: $(VENV)/.installed-dev
	$(VENV)/bin/ruff format
	$(VENV)/bin/ruff check --fix

docs: $(VENV)/.installed-docs
	$(VENV)/bin/sphinx-build -E -W --keep-going -q -c docs -d build/doctrees . build/site
	@echo "open build/site/index.html"

bench: $(VENV)/.installed
	@for script in $(BENCHMARKS); do \
		echo "$$script" && $(VENV)/bin/python $$script || exit; done

clean:
	rm -rf build dist plan.json .hypothesis .import_linter_cache
	rm -rf .mypy_cache .pytest_cache .ruff_cache
	find mmplan tests benchmarks -name __pycache__ -prune -exec rm -rf {} +

$(VENV)/.installed: pyproject.toml
	@$(or $(PYTHON),false) -c $(SUPPORTED) 2>/dev/null || { \
		echo "mmplan needs Python 3.10 to 3.13, and '$(or $(PYTHON),python3)' is not" \
			"one: make PYTHON=/path/to/python $(MAKECMDGOALS)" >&2; exit 1; }
	@echo "setting up $(VENV) with $(PYTHON); this takes a minute"
	@$(PYTHON) -m venv $(VENV)
	@$(VENV)/bin/python -m pip install -qq --disable-pip-version-check --editable .
	@touch $@

$(VENV)/.installed-%: $(VENV)/.installed
	@echo "adding what '$*' needs to $(VENV)"
	@$(VENV)/bin/python -m pip install -qq --disable-pip-version-check \
		--editable '.[$*]'
	@touch $@
