# Sources: what is in which library, program and test.

# src/single_precision.txt says what needs a floating-point unit.
SINGLE         := $(strip $(file <src/single_precision.txt))
FLOAT          := $(wildcard $(SINGLE))
CORE           := $(filter-out $(FLOAT),$(wildcard src/*/*.c))
# Of the application too.
CAN_FLOAT      := hal/app/ecu_patrol.c hal/app/ecu_patrol_round.c hal/app/ecu_patrol_way.c hal/can/round_code.c
CAN            := $(filter-out $(CAN_FLOAT),$(wildcard hal/*.c hal/storage/*.c hal/can/*.c hal/app/*.c))
STM32F4        := $(wildcard hal/stm32f4/*.c)
MPS2           := $(wildcard hal/mps2/*.c)
CORTEX_M       := $(wildcard hal/cortex_m/*.c)
# What needs nothing of the core but registers, which a test can stand in for.
DRIVERS        := $(filter-out $(addprefix hal/stm32f4/,vectors.c main.c),$(STM32F4))
SIM            := $(filter-out sim/programs/% sim/page/%,$(wildcard sim/*/*.c)) $(wildcard hal/linux/*.c)
SUPPORT        := $(filter-out %/stm32_fake.c,$(wildcard tests/support/*.c))
PROGRAMS       := $(patsubst sim/programs/%.c,$(BUILD)/bin/%,$(wildcard sim/programs/jp-*.c))
BENCHES        := $(filter-out bench_cuts bench_goals bench_joules bench_localise bench_plan bench_maps bench_patrol bench_patrol_plans bench_patrol_round bench_pursuit bench_restart bench_skid_bus bench_skid_drive,$(patsubst tests/bench/%.c,%,$(wildcard tests/bench/bench_*.c)))
# What needs more memory than a microcontroller has runs where a board adds it.
LARGE_BENCHES  := target_return_map
TARGET_BENCHES := $(filter-out $(LARGE_BENCHES),$(patsubst tests/bench/%.c,%,$(wildcard tests/bench/target_*.c)))
FLOAT_BENCHES  := $(filter target_localiser target_optimiser target_patrol_pilot target_teb,$(TARGET_BENCHES))

# lcm-gen makes them from sim/lcm/.
LCM_TYPES      := $(patsubst sim/lcm/%.lcm,%,$(wildcard sim/lcm/*.lcm))
LCM_HEADERS    := $(LCM_TYPES:%=$(BUILD)/lcm/%.h)

# A robot is built in when both of its tables are there.
NAMES          := $(patsubst src/tables/robot_%.c,%,$(wildcard src/tables/robot_*.c))
ROBOTS         := $(foreach n,$(NAMES),$(if $(wildcard src/tables/energy_$n.c),$n))
# One that its sides steer: when its controller, energy and path limits are.
SKID_ROBOTS    := $(foreach n,$(patsubst src/tables/skid_robot_%.c,%,$(wildcard src/tables/skid_robot_*.c)),$(if $(wildcard src/tables/skid_energy_$n.c),$(if $(wildcard src/tables/path_limits_$n.c),$n)))
# One with four steered wheels: when its control tick and energy are.
PATROL_ROBOTS  := $(foreach n,$(patsubst src/tables/four_wheel_robot_%.c,%,$(wildcard src/tables/four_wheel_robot_*.c)),$(if $(wildcard src/tables/four_wheel_energy_$n.c),$n))
PILOT_TABLES   := $(patsubst src/tables/%.c,%,$(wildcard src/tables/horizon_*.c src/tables/learning_*.c))

FLOAT_TESTS    := $(foreach s,$(SINGLE),$(wildcard $(patsubst src/%,tests/unit/%,$(dir $s))test_$(notdir $s)))
UNIT_TESTS     := $(filter-out $(FLOAT_TESTS),$(wildcard tests/unit/*/test_*.c))
PROPERTY_TESTS := $(wildcard tests/property/prop_*.c)
BITS_TESTS     := $(wildcard tests/bits/test_*.c)
FAULT_TESTS    := $(wildcard tests/fault/fault_*.c)
FUZZ_TARGETS   := $(patsubst tests/fuzz/%.c,%,$(wildcard tests/fuzz/fuzz_*.c))
VCAN_TESTS     := $(wildcard tests/vcan/vcan_*.c)
TESTS          := $(UNIT_TESTS) $(FLOAT_TESTS) $(PROPERTY_TESTS) $(FAULT_TESTS) $(BITS_TESTS) $(VCAN_TESTS) tests/firmware/test_main.c
TARGET_SUPPORT := tests/target/start.c tests/target/console.c

# With the real Unity its one source file joins each test, and the self-test of our header is left out.
UNITY_SOURCE := $(wildcard $(UNITY)/unity.c)
ifneq ($(UNITY_SOURCE),)
UNIT_TESTS := $(filter-out tests/unit/unity/test_unity.c,$(UNIT_TESTS))
endif

# support VARIANT: the objects that a program on a target stands on.
support = $(patsubst %.c,$(BUILD)/$1/%.o,$(TARGET_SUPPORT) \
          $(addprefix tests/target/$(dir $(BOARD.$1)),core.c semihosting.c cycles.c))

# float_library VARIANT: where it has one.
float_library = $(if $(filter $1,$(FLOAT_VARIANTS)),$(BUILD)/$1/libjoulepath_float.a)

# host_libraries VARIANT: each before what it stands on.
host_libraries = $(addprefix $(BUILD)/$1/,libsupport.a libsim.a libcan_float.a libcan.a libjoulepath_float.a libjoulepath.a)

LIBRARIES = $(shell pkg-config --libs libconfig jansson nlopt ccd) -llcm -lm -lpthread
