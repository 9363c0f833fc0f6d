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
export JP_SETUP JOBS PYTHON CLANG_FORMAT CLANG_TIDY
export JP_BUILD := $(abspath $(BUILD))

# ---- Settings: what each variant is compiled with -------------------------------------------------------------------

# Contraction is off, and on 32 bits SSE computes, so that the host programs give the same numbers under every compiler.
WARNINGS := -Wall -Wextra -Wconversion -Wshadow -Werror
COMMON   := -std=c11 -g $(WARNINGS) -Iinclude -I. -I$(UNITY) -isystem $(BUILD)/lcm -MMD -MP
HOST     := -D_GNU_SOURCE -ffp-contract=off -DUNITY_INCLUDE_DOUBLE -DUNITY_SUPPORT_64
SANITIZE := -O1 -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=all
TARGET   := -ffunction-sections -fdata-sections -fcallgraph-info=su -Itests/target -DUNITY_INCLUDE_CONFIG_H -DUNITY_SUPPORT_64
ARM      := $(TARGET) -mthumb
M4F      := -mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16
M7F      := -mcpu=cortex-m7 -mfloat-abi=hard -mfpu=fpv5-sp-d16
SSE      := -msse2 -mfpmath=sse
RV32     := $(TARGET) -march=rv32imac -mabi=ilp32 --specs=picolibc.specs

HOST_TESTS   := host-gcc host-clang host-gcc-m32 host-clang-m32
TARGET_TESTS := cortex-m0 cortex-m3 cortex-m4 cortex-m4-nodsp cortex-m7 rv32
ARM_VARIANTS := $(filter cortex%,$(TARGET_TESTS)) cortex-m0-o2 cortex-m3-os cortex-m4-os cortex-m7-os
RV_VARIANTS  := rv32 rv32-os
VARIANTS     := host host-coverage release firmware $(HOST_TESTS) $(ARM_VARIANTS) $(RV_VARIANTS)

# Each core's builds for speed and for size.
CORES            := cortex-m0 cortex-m3 cortex-m4 cortex-m7 rv32
SPEED_cortex-m0  := cortex-m0-o2
SIZE_cortex-m0   := cortex-m0
SPEED_VARIANTS   := $(foreach c,$(CORES),$(or $(SPEED_$c),$c))
SIZE_VARIANTS    := $(foreach c,$(CORES),$(or $(SIZE_$c),$c-os))

# Where the float library is: on the hosts and on the cores with an FPU.
FPU_CORES        := cortex-m4 cortex-m7
FLOAT_VARIANTS   := host host-coverage release $(HOST_TESTS) $(FPU_CORES) $(FPU_CORES:%=%-os)

COMPILER.host            = $(CC)
COMPILER.release         = $(CC)
COMPILER.firmware        = arm-none-eabi-gcc
COMPILER.host-coverage   = gcc
COMPILER.host-gcc        = gcc
COMPILER.host-clang      = clang
COMPILER.host-gcc-m32    = gcc -m32
COMPILER.host-clang-m32  = clang -m32
$(foreach v,$(ARM_VARIANTS),$(eval COMPILER.$v = arm-none-eabi-gcc))
$(foreach v,$(RV_VARIANTS),$(eval COMPILER.$v = riscv64-unknown-elf-gcc))

FLAGS.host            = $(HOST) -O2
# For others: a newer compiler's warnings must not stop an installation.
FLAGS.release         = -O2 -Wno-error -ffunction-sections -fdata-sections
# The core has no floating point, so interrupts need not save its registers.
FLAGS.firmware        = -mthumb -mcpu=cortex-m4 -O2 -ffunction-sections -fdata-sections -fcallgraph-info=su
FLAGS.host-coverage   = $(HOST) -O0 --coverage
FLAGS.host-gcc        = $(HOST) $(SANITIZE) -O2
FLAGS.host-clang      = $(HOST) $(SANITIZE)
FLAGS.host-gcc-m32    = $(HOST) $(SANITIZE) $(SSE)
FLAGS.host-clang-m32  = $(HOST) $(SANITIZE) $(SSE)
FLAGS.cortex-m0       = $(ARM) -mcpu=cortex-m0 -Os
FLAGS.cortex-m0-o2    = $(ARM) -mcpu=cortex-m0 -O2
FLAGS.cortex-m3       = $(ARM) -mcpu=cortex-m3 -O2
FLAGS.cortex-m3-os    = $(ARM) -mcpu=cortex-m3 -Os
FLAGS.cortex-m4       = $(ARM) $(M4F) -O2
FLAGS.cortex-m4-nodsp = $(ARM) $(M4F) -O2 -DJP_NO_DSP
FLAGS.cortex-m4-os    = $(ARM) $(M4F) -Os
FLAGS.cortex-m7       = $(ARM) $(M7F) -O2
FLAGS.cortex-m7-os    = $(ARM) $(M7F) -Os
FLAGS.rv32            = $(RV32) -O2
FLAGS.rv32-os         = $(RV32) -Os

# A square root is one instruction, and nothing is computed in double by mistake.
FLAGS_FLOAT = -ffp-contract=off -fno-math-errno -Wdouble-promotion

# Cortex-M4 executes the code of Cortex-M0, and its board has more memory than the micro:bit.
BOARD.cortex-m0       = arm/microbit
BOARD.cortex-m0-o2    = arm/mps2-an386
BOARD.cortex-m3       = arm/mps2-an385
BOARD.cortex-m3-os    = $(BOARD.cortex-m3)
BOARD.cortex-m4       = arm/mps2-an386
BOARD.cortex-m4-nodsp = $(BOARD.cortex-m4)
BOARD.cortex-m4-os    = $(BOARD.cortex-m4)
BOARD.cortex-m7       = arm/mps2-an500
BOARD.cortex-m7-os    = $(BOARD.cortex-m7)
BOARD.rv32            = riscv/virt
BOARD.rv32-os         = $(BOARD.rv32)

