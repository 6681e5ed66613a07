# Two commands do everything: `make demo` and `make test`. Each sets up what it needs first.

SHELL := /bin/sh
PYTHON ?= $(shell for p in python3 python3.14 python3.13 python3.12 python3.11 python; do \
	command -v $$p >/dev/null 2>&1 && \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && \
	{ echo $$p; break; }; done)
RUST_NEEDED := $(shell sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
VENV := .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/installed
READY := $(VENV)/ready
SITE_READY := $(VENV)/site-ready
SITE ?= target/site
OUT ?= stiction-demo
BLIND ?= target/blind
GATE ?= target/gate
JOBS ?= 2
NUMBER ?= 200
SEED ?= 0
SECONDS ?= 3600
PREFIX ?= /usr/local
EDITION := $(shell sed -n 's/^edition = "\(.*\)"/\1/p' Cargo.toml)
# cargo fmt follows `mod` lines; those of laws and effects stand in macros, which it does not enter.
RUST := $(shell find crates benches -name '*.rs')
LIST_NEEDED := 'import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["project"]["dependencies"])'
SOURCES := Cargo.toml Cargo.lock pyproject.toml $(shell find crates -name '*.rs' -o -name Cargo.toml)
export PYO3_PYTHON := $(abspath $(BIN)/python)
export CARGO_TERM_PROGRESS_WHEN := never
export PIP_DISABLE_PIP_VERSION_CHECK := 1

# Fuzzing takes a fresh seed where none is given.
GIVEN_SEED = $(if $(filter-out file,$(origin SEED)),--seed $(SEED))

.PHONY: demo test test-fast test-slow site lint rust-tests python-tests gate blind ordinary fuzz wheel install-c bench format audit clean toolchain

demo: $(INSTALLED)
	$(BIN)/stiction demo --out $(OUT)

test: lint rust-tests python-tests
	@echo "all tests passed"

toolchain:
	@if [ -z "$(PYTHON)" ]; then \
		echo "Python 3.11 or newer is missing; on Debian: apt-get install python3 python3-venv" >&2; \
		exit 1; fi
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || { \
		echo "$(PYTHON) lacks venv; on Debian: apt-get install python3-venv" >&2; exit 1; }
	@command -v cargo >/dev/null 2>&1 && command -v rustc >/dev/null 2>&1 || { \
		echo "Rust $(RUST_NEEDED) or newer is missing; run: curl --proto '=https' -sSf https://sh.rustup.rs | sh" >&2; exit 1; }
	@have=$$(rustc --version | cut -d' ' -f2); \
	least=$$(printf '%s\n%s\n' "$(RUST_NEEDED)" "$$have" | sort -V | head -n 1); \
	[ "$$least" = "$(RUST_NEEDED)" ] || { \
		echo "rustc $$have is older than $(RUST_NEEDED); run: rustup update stable" >&2; exit 1; }

# What the demo needs and no more. It is fetched while the core compiles.
$(INSTALLED): $(SOURCES) | toolchain
	[ -x $(BIN)/python ] || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet $$($(BIN)/python -c $(LIST_NEEDED)) & \
	$(BIN)/python -m pip install --quiet --no-deps --editable . && wait $$!
	touch $@

# The tools of development beside it; what was compiled stays.
$(READY): $(INSTALLED)
	$(BIN)/python -m pip install --quiet --editable '.[dev]'
	touch $@

lint: $(READY)
	@rustfmt --version >/dev/null 2>&1 && cargo clippy --version >/dev/null 2>&1 || { \
		echo "rustfmt or clippy is missing; run: rustup component add rustfmt clippy" >&2; exit 1; }
	rustfmt --edition $(EDITION) --check $(RUST)
	cargo clippy --quiet --workspace --all-targets -- -D warnings
	$(BIN)/ruff format --check python tests examples benches docs/site docs/walkthroughs
	$(BIN)/ruff check python tests examples benches docs/site docs/walkthroughs
	$(BIN)/mypy
	$(BIN)/stubtest stiction._native --ignore-disjoint-bases

# As compiled for the package, so that nothing is compiled twice; with checks of overflow in `make test-slow`.
rust-tests: $(READY)
	cargo test --quiet --release

# Files go over the processor's cores, each whole, for its tests share what was made once; not those of many tests
# first, or the long ones, which have few, would be left to one core in the end.
PYTEST := OPENBLAS_NUM_THREADS=1 $(BIN)/pytest --quiet --numprocesses auto --maxprocesses 8 --dist loadfile \
	--no-loadscope-reorder

python-tests: $(READY)
	$(PYTEST) -m 'not slow'

# Before every commit: two minutes on two cores, as counted by the time of the processor. What is fast of the
# diagnosis is what builds its records by tests/diagnosis/builders.py; whole diagnoses are in `make test`.
FAST := $(addprefix tests/,house files recording plant session results report plan library core) \
	$(patsubst %,tests/diagnosis/test_%.py,bursts excess less_than_a_turn own_coordinates pieces replication \
		rounds screen sentence sharpen small_regressions traces words_of_machines)

test-fast: $(READY)
	$(PYTEST) -m 'not slow and not long' $(FAST)

# What takes long and guards what changes seldom: Rust's tests with checks of overflow, the simulators that tests
# use, the longest diagnoses, the table of properties, a wheel, the law of the page; then the site and the gate.
test-slow: $(READY)
	cargo test --quiet
	$(PYTEST) -m slow
	$(MAKE) site
	$(MAKE) gate

# The documentation as a site, built and checked: pages, executed walkthroughs, gallery, reference.
site: $(SITE_READY)
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m docs.site -o $(SITE)

# Apart from the tools of development, for nobody who changes code has to wait for them.
$(SITE_READY): $(READY)
	$(BIN)/python -m pip install --quiet --editable '.[docs]'
	touch $@

# Fresh sessions of every family and all real recordings, the way that a user goes: none may be lost.
gate: $(READY)
	$(BIN)/python -m tests.blind.gate --jobs $(JOBS) --out $(GATE)

# Scores of the diagnosis on sessions with a hidden truth; goes on where it was interrupted.
blind: $(READY)
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m tests.blind --number $(NUMBER) --seed $(SEED) \
		--out $(BLIND)/scores.jsonl

# The same on ordinary sessions: any encoder, clock, drive, loop and stated law.
ordinary: $(READY)
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m tests.blind.ordinary --cases grid,null,hidden \
		--number $(NUMBER) --seed $(SEED) --jobs $(JOBS) --out $(BLIND)/ordinary.jsonl

# Every public call and every file format, with whatever breaks them, on all cores; prints finds as
# they come, each with the seed that repeats it.
fuzz: $(READY)
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m tests.fuzz --seconds $(SECONDS) $(GIVEN_SEED)

wheel: $(READY)
	$(BIN)/maturin build --quiet --release --out dist

# The C and C++ interface: headers, libraries, a CMake package and a pkg-config file.
install-c:
	crates/stiction-capi/install.sh $(PREFIX)

bench: $(READY)
	cargo bench
	$(BIN)/python benches/step_overhead.py

format: $(READY)
	rustfmt --edition $(EDITION) $(RUST)
	$(BIN)/ruff format python tests examples benches docs/site docs/walkthroughs
	$(BIN)/ruff check --fix python tests examples benches docs/site docs/walkthroughs

# No part of `make test`: the answer changes while the code does not, and asks the network.
audit: $(READY)
	@cargo deny --version >/dev/null 2>&1 || { \
		echo "cargo-deny is missing; run: cargo install --locked cargo-deny" >&2; exit 1; }
	cargo deny --offline check licenses bans sources
	@cargo deny fetch db || { \
		echo "the database of advisories cannot be reached; run this where there is a network" >&2; exit 1; }
	cargo deny check --disable-fetch advisories
	@$(BIN)/pip-audit --version >/dev/null 2>&1 || $(BIN)/python -m pip install --quiet 'pip-audit>=2.7'
	@$(BIN)/pip-audit --local --skip-editable --progress-spinner off || { \
		echo "pip-audit names a package above, or could not ask; mend it, or run this where there is a network" >&2; \
		exit 1; }
	@echo "nothing is known against the dependencies"

clean:
	rm -rf $(VENV) target dist .pytest_cache .mypy_cache .ruff_cache .hypothesis
