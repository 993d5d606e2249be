# teachpath: every verb sets up its own .venv first.
#   make demo [SPEED=4] [ARGS=--once]   the main job: tracker -> recorder -> learning -> arm
#   make test    check and all tests          make bench [ARGS=scale]   measured figures; how costs grow
#   make check   format, lint, types          make proto   regenerate the messages
#   make figures [ARGS="--install --setup"]   the source in numbers; the installed size, how long the set-up takes
#   make lint-contract   Spectral and Redocly over the description of the REST API, buf over the messages, twine over the package
#   make probe-contract   whatever Schemathesis makes of the description, sent to a station as every role
#   make generate-clients   clients by three public generators: none has an untyped answer, one teaches a station
#   make experiments [ARGS=--quick]   the paper's experiments, as a report in reports/
#   make docs    the documents as a site; the service shows it under /help
#   make pins [ARGS=--upgrade]   choose the versions of requirements/ anew
#   make sbom    the bill of materials in CycloneDX, in dist/
#   make clean   remove what the above made
SHELL  := /bin/sh
SPEED  ?= 4
ARGS   ?=
BIN    := .venv/bin
# Python keeps the bytecode of what it has loaded, also where the shell says otherwise: each process of a station or of a
# test would compile its libraries anew, for seconds.
export PYTHONDONTWRITEBYTECODE :=
# Looked up once, and only where .venv has to be made. The installer is a uv that is there, else the pinned one from
# PyPI; `make UV=` leaves the work to pip.
PYTHON ?= $(eval PYTHON := $(shell for p in python3.13 python3.12 python3.11 python3 python; do \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1 && { echo $$p; break; }; done))$(PYTHON)
UV     ?= $(eval UV := $(shell uv --version >/dev/null 2>&1 && echo uv || echo $(BIN)/uv))$(UV)
# Stamps: what the service needs is installed; what checks and tests need is, too.
SERVICE := .venv/.service
READY   := .venv/.ready
# Every file is checked against its hash, and nothing is installed that requirements/ does not name.
PINNED  := --no-deps --require-hashes -r requirements

.PHONY: demo serve test check check-page lint-contract probe-contract generate-clients bench figures experiments docs pins sbom proto clean setup programs
.DEFAULT_GOAL := help

help:
	@sed -n '1,13s/^# \{0,1\}//p' Makefile

# An environment with pip in it, from scratch where another interpreter's stands; Debian keeps the module that makes one
# in a package of its own.
define venv
	{ $(PYTHON) -m venv .venv 2>.venv.log || $(PYTHON) -m venv --clear .venv 2>.venv.log || { \
		if command -v apt-get >/dev/null && [ "$$(id -u)" = 0 ]; then apt-get update -q && apt-get install -y -q python3-venv && $(PYTHON) -m venv --clear .venv; \
		else cat .venv.log; echo "Python has no venv module here; get it with: sudo apt-get install python3-venv"; false; fi; } && rm -f .venv.log; }
endef
pip     = $(BIN)/python -m pip install -q --disable-pip-version-check $(1)
# pip steps in where uv fails: it knows the proxies and package indexes of which only pip was told.
install = { test -n "$(UV)" && $(UV) pip install -q --python $(BIN)/python $(1); } || \
	{ { $(BIN)/python -m pip --version >/dev/null 2>&1 || $(venv); } && $(call pip,$(1)); }

$(SERVICE): pyproject.toml requirements/service.txt requirements/uv.txt
	@test -n "$$(command -v $(PYTHON))" || { echo "teachpath needs Python 3.11 or newer; name it: make PYTHON=/path/to/python3.11"; exit 1; }
	@echo "setting up .venv with $$($(PYTHON) --version) ..."
	@case "$(UV)" in "" | $(BIN)/uv) false ;; *) $(UV) venv -q --allow-existing --python "$$(command -v $(PYTHON))" .venv ;; esac || $(venv)
	@test "$(UV)" != $(BIN)/uv || $(call pip,$(PINNED)/uv.txt) || true
	@$(call install,$(PINNED)/service.txt)
	@$(call install,--no-deps --no-build-isolation -e .)
	@touch $@

$(READY): $(SERVICE) requirements/site.txt requirements/dev.txt
	@$(call install,$(PINNED)/site.txt)
	@$(call install,$(PINNED)/dev.txt)
	@touch $@

setup: $(READY)

demo: $(SERVICE)
	@$(BIN)/teachpath demo --speed $(SPEED) $(ARGS)

serve: $(SERVICE)
	@$(BIN)/teachpath serve $(ARGS)

check: $(READY) check-page
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy

# The page's tools are npm packages; node and npm come with the dev extra.
PAGE_TOOLS := tools/page/node_modules/.package-lock.json
NPM        := PATH="$(CURDIR)/$(BIN):$$PATH" npm --prefix tools/page

$(PAGE_TOOLS): tools/page/package-lock.json | $(READY)
	@$(NPM) ci --silent
	@touch $@

check-page: $(PAGE_TOOLS)
	@$(NPM) run --silent check

# Linters of the REST API's description and of the messages; what they find wrongly is named in tools/contract/spectral.yaml.
CONTRACT_TOOLS := tools/contract/node_modules/.package-lock.json

$(CONTRACT_TOOLS): tools/contract/package-lock.json | $(READY)
	@PATH="$(CURDIR)/$(BIN):$$PATH" npm --prefix tools/contract ci --silent
	@touch $@

