# SPDX-License-Identifier: Apache-2.0
# Entry point: `make` alone lists the targets.
SHELL      := /bin/sh
PYTHON     ?= python3
CONFIG     ?= full
JOBS       ?= 2
BOARD      ?= golden
MINUTES    ?= $(if $(filter soak,$(MAKECMDGOALS)),60,10)
CRASHES    ?= 48
VENV       := .venv
PY         := $(VENV)/bin/python
PIP        := $(PY) -m pip --disable-pip-version-check --quiet
.DEFAULT_GOAL := help

.PHONY: help
help: ## List the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-14s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

$(VENV)/.installed: requirements.lock pyproject.toml
	@sim/prerequisites.sh $(PYTHON)
	@echo "signum: Python packages into $(VENV) (a few minutes the first time)"
	@test -x $(PY) || $(PYTHON) -m venv $(VENV)
	@$(PIP) install -r requirements.lock
	@$(PIP) install --no-deps --no-build-isolation --editable .
	@touch $@

$(VENV)/.synth: requirements-synth.lock $(VENV)/.installed
	@$(PIP) install -r requirements-synth.lock
	@touch $@

.PHONY: setup
setup: $(VENV)/.installed ## Virtual environment with pinned packages and the Verilated board; then use .venv/bin/signum
	@$(PY) -m sim.board

.PHONY: demo
demo: setup ## Simulated flight through the Verilated board: out/demo/report.html
	@$(VENV)/bin/signum demo --out out/demo

.PHONY: reproduce
reproduce: setup ## Every figure and table of the paper on one page: out/reproduce/index.html (BOARD=golden|verilated)
	@$(PY) -m signum.reproduce --board $(BOARD) --out out/reproduce

.PHONY: test
test: setup ## Every test, on two cores (JOBS=n for others): out/junit.xml
	@$(PY) -m pytest -n $(JOBS) --junit-xml=out/junit.xml

.PHONY: fuzz
fuzz: setup ## Damaged inputs of every kind through the commands, counted by outcome: out/fuzz/failures (MINUTES=10; SEED=n repeats)
	@PYTHONPATH=sw $(PY) -m tests.fuzz --minutes $(MINUTES) $(if $(SEED),--seed $(SEED)) --jobs $(JOBS)

.PHONY: soak
soak: $(VENV)/.installed ## Verilated board with assertions against the frame level, new seeds and power-up states: out/soak (MINUTES=60; SEED=n; REPLAY=file)
	@PYTHONPATH=sw $(PY) -m tests.soak --jobs $(JOBS) $(if $(REPLAY),--replay $(REPLAY),--minutes $(MINUTES)) $(if $(SEED),--seed $(SEED))

.PHONY: coverage
coverage: $(VENV)/.installed ## Line, branch, toggle and functional coverage of the RTL by its regression, held to the bars: out/coverage/index.html
	@$(PY) -m sim.coverage --jobs $(JOBS)

.PHONY: crash
crash: setup ## Kill mosaic, track and hold at CRASHES=48 random moments, fill the disk, remove the folder; compare bytes (SEED=n)
	@CRASHES=$(CRASHES) $(if $(SEED),SEED=$(SEED)) $(PY) -m pytest -s sw/tests/commands/test_crash.py

.PHONY: endurance
endurance: setup ## Memory and time a frame over 2,000 frames of mosaic and 10,000 of track and hold
	@PYTHONPATH=sw $(PY) -m tests.endurance

.PHONY: hover
hover: setup ## Rendered hover clips, murky, turned, pushed, blocked, of other seabeds: readings against the truth, held to bars (20 minutes)
	@PYTHONPATH=sw $(PY) -m tests.hover

.PHONY: stream
stream: setup ## signum hold on a looped 30 fps H.264 stream from another process: memory, age of frames, messages, sum of deltas (MINUTES=10)
	@PYTHONPATH=sw $(PY) -m tests.stream --minutes $(MINUTES)

.PHONY: speed
speed: setup ## Searches of the golden board against OpenCV; frames a second of flow, hold and mosaic on one core, held to bars
	@PYTHONPATH=sw $(PY) -m tests.speed

.PHONY: tracks
tracks: setup ## Tracks of clips that return to their start, clear and murky, against their known motion, held to bars
	@PYTHONPATH=sw $(PY) -m tests.tracks

.PHONY: links
links: setup ## Links of real and rendered surveys against SIFT and truth, tilted and over relief, held to bars (SEED=1)
	@PYTHONPATH=sw $(PY) -m tests.links $(if $(SEED),--seed $(SEED))

.PHONY: dense-bars
dense-bars: setup ## Dense stereo and flow against the truth, clean and murky, held to bars (SEED=1; a minute)
	@PYTHONPATH=sw $(PY) -m tests.dense_bars $(if $(SEED),--seed $(SEED))

