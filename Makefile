# `make` alone lists the targets. Needs Python 3.11 or newer, make, and nothing else.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# A target is up to date when its stamp is newer than pyproject.toml, so that a second run installs nothing.
INSTALLED := $(VENV)/installed
INSTALLED_DEV := $(VENV)/installed-dev
# Only errors: warnings of pip are about the machine, not about this project.
PIP_INSTALL := $(BIN)/python -m pip install -qq --disable-pip-version-check
# What is given is installed into the environment of a Python. uv takes a sixth of pip's CPU time, and
# pip is for where uv is not available or does not know a mirror that only pip is configured for.
INSTALL = { $(PIP_INSTALL) uv && $(BIN)/uv pip install --quiet --python $(1)/bin/python $(2); } 2>/dev/null \
  || $(1)/bin/python -m pip install -qq --disable-pip-version-check $(2)
# A comma that `call` does not take for the end of an argument.
COMMA := ,
LOWEST := $(VENV)/lowest
ROS2 := $(VENV)/ros2
INSTALLED_ROS2 := $(ROS2)/installed
# What a terminal has in which a ROS distribution was sourced: it must not be mixed with the wheels.
NOT_OF_ROS := env -u _ROS_WHEELS_BOOTSTRAP_COMPLETE -u AMENT_PREFIX_PATH -u LD_LIBRARY_PATH \
  -u PYTHONPATH -u RMW_IMPLEMENTATION
# Whole files, so that the tests of one share its service and browser. At most four, since some tests
# measure time.
PARALLEL := --numprocesses auto --maxprocesses 4 --dist loadfile --no-loadscope-reorder
ARGS ?=
# What `make test-image` builds: `pilothouse link ros2 dev` are all.
IMAGES ?= pilothouse
# The tests start a hundred processes. Where the environment forbids bytecode, each would compile its
# source anew.
export PYTHONDONTWRITEBYTECODE :=

.DEFAULT_GOAL := help
# `make -j` runs one step after the other: tests that measure time do not share the machine, and two
# installs do not share the environment.
.NOTPARALLEL:
.PHONY: help run hooks pre-commit test test-image test-ros2 lint types pyright imports pytest format docs pictures bench bench-ros2 coverage mutation soak lowest lock clean

help: ## list the targets
	@awk -F ':.*## ' '/^[a-z0-9-]+:.*## / {printf "  make %-10s %s\n", $$1, $$2}' $(firstword $(MAKEFILE_LIST))
	@echo "  Variables: PYTHON=$(PYTHON) (interpreter), ARGS (for run: more options, for pytest: what to run)"

run: $(INSTALLED) ## start the example robot; prints the address of its page
	@$(BIN)/pilothouse serve $(ARGS)

test: lint types imports pytest ## all checks: lint, types, import contracts, tests

lint: $(INSTALLED_DEV) ## ruff: lint and format
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .

types: $(INSTALLED_DEV) ## mypy, strict
	@$(BIN)/mypy

# Not among the development tools: with its own node it takes 280 MB.
pyright: $(INSTALLED_DEV) ## pyright, standard: a second opinion about types
	@$(call INSTALL,$(VENV),'basedpyright>=1.40')
	@$(BIN)/basedpyright --pythonpath $(BIN)/python

imports: $(INSTALLED_DEV) ## import contracts
	@$(BIN)/lint-imports --no-cache --no-logo

pytest: $(INSTALLED_DEV) ## the tests; one of them with ARGS=tests/unit/test_structure.py
	@$(BIN)/pytest -rs $(or $(ARGS),$(PARALLEL))

test-image: $(INSTALLED_DEV) ## build the image and test it in a container; needs root
	@$(BIN)/hadolint docker/Dockerfile*
	@bash docker/build_here.sh $(IMAGES)
	@bash docker/with_podman_here.sh $(BIN)/pytest -rs -m image tests/image $(ARGS)

# The wheels of ROS 2 are for this platform only.
ifeq ($(shell uname -sm),Linux x86_64)
test-ros2: $(INSTALLED_ROS2) ## the tests with real ROS 2 nodes, which need no ROS installation
	@$(NOT_OF_ROS) $(ROS2)/bin/pytest -rs -p no:cacheprovider -m ros2 $(PARALLEL) \
	  tests/ros2 tests/conformance $(ARGS)
else
test-ros2:
	@echo "No tests with ROS 2 nodes here: its wheels are for Linux on x86_64, and this is $$(uname -sm)."
endif

hooks: ## let git run the fast checks before each commit
	@git config core.hooksPath .githooks

pre-commit: lint imports ## the fast checks: lint, imports, structure of the repository
	@$(BIN)/pytest -q --no-header -p no:cacheprovider tests/unit/test_structure.py

format: $(INSTALLED_DEV) ## format with ruff, and apply its fixes
	@$(BIN)/ruff check --fix .
	@$(BIN)/ruff format .

docs: $(INSTALLED_DEV) ## regenerate OpenAPI, AsyncAPI and the pages of docs/reference from the code
	@$(BIN)/python -m tests.support.document_examples
	@$(BIN)/python -m docs.generate

pictures: $(INSTALLED_DEV) ## renew the pictures of the page in docs/pictures; needs Chromium, takes 4 minutes
	@$(BIN)/python -m tests.browser.pictures $(ARGS)

