# teachpath: every verb sets up its own .venv first.
#   make demo [SPEED=4] [ARGS=--once]   the main job: tracker -> recorder -> learning -> arm
#   make test    check and all tests          make bench   measured figures
#   make check   format, lint, types          make proto   regenerate the messages
#   make experiments [ARGS=--quick]   the paper's experiments, as a report in reports/
#   make clean   remove what the above made
SHELL  := /bin/sh
SPEED  ?= 4
ARGS   ?=
PYTHON ?= $(shell for p in python3.13 python3.12 python3.11 python3 python; do \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1 && { echo $$p; break; }; done)
BIN    := .venv/bin
READY  := .venv/.ready

.PHONY: demo serve test check bench experiments proto clean setup browser
.DEFAULT_GOAL := help

help:
	@sed -n '1,7s/^# \{0,1\}//p' Makefile

$(READY): pyproject.toml constraints.txt
	@test -n "$(PYTHON)" || { echo "teachpath needs Python 3.11 or newer; name it: make PYTHON=/path/to/python3.11"; exit 1; }
	@$(PYTHON) -m venv .venv 2>.venv.log || { \
		if command -v apt-get >/dev/null && [ "$$(id -u)" = 0 ]; then apt-get update -q && apt-get install -y -q python3-venv && $(PYTHON) -m venv .venv; \
		else cat .venv.log; echo "Python has no venv module here; get it with: sudo apt-get install python3-venv"; exit 1; fi; }
	@rm -f .venv.log
	@echo "setting up .venv with $$($(PYTHON) --version), this takes a minute or two ..."
	@$(BIN)/python -m pip install -q --disable-pip-version-check -c constraints.txt -e '.[service,dev]'
	@touch $@

setup: $(READY)

demo: $(READY)
	@$(BIN)/teachpath demo --speed $(SPEED) $(ARGS)

serve: $(READY)
	@$(BIN)/teachpath serve $(ARGS)

check: $(READY)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy

# The browser tests need Chromium: found, installed where that is allowed, or named.
browser:
	@command -v chromium chromium-browser google-chrome >/dev/null 2>&1 || { \
		if command -v apt-get >/dev/null && [ "$$(id -u)" = 0 ]; then apt-get update -q && apt-get install -y -q chromium; fi; } || true
	@command -v chromium chromium-browser google-chrome >/dev/null 2>&1 || \
		echo "no Chromium found: the browser tests will be skipped; get it with: sudo apt-get install chromium"

test: check browser
	$(BIN)/python -m pytest $(ARGS)

bench: $(READY)
	@$(BIN)/python tests/bench/run.py $(ARGS)

experiments: $(READY)
	@$(BIN)/python -m tests.experiments.run $(ARGS)

proto: $(READY)
	cd proto && ../$(BIN)/python -m grpc_tools.protoc -I . --python_out=. --pyi_out=. teachpath_proto/tracker.proto teachpath_proto/motion.proto teachpath_proto/job.proto

clean:
	rm -rf .venv .venv.log .mypy_cache .ruff_cache .pytest_cache .hypothesis build dist
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
