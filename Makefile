# Bare `make` lists the targets. Needs Python >= 3.11, a Rust toolchain and make; everything else is set up here.
PYTHON ?= python3
export UV_PYTHON_DOWNLOADS = never
# uv is used when it runs, and bootstrapped through pip into .venv-uv otherwise.
UV := $(shell uv --version >/dev/null 2>&1 && echo uv || echo .venv-uv/bin/uv)
RUN := $(UV) run --no-sync

.PHONY: help setup demo test check fmt bench bench-models validate clean

help: ## list the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 12

.venv-uv/bin/uv:
	$(PYTHON) -m venv .venv-uv
	.venv-uv/bin/python -m pip install --quiet uv

setup: $(filter .venv-uv/bin/uv,$(UV)) ## build the Rust core in release mode and install the Python package
	$(UV) sync --quiet --python $(PYTHON)

demo: setup ## simulate, process, check and report a campaign of a known material
	$(RUN) gonio demo

test: setup ## every test, Rust and Python
	cargo test --workspace --release --quiet
	$(RUN) pytest -n auto --dist worksteal

check: setup ## format, lints, types and the fast tests
	cargo fmt --all --check
	cargo clippy --workspace --all-targets --release --quiet -- -D warnings
	$(RUN) ruff format --check python tests bench examples
	$(RUN) ruff check
	$(RUN) mypy
	cargo test --workspace --release --quiet
	$(RUN) pytest -m "not slow" -n auto --dist worksteal

fmt: setup ## format Rust and Python
	cargo fmt --all
	$(RUN) ruff format python tests bench examples
	$(RUN) ruff check --fix

bench: setup ## compare with peers and write bench/results.json
	$(RUN) python -m bench

bench-models: setup ## compare data-driven, reduced and exported models with peers
	$(RUN) python -m bench models

validate: setup ## regenerate the tables of docs/validation
	$(RUN) python -m tests.validation

clean: ## remove what was built
	cargo clean
	rm -rf .venv .venv-uv python/gonio/*.so
