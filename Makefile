# Joulepath. `make help` lists the targets; the sections below are: settings, programs, use, tests, upkeep.

CC       ?= cc
BUILD    ?= build
UNITY    ?= tests/unity
ROBOT    ?= gao2018
SCENARIO ?= sim/scenarios/gao2018_mission.cfg
JP_SETUP ?= yes
JOBS     ?= $(shell nproc)

# Set-up makes .venv after this line is read; only without set-up can it be absent.
PYTHON ?= $(if $(filter skip,$(JP_SETUP)),$(or $(wildcard .venv/bin/python),python3),.venv/bin/python)
# Pinned too: other versions format otherwise, and find other things.
CLANG_FORMAT ?= $(if $(filter skip,$(JP_SETUP)),$(or $(wildcard .venv/bin/clang-format),clang-format),.venv/bin/clang-format)
CLANG_TIDY   ?= $(if $(filter skip,$(JP_SETUP)),$(or $(wildcard .venv/bin/clang-tidy),clang-tidy),.venv/bin/clang-tidy)

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.SECONDARY:
MAKEFLAGS += --no-builtin-rules --no-print-directory
export JP_SETUP JOBS CLANG_FORMAT CLANG_TIDY
export JP_BUILD := $(abspath $(BUILD))

# ---- Settings: what each variant is compiled with -------------------------------------------------------------------

# Contraction is off so that the host programs give the same numbers under every compiler.
WARNINGS := -Wall -Wextra -Wconversion -Wshadow -Werror
COMMON   := -std=c11 -g $(WARNINGS) -Iinclude -I. -I$(UNITY) -isystem $(BUILD)/lcm -MMD -MP
HOST     := -D_GNU_SOURCE -ffp-contract=off -DUNITY_INCLUDE_DOUBLE -DUNITY_SUPPORT_64
SANITIZE := -O1 -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=all
ARM      := -mthumb -ffunction-sections -fdata-sections -Itests/target -DUNITY_INCLUDE_CONFIG_H -DUNITY_SUPPORT_64

HOST_TESTS   := host-gcc host-clang host-gcc-m32 host-clang-m32
TARGET_TESTS := cortex-m4 cortex-m4-nodsp cortex-m0 cortex-m7
ARM_VARIANTS := $(TARGET_TESTS) cortex-m4-os cortex-m0-o2
VARIANTS     := host $(HOST_TESTS) $(ARM_VARIANTS)

COMPILER.host            = $(CC)
COMPILER.host-gcc        = gcc
COMPILER.host-clang      = clang
COMPILER.host-gcc-m32    = gcc -m32
COMPILER.host-clang-m32  = clang -m32
$(foreach v,$(ARM_VARIANTS),$(eval COMPILER.$v = arm-none-eabi-gcc))

FLAGS.host            = $(HOST) -O2
FLAGS.host-gcc        = $(HOST) $(SANITIZE) -O2
FLAGS.host-clang      = $(HOST) $(SANITIZE)
FLAGS.host-gcc-m32    = $(HOST) $(SANITIZE)
FLAGS.host-clang-m32  = $(HOST) $(SANITIZE)
FLAGS.cortex-m4       = $(ARM) -mcpu=cortex-m4 -O2
FLAGS.cortex-m4-nodsp = $(ARM) -mcpu=cortex-m4 -O2 -DJP_NO_DSP
FLAGS.cortex-m4-os    = $(ARM) -mcpu=cortex-m4 -Os
FLAGS.cortex-m7       = $(ARM) -mcpu=cortex-m7 -O2
FLAGS.cortex-m0       = $(ARM) -mcpu=cortex-m0 -Os
FLAGS.cortex-m0-o2    = $(ARM) -mcpu=cortex-m0 -O2

BOARD.cortex-m4       = mps2-an386
BOARD.cortex-m4-nodsp = mps2-an386
BOARD.cortex-m7       = mps2-an500
BOARD.cortex-m0       = microbit

