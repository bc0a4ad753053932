# Two commands do all the set-up: `make run` and `make test`. The rest is for those who work on it.
PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV ?= .venv
BIN = $(VENV)/bin
SCENARIO ?= guo2015-case4

# Each `apa` of the tests starts in two thirds of the time with its bytecode kept; some images switch that off.
export PYTHONDONTWRITEBYTECODE =

PYTEST = $(BIN)/python -m pytest -n auto --dist loadfile --no-loadscope-reorder -q

.PHONY: ci-tools run test quick release release-tools release-tests audit sbom costs fuzz mutants check lint types bench docs reproduce clean help

help: ## Show this list
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed 's/:.*## /\t/' | expand -t 14

run: $(VENV)/.run ## Install, build the FMUs, run a parking case, print the table, name the log, figure and report
	$(BIN)/apa build
	$(BIN)/apa run $(SCENARIO)

test: $(VENV)/.test ## Install and pass the tests that each change must pass
	$(PYTEST) -m 'not release'

quick: lint types ## Lint, types and the tests that cost less than 0.3 s of processor (tests/costs.tsv)
	$(PYTEST) -m 'not slow'

release: release-tools check release-tests audit sbom mutants bench docs ## All that must hold before a release and each night

release-tests: $(VENV)/.test ## The tests that need not run on each change
	$(PYTEST) -m release

costs: $(VENV)/.test ## Run all tests and record what each costs in tests/costs.tsv
	$(PYTEST) --costs

release-tools: $(VENV)/.release ## Stop if a tool is missing without which tests would be skipped
	@for tool in gcc valgrind; do command -v $$tool >/dev/null || { echo "make release needs $$tool" >&2; exit 1; }; done

audit: $(VENV)/.release ## Look the pinned dependencies up among known vulnerabilities; one that cannot be is an error
	$(BIN)/pip-audit --strict --no-deps --disable-pip --progress-spinner off --requirement constraints.txt

sbom: $(VENV)/.run ## Write the bills of materials (CycloneDX) of the wheel and of the FMUs into build/sbom
	rm -rf build/lib build/wheel build/fmus build/sbom
	$(BIN)/python -m pip wheel --quiet --no-deps --wheel-dir build/wheel .
	$(BIN)/apa build --out build/fmus
	$(BIN)/python -m fmus.sbom build/wheel/*.whl $$(find build/fmus -name '*.fmu') --out build/sbom

define INSTALL_TYPESCRIPT
$(BIN)/npm install --silent --no-save --no-package-lock --prefix $(VENV)/scripts typescript@5.9.3 || \
    echo "No TypeScript: the scripts of the pages are not type-checked here"
endef

FUZZ_SECONDS ?= 600
fuzz: $(VENV)/.test ## Attack inputs, tables, systems, logs, kills, FMI calls, the planner, FMUs, journals, Parquet, drives, scenes, policies, ten minutes each, with new seeds
	for kind in inputs tables ssp logs kills calls planner fmus journals parquet scenes drives policies; do $(BIN)/python -m tests.fuzz $$kind --seconds $(FUZZ_SECONDS) || exit 1; done

mutants: $(VENV)/.test ## Make mistakes in the laws of all papers and say which nobody finds, an hour on one core
	$(BIN)/python -m tests.mutants --fixed
	$(BIN)/python -m tests.mutants --listed
	$(BIN)/python -m tests.mutants

check: lint types test ## Lint, types and tests

lint: $(VENV)/.test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/python -m tests.vocabulary

types: $(VENV)/.test
	$(BIN)/mypy modelkit vehicle_fmu controller_fmu fmus orchestrator apa_cosim tests benchmarks docs

BENCH ?=
bench: $(VENV)/.test ## Measure speed, as ratios side by side in one run; BENCH=--resume goes on with an unfinished one
	$(BIN)/python -m benchmarks $(BENCH)

reproduce: $(VENV)/.test ## The papers' numbers beside ours
	$(BIN)/apa reproduce all

docs: $(VENV)/.docs ## Build the documentation site into site/
	$(BIN)/python docs/generate.py
	$(BIN)/mkdocs build --strict

clean: ## Remove what was built and logged, and the virtual environment
	rm -rf fmus/dist runs site build *.egg-info $(VENV)

$(VENV)/.run: pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit("Python 3.11 or newer is needed; name one with: make PYTHON=python3.11") if sys.version_info < (3, 11) else None'
	@echo "Installing into $(VENV): 1.2 GB, about two minutes with a fast connection"
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --editable '.[native,sweep]'
	@touch $@

$(VENV)/.test: $(VENV)/.run pyproject.toml
	@echo "Installing what the tests need into $(VENV): 1 GB more, some minutes"
	$(BIN)/python -m pip install --quiet --editable '.[native,sweep,export,test]'
	$(INSTALL_TYPESCRIPT)
	@touch $@

CI_PACKAGES = --editable '.[native,sweep,export,test,docs]'
ci-tools: ## Install all that CI needs at once, several packages at a time, and compile only what is imported
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --no-compile 'uv>=0.5,<1' && \
	    $(BIN)/uv pip install --quiet --python $(BIN)/python $(if $(PIP_CONSTRAINT),--constraint $(PIP_CONSTRAINT)) $(CI_PACKAGES) || \
	    $(BIN)/python -m pip install --quiet --no-compile $(CI_PACKAGES)
	$(INSTALL_TYPESCRIPT)
	touch $(VENV)/.run $(VENV)/.test $(VENV)/.docs

$(VENV)/.release: $(VENV)/.run pyproject.toml
	$(BIN)/python -m pip install --quiet --editable '.[native,sweep,release]'
	@touch $@

$(VENV)/.docs: $(VENV)/.run pyproject.toml
	$(BIN)/python -m pip install --quiet --editable '.[native,sweep,docs]'
	@touch $@
