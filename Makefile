# Needs Python 3.11 or later and make; everything else is installed into .venv/ from the lock files.
PYTHON ?= python3
BIN := .venv/bin
LOCKED := $(BIN)/python -m pip install --quiet --require-hashes --requirement
# Packages by themselves, that go with all the others.
BESIDE := uv pip compile --quiet --universal --generate-hashes --no-header --no-deps \
  --constraint requirements-test.lock - --output-file
SELF := $(BIN)/python -m pip install --quiet --no-deps --no-build-isolation --editable .

.PHONY: study test checks tests docs bench faults hunt lock references clean

study: .venv/peers  ## Compute the default study into results/default/.
	$(BIN)/cablesim study || test $$? -eq 1  # 1: done, and some scenarios have no solution

test: .venv/test  ## Formatting, types, import directions and all tests, side by side.
	$(MAKE) --jobs 2 checks tests

checks: .venv/test
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/snakefmt --check Snakefile workflow
	$(BIN)/lint-imports
	$(BIN)/mypy

tests: .venv/test
	$(BIN)/python -m pytest --numprocesses auto --dist loadfile --no-loadscope-reorder

docs: .venv/test study  ## Build the site into site/ from the pages, the package and the default study.
	NO_MKDOCS_2_WARNING=1 DISABLE_MKDOCS_2_WARNING=true $(BIN)/python -m mkdocs build --quiet --strict
	@echo "site/index.html is the first page; to search, serve it: $(BIN)/python -m http.server --directory site"

bench: .venv/test study  ## Speed against named alternatives; prints tables.
	$(BIN)/python benchmarks/exact_catenary.py
	$(BIN)/python benchmarks/workflow.py
	$(BIN)/python benchmarks/estimates.py
	$(BIN)/python benchmarks/scale.py
	$(BIN)/python benchmarks/database.py
	$(BIN)/python benchmarks/cluster.py
	$(BIN)/python benchmarks/stream_lines.py
	$(BIN)/python benchmarks/composite_lines.py
	$(BIN)/python -m benchmarks.two_point_check
	$(BIN)/python benchmarks/wave_peers.py
	$(BIN)/python benchmarks/wave_lines.py
	$(BIN)/python -m benchmarks.page results/default

faults: .venv/test  ## Inject every fault many times and write docs/faults.md: an hour.
	$(BIN)/python -m tests.faults

hunt: .venv/study  ## Hunt for answers that are wrong without saying so: a million scenarios, hours.
	$(BIN)/cablesim hunt --scenarios 1000000

references: .venv/test  ## Recompute the high-precision references of the tests.
	$(BIN)/python tests/reference/make_catenary_references.py
	$(BIN)/python tests/reference/make_composite_references.py
	$(BIN)/python tests/reference/make_stream_references.py
	$(BIN)/python tests/reference/make_strength_references.py
	$(BIN)/python tests/reference/make_wave_references.py
	$(BIN)/python tests/reference/make_precision_references.py

lock:  ## Resolve the dependencies anew (needs uv).
	uv pip compile --quiet --universal --generate-hashes --no-header --extra build \
	  pyproject.toml --output-file requirements.lock
	uv pip compile --quiet --universal --generate-hashes --no-header --extra build --extra test \
	  --constraint requirements.lock pyproject.toml --output-file requirements-test.lock
	echo "moordyn moorpy" | tr ' ' '\n' | $(BESIDE) requirements-peers.lock
	echo "dask-jobqueue snakemake-executor-plugin-slurm snakemake-executor-plugin-slurm-jobstep" | tr ' ' '\n' \
	  | $(BESIDE) requirements-slurm.lock

.venv/study: requirements.lock pyproject.toml
	test -d .venv || $(PYTHON) -m venv .venv
	$(LOCKED) requirements.lock
	$(SELF)
	touch $@

.venv/test: requirements-test.lock .venv/study
	$(LOCKED) requirements-test.lock
	touch $@

# What a study needs to run on a cluster with Slurm: only there, because every start of Snakemake looks for executors.
.venv/slurm: requirements-slurm.lock .venv/study
	$(LOCKED) requirements-slurm.lock --no-deps
	touch $@

# Other people's programs to compare with, where they can be had: without them their methods are `unavailable`.
.venv/peers: requirements-peers.lock .venv/study
	$(LOCKED) requirements-peers.lock --no-deps || echo "MoorPy and MoorDyn are left out: they cannot be installed here."
	touch $@

clean:  ## Remove the environment; results are kept.
	rm -rf .venv