# A count of instructions needs a clock that counts them; the micro:bit has no use for it.
RUN.cortex-m4       = qemu-system-arm -M mps2-an386 -icount shift=0 $(SEMIHOSTING)
RUN.cortex-m4-nodsp = $(RUN.cortex-m4)
RUN.cortex-m7       = qemu-system-arm -M mps2-an500 -icount shift=0 $(SEMIHOSTING)
RUN.cortex-m0       = qemu-system-arm -M microbit $(SEMIHOSTING)
SEMIHOSTING         = -nographic -semihosting-config enable=on,target=native -kernel

# ---- Sources ---------------------------------------------------------------------------------------------------------

CORE           := $(wildcard src/*.c src/tables/*.c)
CAN            := $(wildcard hal/*.c hal/can/*.c)
SIM            := $(wildcard sim/*.c hal/sim/*.c hal/linux/*.c)
PROGRAMS       := $(patsubst sim/programs/%.c,$(BUILD)/bin/%,$(wildcard sim/programs/jp-*.c))
BENCHES        := $(filter-out bench_plan,$(patsubst tests/bench/%.c,%,$(wildcard tests/bench/bench_*.c)))
TARGET_BENCHES := $(patsubst tests/bench/%.c,%,$(wildcard tests/bench/target_*.c))

# lcm-gen makes them from sim/lcm/.
LCM_TYPES      := $(patsubst sim/lcm/%.lcm,%,$(wildcard sim/lcm/*.lcm))
LCM_HEADERS    := $(LCM_TYPES:%=$(BUILD)/lcm/%.h)

# A robot is built in when both of its tables are there.
NAMES          := $(patsubst src/tables/robot_%.c,%,$(wildcard src/tables/robot_*.c))
ROBOTS         := $(foreach n,$(NAMES),$(if $(wildcard src/tables/energy_$n.c),$n))
LATTICES       := $(patsubst src/tables/lattice_%.c,%,$(wildcard src/tables/lattice_*.c))

UNIT_TESTS     := $(wildcard tests/unit/test_*.c)
PROPERTY_TESTS := $(wildcard tests/property/prop_*.c)
BITS_TESTS     := $(wildcard tests/bits/test_*.c)
FAULT_TESTS    := $(wildcard tests/fault/fault_*.c)
VCAN_TESTS     := $(wildcard tests/vcan/vcan_*.c)
TARGET_SUPPORT := tests/target/start.c tests/target/semihosting.c tests/target/cycles.c

# With the real Unity its one source file joins each test, and the self-test of our header is left out.
UNITY_SOURCE := $(wildcard $(UNITY)/unity.c)
ifneq ($(UNITY_SOURCE),)
UNIT_TESTS := $(filter-out tests/unit/test_unity.c,$(UNIT_TESTS))
endif

LIBRARIES = $(shell pkg-config --libs libconfig jansson nlopt ccd) -llcm -lm -lpthread

# ---- Programs --------------------------------------------------------------------------------------------------------

V ?= 0
ifeq ($(V),0)
Q := @
SAY = @echo '  $1'
endif

.PHONY: help
help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' Makefile | expand -t 12

.PHONY: all
all: $(PROGRAMS) $(BUILD)/host/libjoulepath.a ## build the host programs in build/bin and the library

.PHONY: setup
setup: ## install what all targets need (JP_SETUP=skip to manage packages yourself)
	@tools/setup.sh test

# Objects are made again when the compiler or Unity of the last build was another one.
SETTINGS := $(BUILD)/settings
$(SETTINGS): FORCE
	@mkdir -p $(@D) && echo '$(CC) $(UNITY)' | cmp -s - $@ || echo '$(CC) $(UNITY)' >$@

# A library is made again when a source joined or left it.
MEMBERS := $(BUILD)/members
$(MEMBERS): FORCE
	@mkdir -p $(@D) && echo '$(CORE) $(CAN) $(SIM)' | cmp -s - $@ || echo '$(CORE) $(CAN) $(SIM)' >$@

define variant_rules
$(BUILD)/$1/%.o: %.c Makefile $(SETTINGS) $(if $(filter host%,$1),| $(LCM_HEADERS))
	@mkdir -p $$(@D)
	$$(call SAY,CC $$@)
	$$Q$$(COMPILER.$1) $$(COMMON) $$(FLAGS.$1) -c $$< -o $$@

$(BUILD)/$1/libjoulepath.a: $(CORE:%.c=$(BUILD)/$1/%.o) $(MEMBERS)
	$$(call archive)

$(BUILD)/$1/libcan.a: $(CAN:%.c=$(BUILD)/$1/%.o) $(MEMBERS)
	$$(call archive)

$(BUILD)/$1/lcm/%.o: $(BUILD)/lcm/%.h
	@mkdir -p $$(@D)
	$$Q$$(COMPILER.$1) $$(COMMON) $$(FLAGS.$1) -w -c $(BUILD)/lcm/$$*.c -o $$@

$(BUILD)/$1/libsim.a: $(SIM:%.c=$(BUILD)/$1/%.o) $(LCM_TYPES:%=$(BUILD)/$1/lcm/%.o) $(BUILD)/$1/robots.o $(MEMBERS)
	$$(call archive)

$(BUILD)/$1/robots.o: $(BUILD)/robots.c
	@mkdir -p $$(@D)
	$$Q$$(COMPILER.$1) $$(COMMON) $$(FLAGS.$1) -c $$< -o $$@

$(BUILD)/$1/unity.o: $(UNITY_SOURCE) $(SETTINGS)
	@mkdir -p $$(@D)
	$$Q$$(COMPILER.$1) $$(COMMON) $$(FLAGS.$1) -w -c $$< -o $$@
endef
$(foreach v,$(VARIANTS),$(eval $(call variant_rules,$v)))

# `q` keeps members of one name from two directories apart.
define archive
	@mkdir -p $(@D)
	@rm -f $@
	$Qar qcs $@ $(filter %.o,$^)
endef

define link_host
	@mkdir -p $(@D)
	$(call SAY,LD $@)
	$Q$(COMPILER.$1) $(FLAGS.$1) $(filter %.o,$^) $(filter %.a,$^) $(LIBRARIES) -o $@
endef

# Without the simulator's libraries, which a 32-bit host need not have.
define link_core
	@mkdir -p $(@D)
	$(call SAY,LD $@)
	$Q$(COMPILER.$1) $(FLAGS.$1) $(filter %.o,$^) $(filter %.a,$^) -lm -o $@
endef

define link_target
	@mkdir -p $(@D)
	$(call SAY,LD $@)
	$Q$(COMPILER.$1) $(FLAGS.$1) -nostartfiles --specs=nano.specs -Wl,--gc-sections -Ltests/target \
	    -T$(BOARD.$1).ld $(filter %.o,$^) $(filter %.a,$^) -o $@
endef

$(BUILD)/bin/%: $(BUILD)/host/sim/programs/%.o $(BUILD)/host/libsim.a $(BUILD)/host/libcan.a $(BUILD)/host/libjoulepath.a
	$(call link_host,host)

$(BUILD)/bench/bench_%: $(BUILD)/host/tests/bench/bench_%.o $(BUILD)/host/libsim.a $(BUILD)/host/libcan.a $(BUILD)/host/libjoulepath.a
	$(call link_host,host)

$(BUILD)/bench/target_planner: $(BUILD)/cortex-m7/tests/bench/target_planner.o $(TARGET_SUPPORT:%.c=$(BUILD)/cortex-m7/%.o) \
                               $(BUILD)/cortex-m7/sim/scene.o $(BUILD)/cortex-m7/libjoulepath.a
	$(call link_target,cortex-m7)

$(BUILD)/bench/bench_plan: $(BUILD)/host/tests/bench/plain_dijkstra.o

# Property tests at bench length, without the sanitizers.
$(BUILD)/bench/prop_%: $(BUILD)/host/tests/property/prop_%.o $(BUILD)/host/libsim.a $(BUILD)/host/libcan.a $(BUILD)/host/libjoulepath.a \
                       $(UNITY_SOURCE:%=$(BUILD)/host/unity.o)
	$(call link_host,host)

$(BUILD)/bench/target_%: $(BUILD)/cortex-m4/tests/bench/target_%.o $(TARGET_SUPPORT:%.c=$(BUILD)/cortex-m4/%.o) \
                         $(BUILD)/cortex-m4/libjoulepath.a
	$(call link_target,cortex-m4)

# All at once: they share a Python package.
$(LCM_HEADERS) &: $(LCM_TYPES:%=sim/lcm/%.lcm)
	@rm -rf $(BUILD)/lcm
	@mkdir -p $(BUILD)/lcm
	$Qlcm-gen --c --python --c-cpath $(BUILD)/lcm --c-hpath $(BUILD)/lcm --ppath $(BUILD)/lcm $^

$(BUILD)/robots.c: FORCE
	@mkdir -p $(@D)
	@{ echo '#include "sim/robots.h"'; \
	   for r in $(ROBOTS); do \
	       echo "extern const struct jp_robot_config jp_robot_$$r;"; \
	       echo "extern const struct jp_energy_model jp_energy_model_$$r;"; \
	   done; \
	   echo 'const struct robot_entry robots[] = {'; \
	   for r in $(ROBOTS); do echo "    {\"$$r\", &jp_robot_$$r, &jp_energy_model_$$r},"; done; \
	   echo '    {NULL, NULL, NULL},'; \
	   echo '};'; \
	   echo 'const size_t robot_count = sizeof robots / sizeof robots[0] - 1;'; \
	   for l in $(LATTICES); do echo "extern const struct jp_lattice jp_lattice_$$l;"; done; \
	   echo 'const struct jp_lattice *const lattices[] = {'; \
	   for l in $(LATTICES); do echo "    &jp_lattice_$$l,"; done; \
	   echo '    NULL,'; \
	   echo '};'; } >$@.new
	@if cmp -s $@.new $@; then rm $@.new; else mv $@.new $@; fi

.PHONY: FORCE
FORCE:

# ---- Use -------------------------------------------------------------------------------------------------------------

# Every core works unless make was called with -j.
PARALLEL = $(if $(filter -j% --jobserver%,$(MAKEFLAGS)),,-j$(JOBS)) --output-sync=target

# BUS=vcan or slcan: controller and robot are two programs on a bus.
DRIVE.      = $(BUILD)/bin/jp-mission $(SCENARIO) --output $(BUILD)/sil
DRIVE.slcan = tools/bus_mission.sh slcan $(SCENARIO) $(BUILD)/sil
DRIVE.vcan  = tools/with_vcan.sh -- tools/bus_mission.sh vcan $(SCENARIO) $(BUILD)/sil
BUS        ?=

.PHONY: sil
sil: ## drive the paper's mission (or SCENARIO=file) in the simulator, over BUS=vcan or slcan; report in build/sil
	$(if $(DRIVE.$(BUS)),,$(error BUS=$(BUS): must be vcan or slcan))
	@tools/setup.sh $(if $(filter vcan,$(BUS)),vcan,sil)
	@$(MAKE) $(PARALLEL) all
	@rm -rf $(BUILD)/sil
	$(DRIVE.$(BUS))
	$(PYTHON) tools/report.py $(BUILD)/sil
	$(if $(BUS),$(PYTHON) tools/show_frames.py $(BUILD)/sil/frames.log)

# The skid-steered robot plans unless another one is asked for. IMPORT holds options of tools/import_map.py, such as
# --cell-size 1 for a MovingAI map or a --window.
PLAN_ROBOT = $(if $(filter file,$(origin ROBOT)),zhang2018,$(ROBOT))
PLAN_TASK  = $(if $(START),--start=$(START)) $(if $(GOAL),--goal=$(GOAL))
MAP       ?= jacksboro

.PHONY: plan
plan: ## plan over a map (MAP=file START=x,y,deg GOAL=x,y ROBOT=name IMPORT=options) and write the report to build/plan
	@tools/setup.sh sil
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-plan
	@rm -rf $(BUILD)/plan
	$(PYTHON) tools/import_map.py $(MAP) $(BUILD)/plan/map.json --resolution 0.2 $(IMPORT)
	$(BUILD)/bin/jp-plan $(BUILD)/plan/map.json --robot sim/robots/$(PLAN_ROBOT).cfg $(PLAN_TASK) \
	    --output $(BUILD)/plan; status=$$?; \
	    [ $$status -le 1 ] && $(PYTHON) tools/plan_report.py $(BUILD)/plan && exit $$status

.PHONY: gains
gains: ## design the controller of ROBOT=name: sim/robots/name.cfg to src/tables/robot_name.c
	@tools/setup.sh sil
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-robot
	$(PYTHON) tools/gain_design.py --initial-energy $(ROBOT)

.PHONY: codec
codec: ## make the C codec of the CAN messages from hal/can/joulepath.dbc
	@tools/setup.sh sil
	$(PYTHON) tools/can_codec.py

.PHONY: identify
identify: ## identify the energy model of ROBOT=name in the simulator: src/tables/energy_name.c
	@tools/setup.sh sil
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-robot $(BUILD)/bin/jp-identify
	$(BUILD)/bin/jp-identify sim/robots/$(ROBOT).cfg --output $(BUILD)/identify/$(ROBOT)
	$(PYTHON) tools/identify.py $(ROBOT)

.PHONY: lattice
lattice: ## make the state lattice of ROBOT=name: src/tables/lattice_name.c
	@tools/setup.sh sil
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-lattice
	$(PYTHON) tools/lattice.py $(ROBOT)

# Maps of others, where they are. MovingAI cells become as large as lets the robot through and the map fit.
DATA ?= ../shared/data
MAPS := $(patsubst $(DATA)/%,$(BUILD)/maps/%.json,$(wildcard $(DATA)/*.map $(DATA)/*.yaml))

$(BUILD)/maps/Berlin_1_256.map.json: CELL_SIZE = 0.8
CELL_SIZE = 1

$(BUILD)/maps/%.map.json: $(DATA)/%.map tools/import_map.py
	$Q$(PYTHON) tools/import_map.py $< $@ --cell-size $(CELL_SIZE) --resolution 0.2

$(BUILD)/maps/%.yaml.json: $(DATA)/%.yaml tools/import_map.py
	$Q$(PYTHON) tools/import_map.py $< $@ --resolution 0.2

.PHONY: bench-plan
bench-plan: ## measure the planner on the 20 scenes and the maps in DATA=dir; tables in the README
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(BUILD)/bench/bench_plan $(MAPS)
	@mkdir -p $(BUILD)/bench-plan
	$(BUILD)/bench/bench_plan --rows $(BUILD)/bench-plan/rows.json $(MAPS) >$(BUILD)/bench/bench_plan.json
	$(PYTHON) tools/bench_plan.py $(BUILD)/bench-plan/rows.json

# One bench after the other, so that they do not share the cores.
.PHONY: figures
figures: ## run the benches and write their figures to build/figures.json and the README, with its picture
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) all $(BENCHES:%=$(BUILD)/bench/%) $(TARGET_BENCHES:%=$(BUILD)/bench/%) \
	    $(BUILD)/bench/prop_segment $(BUILD)/bench/prop_fixed $(BUILD)/bench/prop_planner \
	    $(BUILD)/host-gcc/prop_decoders
	@rm -f $(BUILD)/bench/*.json
	@$(MAKE) bench-plan
	@set -e; for b in $(BENCHES); do \
	    echo "  BENCH $$b"; $(BUILD)/bench/$$b >$(BUILD)/bench/$$b.json; done
	@set -e; for b in $(TARGET_BENCHES); do \
	    echo "  BENCH $$b"; \
	    case $$b in target_planner) run="$(RUN.cortex-m7)" ;; *) run="$(RUN.cortex-m4)" ;; esac; \
	    $$run $(BUILD)/bench/$$b >$(BUILD)/bench/$$b.json 2>&1 </dev/null; done
	$(BUILD)/bench/prop_segment --count 10000 --json $(BUILD)/bench/segment.json
	$(BUILD)/bench/prop_fixed --exhaustive --json $(BUILD)/bench/fixed.json
	$(BUILD)/bench/prop_planner --count 100000 --json $(BUILD)/bench/planner.json
	$(BUILD)/host-gcc/prop_decoders --count 100000000 --json $(BUILD)/bench/decoders.json
	$(PYTHON) tools/bench_bus.py
	$(PYTHON) tools/show_frames.py $(BUILD)/bus/vcan/frames.log --readme
	@rm -f $(BITS_LOGS)
	@$(MAKE) $(PARALLEL) $(BITS_LOGS)
	@printf '[{"name": "planner: same routes, costs and expansions on %s, of %d", "value": %d, "unit": "",\n  "bound": {"op": "==", "value": %d}, "command": "make figures"}]\n' \
	    "x86-64, -m32, Cortex-M4 and M7" $(words $(BITS_LOGS)) $$(grep -lx OK $(BITS_LOGS) | wc -l) $(words $(BITS_LOGS)) \
	    >$(BUILD)/bench/bits.json
	$(BUILD)/bin/jp-identify sim/robots/gao2018.cfg --output $(BUILD)/identify/gao2018
	$(PYTHON) tools/identify.py gao2018 --tables $(BUILD)/identify/gao2018 --bench $(BUILD)/bench/identify.json
	$(BUILD)/bin/jp-mission sim/scenarios/gao2018_mission.cfg --output $(BUILD)/figures
	$(PYTHON) tools/report.py $(BUILD)/figures
	cp $(BUILD)/figures/path.png sim/scenarios/gao2018_mission.png
	$(MAKE) plan
	cp $(BUILD)/plan/plan.png sim/scenarios/jacksboro_plan.png
	$(PYTHON) tools/figures.py

# ---- Tests -----------------------------------------------------------------------------------------------------------

# Seconds after which a run counts as failed.
UNIT_LIMIT   ?= 60
HOST_LIMIT   ?= 300
PYTEST_LIMIT ?= 900
GATE_LIMIT   ?= 600

LOGS := $(BUILD)/test
RUN  := tools/run_test.sh

# no_tests.log has no rule: a suite without a file fails.
names         = $(or $(notdir $(basename $1)),no_tests)
UNIT_LOGS     := $(foreach v,$(HOST_TESTS) $(TARGET_TESTS),$(patsubst %,$(LOGS)/$v/%.log,$(call names,$(UNIT_TESTS))))
PROPERTY_LOGS := $(patsubst %,$(LOGS)/host-gcc/%.log,$(call names,$(PROPERTY_TESTS)))
FAULT_LOGS    := $(patsubst %,$(LOGS)/host-gcc/%.log,$(call names,$(FAULT_TESTS)))
TARGET_LOGS   := $(LOGS)/cortex-m4/test_cycles.log
BITS_VARIANTS := host-gcc host-gcc-m32 cortex-m4 cortex-m7
BITS_LOGS     := $(foreach v,$(BITS_VARIANTS),$(patsubst %,$(LOGS)/$v/%.log,$(call names,$(BITS_TESTS))))
SIL_LOGS      := $(LOGS)/pytest/sil.xml
TOOLS_LOGS    := $(LOGS)/pytest/tools.xml
VCAN_LOGS     := $(LOGS)/pytest/vcan.xml $(LOGS)/pytest/vcan_results.xml
GATE_LOGS     := $(patsubst %,$(LOGS)/gates/%.log,symbols firmware compile includes format cppcheck tidy)
TEST_LOGS     := $(VCAN_LOGS) $(SIL_LOGS) $(TOOLS_LOGS) $(GATE_LOGS) $(PROPERTY_LOGS) $(FAULT_LOGS) $(BITS_LOGS) $(UNIT_LOGS) $(TARGET_LOGS)

EXPECTED = unit $(UNIT_LOGS) bits $(BITS_LOGS) property $(PROPERTY_LOGS) fault $(FAULT_LOGS) target $(TARGET_LOGS) \
           sil $(SIL_LOGS) vcan $(VCAN_LOGS) tools $(TOOLS_LOGS) gates $(GATE_LOGS)

.PHONY: test
test: ## build and run every test and gate; the last line counts them
	@tools/setup.sh test
	@rm -rf $(LOGS)
	@mkdir -p $(LOGS)
	@$(MAKE) -k $(PARALLEL) test_logs || true
	@$(PYTHON) tools/test_summary.py $(EXPECTED)

.PHONY: test_logs
test_logs: $(TEST_LOGS)

define host_test_rules
$(BUILD)/$1/test_%: $(BUILD)/$1/tests/unit/test_%.o $(if $(UNITY_SOURCE),$(BUILD)/$1/unity.o) $(BUILD)/$1/libcan.a $(BUILD)/$1/libjoulepath.a
	$$(call link_core,$1)

$(LOGS)/$1/test_%.log: $(BUILD)/$1/test_%
	$$(call SAY,RUN $$<)
	$$Q$(RUN) $$@ $(UNIT_LIMIT) $$<
endef
$(foreach v,$(HOST_TESTS),$(eval $(call host_test_rules,$v)))

define target_test_rules
$(BUILD)/$1/test_%: $(BUILD)/$1/tests/unit/test_%.o $(TARGET_SUPPORT:%.c=$(BUILD)/$1/%.o) \
                    $(if $(UNITY_SOURCE),$(BUILD)/$1/unity.o) $(BUILD)/$1/libcan.a $(BUILD)/$1/libjoulepath.a \
                    tests/target/$(BOARD.$1).ld
	$$(call link_target,$1)

$(LOGS)/$1/test_%.log: $(BUILD)/$1/test_%
	$$(call SAY,RUN $$<)
	$$Q$(RUN) $$@ $(UNIT_LIMIT) $(RUN.$1) $$<
endef
$(foreach v,$(TARGET_TESTS),$(eval $(call target_test_rules,$v)))

$(BUILD)/cortex-m4/test_cycles: $(BUILD)/cortex-m4/tests/target/test_cycles.o $(TARGET_SUPPORT:%.c=$(BUILD)/cortex-m4/%.o) \
                                $(if $(UNITY_SOURCE),$(BUILD)/cortex-m4/unity.o) tests/target/mps2-an386.ld
	$(call link_target,cortex-m4)

# Equal bits on every core; with scenes, which are integers only.
define bits_rules
$(BUILD)/$1/test_%_bits: $(BUILD)/$1/tests/bits/test_%_bits.o $(BUILD)/$1/sim/scene.o \
                         $(if $(filter cortex%,$1),$(TARGET_SUPPORT:%.c=$(BUILD)/$1/%.o)) \
                         $(if $(UNITY_SOURCE),$(BUILD)/$1/unity.o) $(BUILD)/$1/libjoulepath.a
	$$(call $(if $(filter cortex%,$1),link_target,link_core),$1)
endef
$(foreach v,$(BITS_VARIANTS),$(eval $(call bits_rules,$v)))

HOST_TEST_PARTS := $(if $(UNITY_SOURCE),$(BUILD)/host-gcc/unity.o) $(BUILD)/host-gcc/libsim.a $(BUILD)/host-gcc/libcan.a $(BUILD)/host-gcc/libjoulepath.a

$(BUILD)/host-gcc/prop_%: $(BUILD)/host-gcc/tests/property/prop_%.o $(HOST_TEST_PARTS)
	$(call link_host,host-gcc)

$(BUILD)/host-gcc/fault_%: $(BUILD)/host-gcc/tests/fault/fault_%.o $(HOST_TEST_PARTS)
	$(call link_host,host-gcc)

$(LOGS)/host-gcc/prop_%.log: $(BUILD)/host-gcc/prop_%
	$(call SAY,RUN $<)
	$Q$(RUN) $@ $(HOST_LIMIT) $<

$(LOGS)/host-gcc/fault_%.log: $(BUILD)/host-gcc/fault_%
	$(call SAY,RUN $<)
	$Q$(RUN) $@ $(HOST_LIMIT) $<

$(LOGS)/pytest/%.xml: $(PROGRAMS)
	$(call SAY,RUN pytest tests/$*)
	$Q$(RUN) $(@:.xml=.log) $(PYTEST_LIMIT) $(PYTHON) -m pytest -q -n $(JOBS) -p no:cacheprovider --junitxml=$@ tests/$*

$(BUILD)/host-gcc/vcan_%: $(BUILD)/host-gcc/tests/vcan/vcan_%.o $(HOST_TEST_PARTS)
	$(call link_host,host-gcc)

# All in one emulated kernel: it takes a while to boot. What is slow in it comes after it.
$(LOGS)/pytest/vcan.xml: $(PROGRAMS) $(patsubst %,$(BUILD)/host-gcc/%,$(call names,$(VCAN_TESTS)))
	$(call SAY,RUN pytest tests/vcan)
	$Q$(RUN) $(@:.xml=.log) $(PYTEST_LIMIT) tools/with_vcan.sh --interfaces 2 -- \
	    $(PYTHON) -m pytest -q -p no:cacheprovider --junitxml=$@ tests/vcan/test_vcan.py

$(LOGS)/pytest/vcan_results.xml: $(LOGS)/pytest/vcan.xml
	$(call SAY,RUN pytest tests/vcan/test_vcan_results.py)
	$Q$(RUN) $(@:.xml=.log) $(PYTEST_LIMIT) $(PYTHON) -m pytest -q -p no:cacheprovider --junitxml=$@ \
	    tests/vcan/test_vcan_results.py

GATE_LIBRARIES := $(foreach v,cortex-m4 cortex-m4-os cortex-m0 cortex-m0-o2,$(BUILD)/$v/libjoulepath.a $(BUILD)/$v/libcan.a)
GATE_IMAGES    := $(BUILD)/cortex-m4/test_ecu $(BUILD)/cortex-m0/test_ecu
export GATE_CFLAGS := -std=c11 $(WARNINGS) -Iinclude -I. -Itests/unity -Itests/target -isystem $(BUILD)/lcm $(HOST)

$(LOGS)/gates/symbols.log: $(GATE_LIBRARIES)
	$(call SAY,RUN gate symbols)
	$Q$(RUN) $@ $(GATE_LIMIT) tests/gates/symbols.sh $(GATE_LIBRARIES)

$(LOGS)/gates/firmware.log: $(GATE_IMAGES)
	$(call SAY,RUN gate firmware)
	$Q$(RUN) $@ $(GATE_LIMIT) tests/gates/firmware.sh $(GATE_IMAGES)

$(LOGS)/gates/%.log: tests/gates/%.sh | $(LCM_HEADERS)
	$(call SAY,RUN gate $*)
	$Q$(RUN) $@ $(GATE_LIMIT) $<

# ---- Upkeep ----------------------------------------------------------------------------------------------------------

.PHONY: size
size: $(foreach v,cortex-m4 cortex-m0,$(BUILD)/$v/libjoulepath.a) ## flash and RAM of each module on Cortex-M4 and M0
	@for l in $^; do echo "$$l"; arm-none-eabi-size -t "$$l"; done

.PHONY: format
format: ## format the C sources
	find include src hal sim tests -name '*.[ch]' -exec $(CLANG_FORMAT) -i {} +

.PHONY: clean
clean: ## remove build/
	rm -rf $(BUILD)

-include $(shell [ -d $(BUILD) ] && find $(BUILD) -name '*.d')
