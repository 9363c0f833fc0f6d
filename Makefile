# Joulepath. `make help` lists the targets; tools/make/ holds the rules.

CC       ?= cc
BUILD    ?= build
UNITY    ?= tests/unity
ROBOT    ?= gao2018
SCENARIO ?= sim/scenarios/gao2018_mission.cfg
JP_SETUP ?= yes
JOBS     ?= $(shell env -u OMP_NUM_THREADS nproc)

# Set-up makes .venv after this line is read; only without set-up can it be absent.
PYTHON ?= $(if $(filter skip,$(JP_SETUP)),$(or $(wildcard .venv/bin/python),python3),.venv/bin/python)
# Pinned too: other versions format otherwise, and find other things.
CLANG_FORMAT ?= $(if $(filter skip,$(JP_SETUP)),$(or $(wildcard .venv/bin/clang-format),clang-format),.venv/bin/clang-format)
CLANG_TIDY   ?= $(if $(filter skip,$(JP_SETUP)),$(or $(wildcard .venv/bin/clang-tidy),clang-tidy),.venv/bin/clang-tidy)

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.SECONDARY:
MAKEFLAGS += --no-builtin-rules --no-print-directory
export JP_SETUP JOBS PYTHON CLANG_FORMAT CLANG_TIDY
export JP_BUILD := $(abspath $(BUILD))
# make runs a process for each core: threads of BLAS beside it only wait for each other.
export OPENBLAS_NUM_THREADS := 1
export OMP_NUM_THREADS      := 1

V ?= 0
ifeq ($(V),0)
Q := @
SAY = @echo '  $1'
endif

# Every core works unless make was called with -j.
PARALLEL = $(if $(filter -j% --jobserver%,$(MAKEFLAGS)),,-j$(JOBS)) --output-sync=target

PARTS := $(addprefix tools/make/,variants.mk sources.mk build.mk drive.mk design.mk firmware.mk bench.mk install.mk python.mk page.mk test.mk fuzz.mk mutants.mk prove.mk)

.PHONY: help
help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' Makefile $(PARTS) | expand -t 14

include $(PARTS)

.PHONY: all
all: $(PROGRAMS) $(call host_libraries,host) ## build the host programs in build/bin and the libraries

.PHONY: setup
setup: ## install what all targets need (JP_SETUP=skip to manage packages yourself)
	@tools/setup.sh test

.PHONY: format
format: ## format the C sources, but for the CAN codec, whose style is that of its generator
	find include src hal sim tests -name '*.[ch]' ! -path 'hal/can/jp_can.[ch]' -exec $(CLANG_FORMAT) -i {} +

.PHONY: clean
clean: ## remove build/
	rm -rf $(BUILD)

-include $(shell [ -d $(BUILD) ] && find $(BUILD) -name '*.d')