# Tools with libraries of their own: for packages, and one that attacks a station by its description.
PROBES := .venv/contract/.ready
$(PROBES): requirements/contract.txt | $(READY)
	@$(BIN)/python -m venv .venv/contract
	@.venv/contract/bin/python -m pip install -q --disable-pip-version-check $(PINNED)/contract.txt
	@touch $@

lint-contract: $(CONTRACT_TOOLS) $(PROBES)
	@$(BIN)/python -m tests.contract.openapi dist/openapi.json
	@PATH="$(CURDIR)/$(BIN):$$PATH" npm --prefix tools/contract run --silent lint
	@PATH="$(CURDIR)/$(BIN):$$PATH" npm --prefix tools/contract run --silent messages
	@rm -rf dist/packages && $(BIN)/python -m hatchling build -d dist/packages >/dev/null
	@.venv/contract/bin/twine --no-color check --strict dist/packages/*
	@.venv/contract/bin/check-wheel-contents dist/packages/*.whl

probe-contract: $(PROBES)
	@$(BIN)/python -m tests.contract.probe $(ARGS)

# Clients that others make of the description; the generators have libraries of their own.
GENERATORS := .venv/generators/.ready
$(GENERATORS): requirements/generators.txt | $(READY)
	@$(BIN)/python -m venv .venv/generators
	@.venv/generators/bin/python -m pip install -q --disable-pip-version-check $(PINNED)/generators.txt
	@touch $@

generate-clients: $(GENERATORS) $(PAGE_TOOLS)
	@$(BIN)/python -m tests.contract.generated_clients

# What tests need beside Python's packages: found, installed where that is allowed, or named.
SEEN = PATH="$$PATH:/usr/sbin" command -v
programs:
	@$(SEEN) chromium chromium-browser google-chrome >/dev/null 2>&1 && $(SEEN) nginx >/dev/null 2>&1 || { \
		if command -v apt-get >/dev/null && [ "$$(id -u)" = 0 ]; then apt-get update -q && apt-get install -y -q chromium nginx-light; fi; } || true
	@$(SEEN) chromium chromium-browser google-chrome >/dev/null 2>&1 || \
		echo "no Chromium found: the browser tests will be skipped; get it with: sudo apt-get install chromium"
	@$(SEEN) postgres >/dev/null 2>&1 || ls /usr/lib/postgresql/*/bin/postgres >/dev/null 2>&1 || { \
		if command -v apt-get >/dev/null && [ "$$(id -u)" = 0 ]; then apt-get install -y -q postgresql; fi; } || true
	@$(SEEN) postgres >/dev/null 2>&1 || ls /usr/lib/postgresql/*/bin/postgres >/dev/null 2>&1 || \
		echo "no PostgreSQL found: its tests will be skipped; get it with: sudo apt-get install postgresql"
	@$(SEEN) nginx >/dev/null 2>&1 || \
		echo "no nginx found: the tests behind a proxy will be skipped; get it with: sudo apt-get install nginx-light"
	@$(SEEN) ip >/dev/null 2>&1 && $(SEEN) certutil >/dev/null 2>&1 || { \
		if command -v apt-get >/dev/null && [ "$$(id -u)" = 0 ]; then apt-get install -y -q iproute2 libnss3-tools; fi; } || true
	@$(SEEN) ip >/dev/null 2>&1 && $(SEEN) certutil >/dev/null 2>&1 || \
		echo "no ip or no certutil found: the test from another machine will be skipped; get them with: sudo apt-get install iproute2 libnss3-tools"

# Tests that move arms run one after the other, so do those that draw pages, and the rest beside them: they wait so much
# that two cores have work for three.
test: check programs
	$(BIN)/python -m pytest -n 3 --no-loadscope-reorder $(ARGS)

bench: $(READY)
	@$(BIN)/python -m tests.bench.run $(ARGS)

figures: $(READY)
	@$(BIN)/python -m tests.bench.figures $(ARGS)

experiments: $(READY)
	@$(BIN)/python -m tests.experiments.run $(ARGS)

docs: $(READY)
	@NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build -q && echo "open service/teachpath/help/index.html, or /help of a running service"

# Versions stay where they are unless ARGS says otherwise: --upgrade, or --upgrade-package NAME.
COMPILE = $(BIN)/uv pip compile -q --universal --python-version 3.11 --fork-strategy fewest --generate-hashes \
	--no-header --no-annotate --no-emit-index-url $(ARGS)
# What one of the files pins on every system stands in no other.
left_out = $$(sed -n 's/^\([a-z0-9-]*\)==[^;]*$$/--no-emit-package \1/p' requirements/$(1).txt)
pins: $(SERVICE)
	@$(call install,$(PINNED)/uv.txt)
	$(COMPILE) --group setup -o requirements/uv.txt
	$(COMPILE) --group generators -o requirements/generators.txt
	$(COMPILE) --group contract -o requirements/contract.txt
	$(COMPILE) pyproject.toml --extra service --group build -o requirements/service.txt
	$(COMPILE) pyproject.toml --extra postgres --extra s3 -c requirements/service.txt -o requirements/site.txt \
		$(call left_out,service)
	$(COMPILE) pyproject.toml --extra dev -c requirements/service.txt -c requirements/site.txt -o requirements/dev.txt \
		$(call left_out,service) $(call left_out,site)

sbom: $(READY)
	@$(BIN)/python tools/bill_of_materials.py

proto: $(READY)
	@$(BIN)/python -m tests.contract.messages

clean:
	rm -rf .venv tools/page/node_modules tools/contract/node_modules .venv.log .mypy_cache .ruff_cache .pytest_cache .hypothesis build dist service/teachpath/help
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