.PHONY: moving-bars
moving-bars: setup ## What moves by itself at full resolution, photographs with a thing that moves otherwise, clean and murky, held to bars (SEED=1; 4 minutes)
	@PYTHONPATH=sw $(PY) -m tests.moving_bars $(if $(SEED),--seed $(SEED))

.PHONY: navigate-bars
navigate-bars: setup ## Small views found in a mosaic without a prior, clear and murky, held to bars (SEED=1)
	@PYTHONPATH=sw $(PY) -m tests.localising $(if $(SEED),--seed $(SEED))

.PHONY: dense
dense: setup ## Verilated board dense against the golden one at 640x480, every field, and the time of a pass, held to bars (SEED=1)
	@PYTHONPATH=sw $(PY) -m tests.dense_board $(if $(SEED),--seed $(SEED))

.PHONY: compare
compare: setup ## Signum beside Lucas-Kanade, DIS, ORB, SIFT, OpenCV's Stitcher and stereo on the same frames: out/compare/index.html (SEED=1; 10 minutes)
	@PYTHONPATH=sw $(PY) -m tests.compare $(if $(SEED),--seed $(SEED))

.PHONY: lint
lint: $(VENV)/.installed ## Check Python, RTL and generated files, without running tests
	@$(PY) -m ruff check .
	@$(PY) -m mypy
	@$(PY) -m golden.params --check
	@$(PY) -m golden.coefs --check
	@$(PY) -m sim.registers --check
	@$(PY) -m sim.testbench.vectors --check
	@$(PY) -m sim.lint

.PHONY: core
core: $(VENV)/.installed ## FuseSoC runs the targets of signum.core: lint, and a frame's signs without Python
	@$(PY) -m sim.lint.core

.PHONY: docs
docs: $(VENV)/.installed ## The documentation as a site: out/site/index.html; every warning is an error
	@NO_MKDOCS_2_WARNING=1 $(PY) -m mkdocs build --strict --quiet

.PHONY: synth
synth: $(VENV)/.synth ## Yosys and nextpnr for the LFE5U-85F: out/synth/report.json (CONFIG=full|tiny|dense|tiny_dense; PATHS=5: only list paths over 5 ns; PLACED=6: the same after placement)
	@$(PY) -m sim.synth --config $(CONFIG) $(if $(PATHS),--paths $(PATHS)) $(if $(PLACED),--placed $(PLACED))

.PHONY: synth-wide
synth-wide: $(VENV)/.synth ## The wide dense engine for the LFE5U-85F, out of context: out/synth/dense_wide/report.json (LANES="16 32 64"; up to 208)
	@$(PY) -m sim.synth.wide $(if $(LANES),--lanes $(LANES))

.PHONY: formal
formal: $(VENV)/.synth ## Prove the RTL's assertions (QUICK=1: those that take little time; PROOFS="fifo grid": only these; BROKEN=1: each must find a defect)
	@$(PY) -m sim.formal $(if $(QUICK),--quick) $(if $(BROKEN),--broken) $(PROOFS)

.PHONY: gates
gates: $(VENV)/.synth ## Modules and the board tiny as netlists of ECP5 cells under their own tests: out/gates/report.json (MODULES="fifo peak": only these)
	@$(PY) -m sim.gates --jobs $(JOBS) $(MODULES)

.PHONY: mutate
mutate: $(VENV)/.synth ## Mutants of the RTL against their modules' tests (SAMPLE=30: only as many; MODULES="fifo grid"; GOLDEN=1: of the golden model)
	@$(PY) -m $(if $(GOLDEN),sim.mutate.golden,sim.mutate --jobs $(JOBS) $(if $(SAMPLE),--sample $(SAMPLE)) $(MODULES))

.PHONY: bench
bench: setup ## Speeds of board, simulators and OpenCV on this machine: out/bench.json
	@$(PY) -m sim.speed

.PHONY: regs
regs: $(VENV)/.installed ## Regenerate all files made from slog_*csr.rdl, golden/params.py, golden/log.py and rtl/files.f
	@$(PY) -m golden.params
	@$(PY) -m golden.coefs
	@$(PY) -m sim.registers
	@$(PY) -m sim.testbench.vectors
	@$(PY) -m sim.lint.lists --write
	@$(PY) -m sim.lint.spdx --write

.PHONY: lock
lock: ## Pin the newest packages that pyproject.toml allows (needs uv)
	uv pip compile --quiet --universal --python-version 3.11 --no-header --no-annotate --upgrade --extra dev pyproject.toml \
	  -o requirements.lock
	uv pip compile --quiet --universal --python-version 3.11 --no-header --no-annotate --upgrade --extra dev \
	  --extra synth -c requirements.lock pyproject.toml -o requirements-synth.lock

.PHONY: clean
clean: ## Remove all builds and outputs, but not the virtual environment
	rm -rf build out
