# The four words of this project: demo, test, check, bench. Each makes .venv itself.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
# One more than cores: many tests wait for a peer.
JOBS   ?= $(shell expr $$(nproc 2>/dev/null || echo 2) + 1)
# A test that its own time limit cannot end (it hangs in compiled code, or a callback swallowed the limit) ends
# its worker, and says where it was; else the whole run waits for it until CI's time is over.
HANGS  := --max-worker-restart 1 -o faulthandler_timeout=420 -o faulthandler_exit_on_timeout=true

.PHONY: demo test check bench format clean
.DELETE_ON_ERROR:

demo: $(VENV)/.installed
	$(BIN)/slipjump demo

test: $(VENV)/.dev
	@bash tests/system_parts.sh
	$(BIN)/python -m pytest -m "not bench" -n $(JOBS) --dist loadscope $(HANGS)

check: $(VENV)/.dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/mypy docs
	$(BIN)/lint-imports

bench: $(VENV)/.dev
	$(BIN)/python -m benchmarks
	$(BIN)/python -m pytest -m bench

format: $(VENV)/.dev
	$(BIN)/ruff check --fix . ; $(BIN)/ruff format .

$(VENV)/bin/python:
	@bash .ci/make_venv $(PYTHON) $(VENV)

$(VENV)/.installed: pyproject.toml constraints.txt | $(VENV)/bin/python
	@test ! -L $(VENV) || { echo "$(VENV) is a link: the package of its owner would then come from here"; exit 1; }
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e .
	$(BIN)/slipjump warm
	@touch $@

$(VENV)/.dev: $(VENV)/.installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[dev]"
	@touch $@

clean:
	rm -rf $(VENV) build dist .mypy_cache .ruff_cache .pytest_cache
