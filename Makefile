# Two commands do everything on a machine that has only Python (3.11 or newer) and make:
#   make demo    make a virtual environment, install, run the main job on the built-in room
#   make test    the same, and run the tests

PYTHON ?= $(shell for p in python3.12 python3.13 python3.11 python3 python; do \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo $$p && break; done)
VENV ?= .venv
BIN := $(VENV)/bin
OUT ?= out/demo
JOBS ?= 2
UV_VERSION := 0.13.9

.PHONY: demo test slow lint types install cad_db lock clean

demo: install
	$(BIN)/isr demo --out $(OUT)

test: install
	$(BIN)/python -m pytest -n $(JOBS) --dist loadfile

slow: install
	$(BIN)/python -m pytest -m slow

lint: install
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: install
	$(BIN)/pyright

cad_db: install
	$(BIN)/isr cad build

install: $(VENV)/.installed

$(VENV)/.installed: pyproject.toml requirements/lock.txt
	@test -n "$(PYTHON)" || { echo "No Python >= 3.11 found; set PYTHON=/path/to/python"; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet uv==$(UV_VERSION)
	$(BIN)/uv pip install --quiet --python $(BIN)/python -r requirements/lock.txt
	$(BIN)/uv pip install --quiet --python $(BIN)/python --no-deps -e .
	@touch $@

# Exact pins for every supported Python, without addresses.
lock: install
	$(BIN)/uv pip compile --universal --python-version 3.11 --no-header --no-annotate \
		--extra dev --extra viewer pyproject.toml -o requirements/lock.txt

clean:
	rm -rf $(VENV) out .pytest_cache .ruff_cache