# A count of instructions needs a clock that counts them; the micro:bit has no use for it.
RUN.cortex-m0       = qemu-system-arm -M microbit $(SEMIHOSTING)
RUN.cortex-m0-o2    = $(RUN.cortex-m4)
RUN.cortex-m3       = qemu-system-arm -M mps2-an385 -icount shift=0 $(SEMIHOSTING)
RUN.cortex-m4       = qemu-system-arm -M mps2-an386 -icount shift=0 $(SEMIHOSTING)
RUN.cortex-m4-nodsp = $(RUN.cortex-m4)
RUN.cortex-m7       = qemu-system-arm -M mps2-an500 -icount shift=0 $(SEMIHOSTING)
RUN.rv32            = qemu-system-riscv32 -M virt -bios none -icount shift=0 $(SEMIHOSTING)
SEMIHOSTING         = -nographic -semihosting-config enable=on,target=native -kernel

# ---- Sources ---------------------------------------------------------------------------------------------------------

CORE           := $(wildcard src/*.c src/tables/*.c)
FLOAT          := $(wildcard src/float/*.c src/float/tables/*.c)
CAN            := $(wildcard hal/*.c hal/can/*.c)
STM32F4        := $(wildcard hal/stm32f4/*.c)
# What needs nothing of the core but registers, which a test can stand in for.
DRIVERS        := $(filter-out $(addprefix hal/stm32f4/,startup.c cortex_m.c fault.c main.c),$(STM32F4))
SIM            := $(wildcard sim/*.c hal/sim/*.c hal/linux/*.c)
PROGRAMS       := $(patsubst sim/programs/%.c,$(BUILD)/bin/%,$(wildcard sim/programs/jp-*.c))
BENCHES        := $(filter-out bench_plan bench_patrol bench_pursuit,$(patsubst tests/bench/%.c,%,$(wildcard tests/bench/bench_*.c)))
TARGET_BENCHES := $(patsubst tests/bench/%.c,%,$(wildcard tests/bench/target_*.c))
FLOAT_BENCHES  := $(filter target_teb target_route,$(TARGET_BENCHES))

# lcm-gen makes them from sim/lcm/.
LCM_TYPES      := $(patsubst sim/lcm/%.lcm,%,$(wildcard sim/lcm/*.lcm))
LCM_HEADERS    := $(LCM_TYPES:%=$(BUILD)/lcm/%.h)

# A robot is built in when both of its tables are there.
NAMES          := $(patsubst src/tables/robot_%.c,%,$(wildcard src/tables/robot_*.c))
ROBOTS         := $(foreach n,$(NAMES),$(if $(wildcard src/tables/energy_$n.c),$n))
BATTERY_MODELS := $(foreach n,$(ROBOTS),$(if $(wildcard src/tables/energy_$n_battery.c),$n_battery))
PILOT_TABLES   := $(patsubst src/tables/%.c,%,$(wildcard src/tables/horizon_*.c src/tables/learning_*.c))
LATTICES       := $(patsubst src/tables/lattice_%.c,%,$(wildcard src/tables/lattice_*.c))

UNIT_TESTS     := $(wildcard tests/unit/test_*.c)
PROPERTY_TESTS := $(wildcard tests/property/prop_*.c)
FLOAT_TESTS    := $(wildcard tests/float/test_*.c)
BITS_TESTS     := $(wildcard tests/bits/test_*.c)
FAULT_TESTS    := $(wildcard tests/fault/fault_*.c)
VCAN_TESTS     := $(wildcard tests/vcan/vcan_*.c)
TARGET_SUPPORT := tests/target/start.c tests/target/console.c

# With the real Unity its one source file joins each test, and the self-test of our header is left out.
UNITY_SOURCE := $(wildcard $(UNITY)/unity.c)
ifneq ($(UNITY_SOURCE),)
UNIT_TESTS := $(filter-out tests/unit/test_unity.c,$(UNIT_TESTS))
endif

# support VARIANT: the objects that a program on a target stands on.
support = $(patsubst %.c,$(BUILD)/$1/%.o,$(TARGET_SUPPORT) \
          $(addprefix tests/target/$(dir $(BOARD.$1)),core.c semihosting.c cycles.c))

# float_library VARIANT: where it has one.
float_library = $(if $(filter $1,$(FLOAT_VARIANTS)),$(BUILD)/$1/libjoulepath_float.a)

# host_libraries VARIANT: each before what it stands on.
host_libraries = $(addprefix $(BUILD)/$1/,libsim.a libcan.a libjoulepath_float.a libjoulepath.a)

LIBRARIES = $(shell pkg-config --libs libconfig jansson nlopt ccd) -llcm -lm -lpthread

# ---- Programs --------------------------------------------------------------------------------------------------------

V ?= 0
ifeq ($(V),0)
Q := @
SAY = @echo '  $1'
endif

.PHONY: help
help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' Makefile | expand -t 14

.PHONY: all
all: $(PROGRAMS) $(call host_libraries,host) ## build the host programs in build/bin and the libraries

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
	@mkdir -p $(@D) && echo '$(CORE) $(FLOAT) $(CAN) $(DRIVERS) $(SIM)' | cmp -s - $@ || echo '$(CORE) $(FLOAT) $(CAN) $(DRIVERS) $(SIM)' >$@

# core_name VARIANT: as people write it.
core_name = $(patsubst rv%,RV%,$(patsubst cortex-m%,Cortex-M%,$(firstword $(subst -o, ,$1))))

define variant_rules
$(BUILD)/$1/%.o: %.c Makefile $(SETTINGS) $(if $(filter host%,$1),| $(LCM_HEADERS))
	@mkdir -p $$(@D)
	$$(call SAY,CC $$@)
	$$Q$$(COMPILER.$1) $$(COMMON) $$(FLAGS.$1) $$(MODULE_FLAGS) $(if $(BOARD.$1),-DTARGET_CORE='"$(call core_name,$1)"') -c $$< -o $$@

$(BUILD)/$1/src/float/%.o $(BUILD)/$1/tests/float/%.o: MODULE_FLAGS = $(FLAGS_FLOAT)

$(BUILD)/$1/libjoulepath_float.a: $(FLOAT:%.c=$(BUILD)/$1/%.o) $(MEMBERS)
	$$(call archive)

$(BUILD)/$1/libjoulepath.a: $(CORE:%.c=$(BUILD)/$1/%.o) $(MEMBERS)
	$$(call archive)

$(BUILD)/$1/libcan.a: $(CAN:%.c=$(BUILD)/$1/%.o) $(MEMBERS)
	$$(call archive)

# On fake registers: first, because one of them also stands in for wait.c.
$(BUILD)/$1/libdrivers.a: $(BUILD)/$1/tests/unit/stm32_fake.o $(DRIVERS:%.c=$(BUILD)/$1/%.o) $(MEMBERS)
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
	$Q$(COMPILER.$1) $(FLAGS.$1) -nostartfiles $(if $(filter cortex%,$1),--specs=nano.specs) -Wl,--gc-sections \
	    -Ltests/target -Ttests/target/$(BOARD.$1).ld $(filter %.o,$^) $(filter %.a,$^) -o $@
endef

$(BUILD)/bin/%: $(BUILD)/host/sim/programs/%.o $(call host_libraries,host)
	$(call link_host,host)

$(BUILD)/bench/bench_%: $(BUILD)/host/tests/bench/bench_%.o $(call host_libraries,host)
	$(call link_host,host)

$(BUILD)/bench/bench_plan: $(BUILD)/host/tests/bench/plain_dijkstra.o

# Property tests at bench length, without the sanitizers.
$(BUILD)/bench/prop_%: $(BUILD)/host/tests/property/prop_%.o $(call host_libraries,host) $(UNITY_SOURCE:%=$(BUILD)/host/unity.o)
	$(call link_host,host)

# What is measured on each core: sizes in the builds for size, instructions in those for speed, and of the stack the worst
# of both.
SIZE_IMAGES  := $(SIZE_VARIANTS:%=$(BUILD)/%/whole)
STACK_IMAGES := $(SIZE_IMAGES) $(SPEED_VARIANTS:%=$(BUILD)/%/whole) $(BUILD)/firmware/whole
CYCLES       := $(foreach b,$(filter-out $(FLOAT_BENCHES),$(TARGET_BENCHES)),$(SPEED_VARIANTS:%=$(BUILD)/bench/$b-%.json)) \
                $(foreach b,$(FLOAT_BENCHES),$(FPU_CORES:%=$(BUILD)/bench/$b-%.json))

define target_bench_rules
$(BUILD)/$1/target_%: $(BUILD)/$1/tests/bench/target_%.o $(call support,$1) $(BUILD)/$1/sim/scene.o $(BUILD)/$1/libdrivers.a \
                      $(BUILD)/$1/libcan.a $(call float_library,$1) $(BUILD)/$1/libjoulepath.a
	$$(call link_target,$1)

$(BUILD)/bench/target_%-$1.json: $(BUILD)/$1/target_%
	@mkdir -p $$(@D)
	$$(call SAY,BENCH $$<)
	$$Q$(RUN.$1) $$< >$$@ 2>&1 </dev/null
endef
$(foreach v,$(SPEED_VARIANTS),$(eval $(call target_bench_rules,$v)))

# The image for the STM32F405: of all objects only main.o knows the robot.
define firmware_rules
$(BUILD)/firmware/$1/main.o: hal/stm32f4/main.c Makefile $(SETTINGS)
	@mkdir -p $$(@D)
	$$(call SAY,CC $$@)
	$$Q$(COMPILER.firmware) $(COMMON) $(FLAGS.firmware) -DFIRMWARE_ROBOT_NAME=$1 $(if $(filter learning_$1,$(PILOT_TABLES)),-DFIRMWARE_LEARNS) -c $$< -o $$@

$(BUILD)/firmware/$1/joulepath.elf: $(BUILD)/firmware/$1/main.o $(patsubst %.c,$(BUILD)/firmware/%.o,$(filter-out %/main.c,$(STM32F4))) \
                                    $(BUILD)/firmware/libcan.a $(BUILD)/firmware/libjoulepath.a $(wildcard hal/stm32f4/*.ld)
	$$(call link_firmware)

$(BUILD)/firmware/$1/joulepath.bin: $(BUILD)/firmware/$1/joulepath.elf
	$$Qarm-none-eabi-objcopy -O binary $$< $$@
endef
$(foreach r,$(ROBOTS),$(eval $(call firmware_rules,$r)))

define link_firmware
	@mkdir -p $(@D)
	$(call SAY,LD $@)
	$Q$(COMPILER.firmware) $(FLAGS.firmware) -nostartfiles --specs=nano.specs -Wl,--gc-sections -Wl,--fatal-warnings \
	    -Wl,-Map=$@.map -Lhal/stm32f4 -Tstm32f405.ld $(filter %.o,$^) $(filter %.a,$^) -o $@
endef

# All at once: they share a Python package.
$(LCM_HEADERS) &: $(LCM_TYPES:%=sim/lcm/%.lcm)
	@rm -rf $(BUILD)/lcm
	@mkdir -p $(BUILD)/lcm
	$Qlcm-gen --c --python --c-cpath $(BUILD)/lcm --c-hpath $(BUILD)/lcm --ppath $(BUILD)/lcm $^

# battery_model ROBOT: its model of the battery's energy, when it is identified.
battery_model = $(if $(filter $1_battery,$(BATTERY_MODELS)),&jp_energy_model_$1_battery,NULL)
# pilot_tables ROBOT: horizon and learning, of the motors and of the battery, each when there is one.
pilot_tables  = $(foreach t,horizon_$1 learning_$1 horizon_$1_battery learning_$1_battery,$(if $(filter $t,$(PILOT_TABLES)),&jp_$t,NULL)$(comma))
comma        := ,

$(BUILD)/robots.c: FORCE
	@mkdir -p $(@D)
	@{ echo '#include "sim/robots.h"'; \
	   for r in $(ROBOTS); do echo "extern const struct jp_robot_config jp_robot_$$r;"; done; \
	   for m in $(ROBOTS) $(BATTERY_MODELS); do echo "extern const struct jp_energy_model jp_energy_model_$$m;"; done; \
	   for t in $(patsubst learning_%,learning:%,$(patsubst horizon_%,horizon:%,$(PILOT_TABLES))); do \
	       echo "extern const struct jp_$${t%%:*} jp_$${t%%:*}_$${t#*:};"; \
	   done; \
	   echo 'const struct robot_entry robots[] = {'; \
	   $(foreach r,$(ROBOTS),echo '    {"$r", &jp_robot_$r, &jp_energy_model_$r, $(call battery_model,$r), $(call pilot_tables,$r)},';) \
	   echo '    {.name = NULL},'; \
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

# BUS=vcan or slcan: controller and robot are two programs on a bus; pil: the controller is the image in QEMU.
DRIVE.      = $(BUILD)/bin/jp-mission $(SCENARIO) --output $(BUILD)/sil
DRIVE.slcan = tools/bus_mission.sh slcan $(SCENARIO) $(BUILD)/sil
DRIVE.pil   = tools/bus_mission.sh pil $(SCENARIO) $(BUILD)/sil
DRIVE.vcan  = tools/with_vcan.sh -- tools/bus_mission.sh vcan $(SCENARIO) $(BUILD)/sil
BUS        ?=

SETUP.vcan = vcan
SETUP.pil  = firmware
SCENARIO_ROBOT = $(shell sed -n 's/^robot *= *"\(.*\/\)\?\([^"/]*\)\.cfg".*/\2/p' $(SCENARIO))

.PHONY: sil
sil: ## drive the paper's mission (or SCENARIO=file) in the simulator, over BUS=vcan, slcan or pil; report in build/sil
	$(if $(DRIVE.$(BUS)),,$(error BUS=$(BUS): must be vcan, slcan or pil))
	@tools/setup.sh $(or $(SETUP.$(BUS)),sil)
	@$(MAKE) $(PARALLEL) all $(if $(filter pil,$(BUS)),$(BUILD)/firmware/$(SCENARIO_ROBOT)/joulepath.elf)
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

# A scene from a seed, or a map of others with START and GOAL.
SCENE      ?= beside-obstacle
SEED       ?= 1
PATROL_MAP  = $(if $(filter file,$(origin MAP)),,$(MAP))

.PHONY: patrol
patrol: ## drive the patrol robot (SCENE=name SEED=1, or MAP=file START=x,y,deg GOAL=x,y,deg); report in build/patrol
	@tools/setup.sh sil
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-patrol
	@rm -rf $(BUILD)/patrol
	$(if $(PATROL_MAP),$(PYTHON) tools/import_map.py $(MAP) $(BUILD)/patrol/map.json --resolution 0.05 $(IMPORT))
	$(BUILD)/bin/jp-patrol $(if $(PATROL_MAP),--map=$(BUILD)/patrol/map.json $(PLAN_TASK),$(SCENE)) --seed=$(SEED) \
	    --output $(BUILD)/patrol; status=$$?; \
	    [ $$status -le 1 ] && $(PYTHON) tools/patrol_report.py $(BUILD)/patrol && exit $$status

# The courier unless another one is asked for. CAMPAIGN holds options of tools/campaign.py, such as
# --faults or --fresh.
CAMPAIGN_ROBOT = $(if $(filter file,$(origin ROBOT)),courier24,$(ROBOT))
MISSIONS      ?= 1000

.PHONY: campaign
campaign: ## run MISSIONS=1000 varied missions of ROBOT=courier24 (SEED=1 SCHEDULER=tcp://host:port CAMPAIGN=options)
	@tools/setup.sh sil
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-trip
	$(PYTHON) tools/campaign.py $(CAMPAIGN_ROBOT) --missions $(MISSIONS) --seed $(SEED) \
	    $(if $(SCHEDULER),--scheduler $(SCHEDULER)) $(CAMPAIGN)

.PHONY: firmware
firmware: ## build the image for the STM32F405 with ROBOT=name: ELF, bin and map in build/firmware/name
	$(if $(filter $(ROBOT),$(ROBOTS)),,$(error ROBOT=$(ROBOT): must be one of $(ROBOTS)))
	@tools/setup.sh firmware
	@$(MAKE) $(PARALLEL) $(BUILD)/firmware/$(ROBOT)/joulepath.bin
	@arm-none-eabi-size $(BUILD)/firmware/$(ROBOT)/joulepath.elf
	@echo 'flash it: st-flash write $(BUILD)/firmware/$(ROBOT)/joulepath.bin 0x08000000'

.PHONY: gains
gains: ## design the controller of ROBOT=name: sim/robots/name.cfg to src/tables/robot_name.c
	@tools/setup.sh sil
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-robot
	$(PYTHON) tools/gain_design.py --initial-energy $(ROBOT)

.PHONY: horizon
horizon: ## make the tables of the transients of ROBOT=name: src/tables/horizon_name.c and horizon_name_battery.c
	@tools/setup.sh sil
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-robot
	$(PYTHON) tools/horizon.py $(ROBOT)

.PHONY: codec
codec: ## make the C codec of the CAN messages from hal/can/joulepath.dbc
	@tools/setup.sh sil
	$(PYTHON) tools/can_codec.py

# experiments ROBOT ENERGY FOLDER
experiments = $(BUILD)/bin/jp-identify sim/robots/$1.cfg --energy $2 --output $(BUILD)/identify/$3

.PHONY: identify
identify: ## identify the energy models of ROBOT=name in the simulator: src/tables/energy_name.c and energy_name_battery.c
	@tools/setup.sh sil
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-robot $(BUILD)/bin/jp-identify
	$(call experiments,$(ROBOT),motor,$(ROBOT))
	$(PYTHON) tools/identify.py $(ROBOT)
	$(call experiments,$(ROBOT),battery,$(ROBOT)_battery)
	$(PYTHON) tools/identify.py $(ROBOT) --energy battery

.PHONY: learning
learning: ## make what ROBOT=name can learn of its energy: src/tables/learning_name.c and learning_name_battery.c
	@tools/setup.sh sil
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-robot
	$(PYTHON) tools/learning.py $(ROBOT)

.PHONY: lattice
lattice: ## make the state lattice of ROBOT=name: src/tables/lattice_name.c
	@tools/setup.sh sil
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-lattice
	$(PYTHON) tools/lattice.py $(ROBOT)

PATROL_ROBOT = $(if $(filter file,$(origin ROBOT)),patrol,$(ROBOT))

.PHONY: patrol-config
patrol-config: ## make the C tables of the patrol robot's controller (ROBOT=patrol): src/float/tables/patrol_name.c
	@tools/setup.sh sil
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-patrol-config
	$(PYTHON) tools/patrol_table.py $(PATROL_ROBOT)

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

.PHONY: bench-patrol
bench-patrol: ## measure the patrol robot on its scenes and pure pursuit on paths; tables in the README
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(BUILD)/bench/bench_patrol $(BUILD)/bench/bench_pursuit
	@mkdir -p $(BUILD)/bench-patrol
	$(BUILD)/bench/bench_patrol --rows $(BUILD)/bench-patrol/scenes.json >$(BUILD)/bench/bench_patrol.json
	$(BUILD)/bench/bench_pursuit --rows $(BUILD)/bench-patrol/courses.json >$(BUILD)/bench/bench_pursuit.json
	$(PYTHON) tools/bench_patrol.py $(BUILD)/bench-patrol/scenes.json $(BUILD)/bench-patrol/courses.json

# The maps of others are left out where they are not.
ARGS.bench_grid = $(if $(wildcard $(DATA)/*.map),--data $(DATA))

# Property tests at bench length.
PROPERTIES := battery fixed four_wheel four_wheel_plant grid_planner horizon planner pure_pursuit scan_match segment store teb
ARGS.battery          = --count 100000000
ARGS.fixed            = --exhaustive
ARGS.four_wheel       = --count 1000000
ARGS.four_wheel_plant = --count 1000
ARGS.grid_planner     = --count 4000
ARGS.horizon          = --count 1000
ARGS.planner          = --count 100000
ARGS.pure_pursuit     = --count 400
ARGS.scan_match       = --count 40
ARGS.segment          = --count 10000
ARGS.store            = --count 10000
ARGS.teb              = --count 500

# One bench after the other, so that they do not share the cores.
.PHONY: figures
figures: ## run the benches and write their figures to build/figures.json and the README, with its picture
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) all $(BENCHES:%=$(BUILD)/bench/%) \
	    $(BUILD)/firmware/gao2018/joulepath.elf $(PROPERTIES:%=$(BUILD)/bench/prop_%) $(BUILD)/host-gcc/prop_decoders
	@rm -f $(BUILD)/bench/*.json
	@$(MAKE) bench-plan
	@$(MAKE) bench-patrol
	@$(MAKE) coverage
	@set -e; $(foreach b,$(BENCHES),echo '  BENCH $b'; $(BUILD)/bench/$b $(ARGS.$b) >$(BUILD)/bench/$b.json;)
	@$(MAKE) size stack cycles test-targets
	@set -e; $(foreach p,$(PROPERTIES),echo '  BENCH prop_$p'; $(BUILD)/bench/prop_$p $(ARGS.$p) --json $(BUILD)/bench/$p.json;)
	$(BUILD)/host-gcc/prop_decoders --count 100000000 --json $(BUILD)/bench/decoders.json
	$(PYTHON) tools/bench_route.py
	$(PYTHON) tools/bench_bus.py
	$(PYTHON) tools/show_frames.py $(BUILD)/bus/vcan/frames.log --readme
	@rm -f $(BITS_LOGS)
	@$(MAKE) $(PARALLEL) $(BITS_LOGS)
	@printf '[{"name": "planner and grid planner: same routes, costs and expansions on %s, of %d", "value": %d, "unit": "",\n  "bound": {"op": "==", "value": %d}, "command": "make figures"}]\n' \
	    "x86-64, -m32 and five cores" $(words $(BITS_LOGS)) $$(grep -lx OK $(BITS_LOGS) | wc -l) $(words $(BITS_LOGS)) \
	    >$(BUILD)/bench/bits.json
	$(call experiments,gao2018,motor,gao2018)
	$(PYTHON) tools/identify.py gao2018 --tables $(BUILD)/identify/gao2018 --bench $(BUILD)/bench/identify.json
	$(call experiments,gao2018,battery,gao2018_battery)
	$(PYTHON) tools/identify.py gao2018 --energy battery --tables $(BUILD)/identify/gao2018_battery \
	    --bench $(BUILD)/bench/identify_battery.json
	$(BUILD)/bin/jp-mission sim/scenarios/gao2018_mission.cfg --output $(BUILD)/figures
	$(PYTHON) tools/report.py $(BUILD)/figures
	cp $(BUILD)/figures/path.png sim/scenarios/gao2018_mission.png
	$(MAKE) plan
	cp $(BUILD)/plan/plan.png sim/scenarios/jacksboro_plan.png
	$(MAKE) patrol SCENE=warehouse
	cp $(BUILD)/patrol/patrol.png sim/scenarios/patrol_warehouse.png
	$(MAKE) campaign ROBOT=courier24 SEED=1 MISSIONS=1000 CAMPAIGN='--fresh --bench $(BUILD)/bench/campaign.json'
	cp $(BUILD)/campaign/courier24/campaign.png sim/scenarios/courier24_campaign.png
	$(PYTHON) tools/figures.py

# The library for programs on this machine. A packager stages it with DESTDIR.
PREFIX  ?= /usr/local
DESTDIR ?=
VERSION  = $(shell sed -n 's/^\#define JP_VERSION_[A-Z]* *//p' include/joulepath/version.h | paste -sd.)

PREFIX_CHECK  = $(if $(filter /%,$(PREFIX)),,$(error PREFIX=$(PREFIX): must be an absolute path))
INSTALL_ROOT  = $(DESTDIR)$(PREFIX)
PACKAGES      = joulepath joulepath-float
PACKAGE_FILES = $(INSTALL_ROOT)/include/joulepath $(INSTALL_ROOT)/lib/libjoulepath.a $(INSTALL_ROOT)/lib/libjoulepath_float.a \
                $(PACKAGES:%=$(INSTALL_ROOT)/lib/pkgconfig/%.pc) $(INSTALL_ROOT)/lib/cmake/joulepath $(INSTALL_ROOT)/share/doc/joulepath

.PHONY: install
install: $(BUILD)/release/libjoulepath.a $(BUILD)/release/libjoulepath_float.a ## install the library for programs on this machine (PREFIX=/usr/local DESTDIR=)
	$(PREFIX_CHECK)
	install -d $(INSTALL_ROOT)/include/joulepath $(INSTALL_ROOT)/lib/pkgconfig $(INSTALL_ROOT)/lib/cmake/joulepath \
	    $(INSTALL_ROOT)/share/doc/joulepath
	install -m 644 include/joulepath/*.h $(INSTALL_ROOT)/include/joulepath
	install -m 644 $^ $(INSTALL_ROOT)/lib
	strip --strip-debug $(addprefix $(INSTALL_ROOT)/lib/,$(^F))
	set -e; for package in $(PACKAGES); do \
	    sed 's|@PREFIX@|$(PREFIX)|; s|@VERSION@|$(VERSION)|' tools/packaging/$$package.pc.in | \
	    install -m 644 /dev/stdin $(INSTALL_ROOT)/lib/pkgconfig/$$package.pc; done
	install -m 644 tools/packaging/joulepathConfig.cmake $(INSTALL_ROOT)/lib/cmake/joulepath
	sed 's|@VERSION@|$(VERSION)|' tools/packaging/joulepathConfigVersion.cmake.in | \
	    install -m 644 /dev/stdin $(INSTALL_ROOT)/lib/cmake/joulepath/joulepathConfigVersion.cmake
	install -m 644 LICENSE $(INSTALL_ROOT)/share/doc/joulepath

.PHONY: uninstall
uninstall: ## remove what `make install` put there
	$(PREFIX_CHECK)
	rm -rf $(PACKAGE_FILES)

.PHONY: package
package: ## make the source package for CMake, Zephyr, PlatformIO and others in build/package
	tools/packaging/package.sh $(VERSION) $(BUILD)/package

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
TARGET_LOGS   := $(foreach t,test_cycles dies_of_fault dies_of_overflow,$(SPEED_VARIANTS:%=$(LOGS)/%/$t.log))
FLOAT_LOGS    := $(foreach v,$(HOST_TESTS) $(FPU_CORES),$(patsubst %,$(LOGS)/$v/%.log,$(call names,$(FLOAT_TESTS))))
BITS_VARIANTS := host-gcc host-gcc-m32 $(SPEED_VARIANTS)
BITS_LOGS     := $(foreach v,$(BITS_VARIANTS),$(patsubst %,$(LOGS)/$v/%.log,$(call names,$(BITS_TESTS))))
SIL_LOGS      := $(LOGS)/pytest/sil.xml
TOOLS_LOGS    := $(LOGS)/pytest/tools.xml
FIRMWARE_LOGS := $(LOGS)/firmware/test_faults.log $(LOGS)/host-gcc/test_main.log $(LOGS)/cortex-m4/test_main.log $(LOGS)/pytest/firmware.xml
PACKAGE_LOGS  := $(LOGS)/pytest/package.xml
VCAN_LOGS     := $(LOGS)/pytest/vcan.xml $(LOGS)/pytest/vcan_results.xml
GATE_LOGS     := $(patsubst %,$(LOGS)/gates/%.log,symbols firmware growth compile includes format cppcheck misra tidy coverage)
TEST_LOGS     := $(VCAN_LOGS) $(FIRMWARE_LOGS) $(SIL_LOGS) $(TOOLS_LOGS) $(PACKAGE_LOGS) $(GATE_LOGS) $(PROPERTY_LOGS) $(FAULT_LOGS) $(BITS_LOGS) $(FLOAT_LOGS) $(UNIT_LOGS) $(TARGET_LOGS)

EXPECTED = unit $(UNIT_LOGS) float $(FLOAT_LOGS) bits $(BITS_LOGS) property $(PROPERTY_LOGS) fault $(FAULT_LOGS) target $(TARGET_LOGS) firmware $(FIRMWARE_LOGS) \
           sil $(SIL_LOGS) vcan $(VCAN_LOGS) tools $(TOOLS_LOGS) package $(PACKAGE_LOGS) gates $(GATE_LOGS)

.PHONY: test
test: ## build and run every test and gate; the last line counts them
	@tools/setup.sh test
	@rm -rf $(LOGS)
	@mkdir -p $(LOGS)
	@$(MAKE) -k $(PARALLEL) test_logs || true
	@$(PYTHON) tools/test_summary.py $(EXPECTED)

# Everything that runs on the emulated cores.
CORE_LOGS = $(filter $(foreach v,$(TARGET_TESTS) $(SPEED_VARIANTS),$(LOGS)/$v/%),$(UNIT_LOGS) $(FLOAT_LOGS) $(BITS_LOGS) $(TARGET_LOGS))

.PHONY: test-targets
test-targets: ## run the tests of the emulated cores alone: passed, failed and seconds
	@tools/setup.sh test
	@$(MAKE) -k $(PARALLEL) $(patsubst $(LOGS)/%.log,$(BUILD)/%,$(CORE_LOGS)) || true
	@rm -f $(CORE_LOGS)
	@start=$$(date +%s); $(MAKE) -k $(PARALLEL) $(CORE_LOGS) || true; \
	    $(PYTHON) tools/target_tests.py --seconds $$(($$(date +%s) - start)) $(CORE_LOGS)

.PHONY: test_logs
test_logs: $(TEST_LOGS)

define host_test_rules
$(BUILD)/$1/test_%: $(BUILD)/$1/tests/unit/test_%.o $(if $(UNITY_SOURCE),$(BUILD)/$1/unity.o) $(BUILD)/$1/libdrivers.a $(BUILD)/$1/libcan.a $(BUILD)/$1/libjoulepath.a
	$$(call link_core,$1)

$(BUILD)/$1/test_%: $(BUILD)/$1/tests/float/test_%.o $(if $(UNITY_SOURCE),$(BUILD)/$1/unity.o) $(BUILD)/$1/libjoulepath_float.a $(BUILD)/$1/libjoulepath.a
	$$(call link_core,$1)

$(LOGS)/$1/test_%.log: $(BUILD)/$1/test_%
	$$(call SAY,RUN $$<)
	$$Q$(RUN) $$@ $(UNIT_LIMIT) $$<
endef
$(foreach v,$(HOST_TESTS),$(eval $(call host_test_rules,$v)))

define target_test_rules
$(BUILD)/$1/test_%: $(BUILD)/$1/tests/unit/test_%.o $(call support,$1) \
                    $(if $(UNITY_SOURCE),$(BUILD)/$1/unity.o) $(BUILD)/$1/libdrivers.a $(BUILD)/$1/libcan.a \
                    $(BUILD)/$1/libjoulepath.a tests/target/$(BOARD.$1).ld tests/target/sections.ld
	$$(call link_target,$1)

$(LOGS)/$1/test_%.log: $(BUILD)/$1/test_%
	$$(call SAY,RUN $$<)
	$$Q$(RUN) $$@ $(UNIT_LIMIT) $(RUN.$1) $$<
endef
$(foreach v,$(sort $(TARGET_TESTS) $(SPEED_VARIANTS)),$(eval $(call target_test_rules,$v)))

define float_target_test_rules
$(BUILD)/$1/test_%: $(BUILD)/$1/tests/float/test_%.o $(call support,$1) $(if $(UNITY_SOURCE),$(BUILD)/$1/unity.o) \
                    $(BUILD)/$1/libjoulepath_float.a $(BUILD)/$1/libjoulepath.a
	$$(call link_target,$1)
endef
$(foreach v,$(FPU_CORES),$(eval $(call float_target_test_rules,$v)))

define support_test_rules
$(BUILD)/$1/test_cycles: $(BUILD)/$1/tests/target/test_cycles.o $(call support,$1) $(if $(UNITY_SOURCE),$(BUILD)/$1/unity.o)
	$$(call link_target,$1)

$(BUILD)/$1/dies_of_%: $(BUILD)/$1/tests/target/dies_of_%.o $(call support,$1)
	$$(call link_target,$1)

$(LOGS)/$1/dies_of_%.log: $(BUILD)/$1/dies_of_% tests/target/dies.sh
	$$(call SAY,RUN $$<)
	$$Q$(RUN) $$@ $(UNIT_LIMIT) tests/target/dies.sh '$$(DIES_OF_$$*)' $(RUN.$1) $$<
endef
$(foreach v,$(SPEED_VARIANTS),$(eval $(call support_test_rules,$v)))

# The whole library and what it needs of the compiler's, to be measured and not to be run.
define whole_rules
$(BUILD)/$1/whole: $(BUILD)/$1/tests/target/whole.o $(call support,$1) $(BUILD)/$1/libcan.a $(call float_library,$1) $(BUILD)/$1/libjoulepath.a
	@mkdir -p $$(@D)
	$$(call SAY,LD $$@)
	$$Q$$(COMPILER.$1) $(FLAGS.$1) -nostartfiles $(if $(filter cortex%,$1),--specs=nano.specs) -Wl,--no-gc-sections \
	    -Ltests/target -Ttests/target/$(BOARD.$1).ld -Wl,--whole-archive $$(filter %.o %.a,$$^) -Wl,--no-whole-archive -o $$@
endef
$(foreach v,$(sort $(SPEED_VARIANTS) $(SIZE_VARIANTS)),$(eval $(call whole_rules,$v)))

# The image of the board, whose main.o is apart from the other objects.
$(BUILD)/firmware/whole: $(BUILD)/firmware/courier24/joulepath.elf
	@cp $(<D)/main.ci $(@D)
	@cp $< $@

# What they say last.
DIES_OF_fault    := fault
DIES_OF_overflow := stack overflow

# Equal bits on every core; with scenes, which are integers only.
define bits_rules
$(BUILD)/$1/test_%_bits: $(BUILD)/$1/tests/bits/test_%_bits.o $(BUILD)/$1/sim/scene.o \
                         $(if $(BOARD.$1),$(call support,$1)) \
                         $(if $(UNITY_SOURCE),$(BUILD)/$1/unity.o) $(BUILD)/$1/libjoulepath.a
	$$(call $(if $(BOARD.$1),link_target,link_core),$1)
endef
$(foreach v,$(BITS_VARIANTS),$(eval $(call bits_rules,$v)))

HOST_TEST_PARTS := $(if $(UNITY_SOURCE),$(BUILD)/host-gcc/unity.o) $(call host_libraries,host-gcc)

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

# The fault handler alone, whose crashes the image could not tell of.
$(BUILD)/firmware/test_faults: $(addprefix $(BUILD)/firmware/,tests/firmware/test_faults.o tests/target/console.o \
                               tests/target/arm/semihosting.o hal/stm32f4/startup.o hal/stm32f4/cortex_m.o hal/stm32f4/fault.o) \
                               $(BUILD)/firmware/libcan.a $(wildcard hal/stm32f4/*.ld)
	$(call link_firmware)

$(LOGS)/firmware/test_faults.log: $(BUILD)/firmware/test_faults
	$(call SAY,RUN $<)
	$Q$(RUN) $@ $(UNIT_LIMIT) qemu-system-arm -M netduinoplus2 $(SEMIHOSTING) $<

# main.c on fake registers.
$(BUILD)/host-gcc/test_main: $(addprefix $(BUILD)/host-gcc/,tests/firmware/test_main.o libdrivers.a libcan.a libjoulepath.a) \
                             $(if $(UNITY_SOURCE),$(BUILD)/host-gcc/unity.o)
	$(call link_core,host-gcc)

$(BUILD)/cortex-m4/test_main: $(addprefix $(BUILD)/cortex-m4/,tests/firmware/test_main.o libdrivers.a libcan.a libjoulepath.a) \
                              $(call support,cortex-m4) $(if $(UNITY_SOURCE),$(BUILD)/cortex-m4/unity.o)
	$(call link_target,cortex-m4)

$(LOGS)/pytest/firmware.xml: $(ROBOTS:%=$(BUILD)/firmware/%/joulepath.elf)

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

GATE_LIBRARIES := $(foreach v,$(SPEED_VARIANTS) $(SIZE_VARIANTS),$(BUILD)/$v/libjoulepath.a $(call float_library,$v) $(BUILD)/$v/libcan.a)
GATE_IMAGES    := $(BUILD)/cortex-m4/test_ecu $(BUILD)/cortex-m0/test_ecu $(BUILD)/rv32/test_ecu
export GATE_CFLAGS := -std=c11 $(WARNINGS) -Iinclude -I. -Itests/unity -Itests/target -isystem $(BUILD)/lcm $(HOST) -DTARGET_CORE="any" -DFIRMWARE_ROBOT_NAME=gao2018 -DFIRMWARE_LEARNS

$(LOGS)/gates/symbols.log: $(GATE_LIBRARIES)
	$(call SAY,RUN gate symbols)
	$Q$(RUN) $@ $(GATE_LIMIT) tests/gates/symbols.sh $(GATE_LIBRARIES)

$(LOGS)/gates/growth.log: $(STACK_IMAGES) $(CYCLES)
	$(call SAY,RUN gate growth)
	$QPYTHON='$(PYTHON)' $(RUN) $@ $(GATE_LIMIT) tests/gates/growth.sh \
	    '$(dir $(SIZE_IMAGES))' '$(dir $(STACK_IMAGES))' '$(CYCLES)'

$(LOGS)/gates/firmware.log: $(GATE_IMAGES)
	$(call SAY,RUN gate firmware)
	$Q$(RUN) $@ $(GATE_LIMIT) tests/gates/firmware.sh $(GATE_IMAGES)

# The unit tests, also of the float library, and the property tests of what no example foresees.
COVERAGE_TESTS := $(patsubst %,$(BUILD)/host-coverage/%,prop_planner prop_segment prop_telemetry $(call names,$(UNIT_TESTS)) $(call names,$(FLOAT_TESTS)))

COVERAGE_PARTS := $(UNITY_SOURCE:%=$(BUILD)/host/unity.o) $(BUILD)/host/libsim.a $(BUILD)/host/libdrivers.a $(BUILD)/host/libcan.a \
                  $(BUILD)/host-coverage/libjoulepath_float.a $(BUILD)/host-coverage/libjoulepath.a

$(BUILD)/host-coverage/test_%: $(BUILD)/host/tests/unit/test_%.o $(COVERAGE_PARTS)
	$(call link_host,host-coverage)

$(BUILD)/host-coverage/test_%: $(BUILD)/host/tests/float/test_%.o $(COVERAGE_PARTS)
	$(call link_host,host-coverage)

$(BUILD)/host-coverage/prop_%: $(BUILD)/host/tests/property/prop_%.o $(COVERAGE_PARTS)
	$(call link_host,host-coverage)

$(LOGS)/gates/coverage.log: $(COVERAGE_TESTS)
	$(call SAY,RUN gate coverage)
	$Q$(RUN) $@ $(GATE_LIMIT) tests/gates/coverage.sh $^

$(LOGS)/gates/%.log: tests/gates/%.sh | $(LCM_HEADERS)
	$(call SAY,RUN gate $*)
	$Q$(RUN) $@ $(GATE_LIMIT) $<

.PHONY: coverage
coverage: ## lines and branches of src/ that the host tests take: a table, each line in build/coverage/index.html
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(COVERAGE_TESTS)
	@mkdir -p $(BUILD) && tests/gates/coverage.sh $(COVERAGE_TESTS) >$(BUILD)/coverage.txt; status=$$?; \
	    grep -v ':PASS$$' $(BUILD)/coverage.txt; exit $$status

.PHONY: misra
misra: ## check include/ and src/ for MISRA C:2012 and print what is deviated from, how often and why
	@tools/setup.sh test
	@mkdir -p $(BUILD) && tests/gates/misra.sh >$(BUILD)/misra.txt; status=$$?; \
	    grep -v ':PASS$$' $(BUILD)/misra.txt; exit $$status

# ---- Upkeep ----------------------------------------------------------------------------------------------------------

define measure
	@tools/setup.sh test
	+@$(MAKE) -s $(PARALLEL) $2
	@$(PYTHON) tools/$1.py $(if $(filter %-diff,$@),--diff) $(if $(filter %.json,$2),$2,$(dir $2))
endef

.PHONY: size stack cycles size-diff stack-diff cycles-diff
size: ## flash and RAM of each module on five cores
	$(call measure,size,$(SIZE_IMAGES))

stack: ## worst-case stack of each entry point on five cores
	$(call measure,stack,$(STACK_IMAGES))

cycles: ## worst-case instructions on five cores
	$(call measure,cycles,$(CYCLES))

size-diff: ## the same against the last commit's numbers; so stack-diff and cycles-diff
	$(call measure,size,$(SIZE_IMAGES))

stack-diff:
	$(call measure,stack,$(STACK_IMAGES))

cycles-diff:
	$(call measure,cycles,$(CYCLES))

.PHONY: numbers
numbers: size stack cycles ## accept size, stack and cycles as they are now, and write them into the README
	@$(PYTHON) tools/growth.py --accept

.PHONY: format
format: ## format the C sources
	find include src hal sim tests -name '*.[ch]' -exec $(CLANG_FORMAT) -i {} +

.PHONY: clean
clean: ## remove build/
	rm -rf $(BUILD)

-include $(shell [ -d $(BUILD) ] && find $(BUILD) -name '*.d')