bench: $(INSTALLED_DEV) ## run the benchmarks, with other software for comparison, and write docs/benchmarks.md
	@$(if $(ARGS),,rm -f build/bench/*.json)
	@$(BIN)/pytest -s -m bench --timeout=0 $(or $(ARGS),tests/bench); code=$$?; \
	  $(BIN)/python -m tests.support.bench_document && exit $$code

bench-ros2: $(INSTALLED_ROS2) ## run the benchmarks with fifty real ROS 2 nodes, and write docs/benchmarks.md
	@$(NOT_OF_ROS) $(ROS2)/bin/pytest -s -p no:cacheprovider -m bench --timeout=0 \
	  tests/bench/bench_ros2.py tests/bench/bench_ros2_estop.py tests/bench/bench_ros2_states.py \
	  tests/bench/bench_ros2_topics.py $(ARGS); \
	  code=$$?; $(ROS2)/bin/python -m tests.support.bench_document && exit $$code

coverage: $(INSTALLED_DEV) ## branch coverage of the core, each module by its own test file
	@$(BIN)/pytest -q tests/unit/domain --cov --cov-context=test --cov-report=
	@$(BIN)/python -m tests.support.module_coverage

mutation: $(INSTALLED_DEV) ## mutation tests of the core: about 7,600 mutants
	@rm -rf mutants
	@$(BIN)/mutmut run
	@$(BIN)/python -m tests.support.mutation_score

# With ARGS only these tests are meant.
soak: $(INSTALLED_DEV) $(if $(ARGS),,coverage mutation) ## coverage, mutation, and all tests with many more generated examples
	@PILOTHOUSE_SOAK=1 $(BIN)/pytest -rs -m "not bench and not browser and not image and not ros2" --timeout=0 $(ARGS)
	@$(if $(ARGS),,PILOTHOUSE_SOAK=1 $(BIN)/pytest -rs --timeout=0 tests/browser/test_heap.py)

lowest: $(INSTALLED_DEV) ## the tests, with the oldest dependencies that pyproject.toml allows
	@$(PIP_INSTALL) uv
	@$(BIN)/uv pip compile --quiet --resolution lowest-direct --extra dev \
	  --output-file $(LOWEST)/requirements.txt pyproject.toml
	@$(BIN)/python -m venv $(LOWEST)
	@$(LOWEST)/bin/python -m pip install -qq --disable-pip-version-check \
	  --requirement $(LOWEST)/requirements.txt --editable .
	@$(LOWEST)/bin/pytest -rs -p no:cacheprovider $(or $(ARGS),$(PARALLEL))

lock: $(INSTALLED_DEV) ## update requirements.lock and requirements-link.lock
	@$(PIP_INSTALL) uv
	@{ echo "# For installs that are the same everywhere, as in the image; made by \`make lock\`."; \
	   echo "# Use: pip install --require-hashes -r requirements.lock && pip install --no-deps ."; \
	   $(BIN)/uv pip compile --quiet --universal --upgrade --generate-hashes --no-annotate \
	     --no-header --no-emit-index-url --no-emit-find-links pyproject.toml; } > requirements.lock.new
	@mv requirements.lock.new requirements.lock
	@{ echo "# What links several computers, for the image built with --build-arg LINK=1; made by \`make lock\`."; \
	   sed -n 's/^link = \["\(.*\)"\]$$/\1/p' pyproject.toml | \
	   $(BIN)/uv pip compile --quiet --universal --upgrade --generate-hashes --no-annotate \
	     --no-header --no-emit-index-url --no-emit-find-links -; } > requirements-link.lock.new
	@mv requirements-link.lock.new requirements-link.lock

clean: ## remove the environment, caches and builds
	rm -rf $(VENV) build dist mutants *.egg-info .coverage .hypothesis .import_linter_cache .mypy_cache .pytest_cache .ruff_cache
	find api domain service web tests -name __pycache__ -type d -prune -exec rm -rf {} +

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || { \
	  echo "Pilothouse needs Python 3.11 or newer, and '$(PYTHON)' is: $$($(PYTHON) --version 2>&1)." >&2; \
	  echo "Name another one, as in: make PYTHON=python3.12 $(MAKECMDGOALS)" >&2; exit 1; }
	@echo "Creating $(VENV) ..."
	@$(PYTHON) -m venv $(VENV) || { rm -rf $(VENV); \
	  echo "'$(PYTHON) -m venv' failed; on Debian and Ubuntu: apt install python3-venv" >&2; exit 1; }

# Order only after `|`: the interpreter's own date says nothing about what is installed.
$(INSTALLED): pyproject.toml | $(BIN)/python
	@echo "Installing Pilothouse into $(VENV) (some seconds) ..."
	@$(call INSTALL,$(VENV),--editable .)
	@touch $@

$(INSTALLED_DEV): pyproject.toml | $(BIN)/python
	@echo "Installing Pilothouse and its development tools into $(VENV) (about half a minute) ..."
	@$(call INSTALL,$(VENV),--editable '.[dev]')
	@touch $@ $(INSTALLED)

$(INSTALLED_ROS2): pyproject.toml | $(BIN)/python
	@echo "Installing Pilothouse and the wheels of ROS 2 into $(ROS2) (about half a minute) ..."
	@$(BIN)/python -m venv $(ROS2)
	@$(call INSTALL,$(ROS2),--editable '.[dev$(COMMA)ros2]')
	@touch $@
