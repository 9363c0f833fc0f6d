# Tests and gates. A suite is a list of logs; tools/measure/test_summary.py judges them.

# What a run may take: seconds of its processor's time against endless loops; run_test.sh bounds waiting.
UNIT_LIMIT   ?= 60
HOST_LIMIT   ?= 300
PYTEST_LIMIT ?= 1800
GATE_LIMIT   ?= 600

LOGS := $(BUILD)/test
RUN  := tools/measure/run_test.sh

# no_tests.log has no rule: a suite without a file fails.
names = $(or $(notdir $(basename $1)),no_tests)
# logs VARIANTS FILES: one for each test on each variant.
logs  = $(foreach v,$1,$(patsubst %,$(LOGS)/$v/%.log,$(call names,$2)))

SUITES         := vcan sil python page tools package firmware gates property fault fuzz bits unit target
LOGS.vcan      := $(LOGS)/pytest/vcan.xml $(LOGS)/pytest/vcan_results.xml
LOGS.sil       := $(LOGS)/pytest/sil.xml
LOGS.python    := $(LOGS)/pytest/python.xml
LOGS.page      := $(LOGS)/pytest/page.xml
LOGS.tools     := $(LOGS)/pytest/tools.xml
LOGS.package   := $(LOGS)/pytest/package.xml
LOGS.firmware  := $(LOGS)/firmware/test_faults.log $(LOGS)/firmware-m7/test_faults.log $(LOGS)/firmware/test_planning.log $(LOGS)/host-gcc/test_main.log $(LOGS)/cortex-m4/test_main.log $(LOGS)/pytest/firmware.xml
LOGS.gates     := $(patsubst %,$(LOGS)/gates/%.log,symbols strict_math firmware growth compile includes private format cppcheck misra tidy coverage)
LOGS.property  := $(call logs,host-gcc,$(PROPERTY_TESTS))
LOGS.fault     := $(call logs,host-gcc,$(FAULT_TESTS))
LOGS.fuzz      := $(call logs,host-fuzz,$(FUZZ_TARGETS))
LOGS.bits      := $(call logs,$(HOST_TESTS) $(BITS_CORES),$(BITS_TESTS))
LOGS.unit      := $(call logs,$(HOST_TESTS) $(UNIT_CORES),$(UNIT_TESTS)) \
                  $(call logs,$(HOST_TESTS) $(filter $(FLOAT_VARIANTS),$(UNIT_CORES)),$(FLOAT_TESTS))
LOGS.target    := $(call logs,$(BITS_CORES),test_cycles dies_of_fault dies_of_overflow)

SUITE ?= $(SUITES)
UNKNOWN_SUITES = $(filter-out $(SUITES),$(SUITE))
CHOSEN_LOGS    = $(foreach s,$(SUITE),$(LOGS.$s))

.PHONY: test
test: ## build and run every test and gate, or those of SUITE="unit gates …"; the last line counts them
	$(if $(UNKNOWN_SUITES),$(error SUITE=$(UNKNOWN_SUITES): must be of $(SUITES)))
	@tools/setup.sh test
	@rm -f $(CHOSEN_LOGS)
	@mkdir -p $(LOGS)
	@$(MAKE) -k $(PARALLEL) SUITE='$(SUITE)' test_logs || true
	@$(PYTHON) -m tools.measure.test_summary $(foreach s,$(SUITE),$s $(LOGS.$s))

.PHONY: test_logs
test_logs: $(CHOSEN_LOGS)

# While you type: no emulators, no sanitizers.
CHECK_LOGS = $(call logs,host-coverage,$(UNIT_TESTS) $(FLOAT_TESTS)) $(patsubst %,$(LOGS)/gates/%.log,includes format)

.PHONY: check
check: ## the unit tests on this machine, includes and format: for the inner loop
	@tools/setup.sh test
	@rm -f $(CHECK_LOGS)
	@$(MAKE) -k $(PARALLEL) check_logs || true
	@$(PYTHON) -m tools.measure.test_summary check $(CHECK_LOGS)

.PHONY: check_logs
check_logs: $(CHECK_LOGS)

# Everything that runs on the emulated cores, on all of them.
ALL_CORE_LOGS = $(call logs,$(ALL_UNIT_CORES),$(UNIT_TESTS)) $(call logs,$(FPU_CORES),$(FLOAT_TESTS)) \
                $(call logs,$(SPEED_VARIANTS),$(BITS_TESTS) test_cycles dies_of_fault dies_of_overflow)
ALL_BITS_LOGS = $(call logs,$(HOST_TESTS) $(SPEED_VARIANTS),$(BITS_TESTS))

.PHONY: test-targets
test-targets: ## run the tests of all emulated cores: passed, failed and seconds
	@tools/setup.sh test
	@$(MAKE) -k $(PARALLEL) $(patsubst $(LOGS)/%.log,$(BUILD)/%,$(ALL_CORE_LOGS)) || true
	@rm -f $(ALL_CORE_LOGS)
	@start=$$(date +%s); $(MAKE) -k $(PARALLEL) $(ALL_CORE_LOGS) || true; \
	    $(PYTHON) -m tools.measure.target_tests --seconds $$(($$(date +%s) - start)) $(ALL_CORE_LOGS)

# ---- Unit tests ------------------------------------------------------------------------------------------------------

# unit_object VARIANT TEST: the object of a test, whose room is not in its program's name.
define unit_object
$(BUILD)/$1/$(notdir $(basename $2)): $(BUILD)/$1/$(basename $2).o
endef

unit_programs  = $(patsubst %,$(BUILD)/$1/%,$(call names,$(UNIT_TESTS) $(if $(filter $1,$(FLOAT_VARIANTS)),$(FLOAT_TESTS))))
unit_libraries = $(addprefix $(BUILD)/$1/,$(if $(UNITY_SOURCE),unity.o) libdrivers.a libcan.a) $(call float_library,$1) $(BUILD)/$1/libjoulepath.a

define unit_rules
$(foreach t,$(UNIT_TESTS) $(FLOAT_TESTS),$(eval $(call unit_object,$1,$t)))

$(call unit_programs,$1): $(call unit_libraries,$1) $(if $(BOARD.$1),$(call support,$1) tests/target/$(BOARD.$1).ld tests/target/sections.ld)
	$$(call $(if $(BOARD.$1),link_target,link_core),$1)

$(LOGS)/$1/test_%.log: $(BUILD)/$1/test_%
	$$(call SAY,RUN $$<)
	$$Q$(RUN) $$@ $(UNIT_LIMIT) $(RUN.$1) $$< $$(CLOCK)
endef
$(foreach v,host-coverage host-mcdc $(HOST_TESTS) $(sort $(ALL_UNIT_CORES) $(SPEED_VARIANTS)),$(eval $(call unit_rules,$v)))

# Equal bits on every core; with scenes, which are integers only.
define bits_rules
$(BUILD)/$1/test_%_bits: $(BUILD)/$1/tests/bits/test_%_bits.o $(BUILD)/$1/tests/support/scene.o \
                         $(if $(BOARD.$1),$(call support,$1)) \
                         $(if $(UNITY_SOURCE),$(BUILD)/$1/unity.o) $(BUILD)/$1/libjoulepath.a
	$$(call $(if $(BOARD.$1),link_target,link_core),$1)
endef
$(foreach v,host-coverage $(HOST_TESTS) $(SPEED_VARIANTS),$(eval $(call bits_rules,$v)))

# What the targets' own support is made of.
define support_test_rules
$(BUILD)/$1/test_cycles: $(BUILD)/$1/tests/target/test_cycles.o $(call support,$1) $(if $(UNITY_SOURCE),$(BUILD)/$1/unity.o)
	$$(call link_target,$1)

$(LOGS)/$1/test_cycles.log: CLOCK = $(COUNTING)

$(BUILD)/$1/dies_of_%: $(BUILD)/$1/tests/target/dies_of_%.o $(call support,$1)
	$$(call link_target,$1)

$(LOGS)/$1/dies_of_%.log: $(BUILD)/$1/dies_of_% tests/target/dies.sh
	$$(call SAY,RUN $$<)
	$$Q$(RUN) $$@ $(UNIT_LIMIT) tests/target/dies.sh '$$(DIES_OF_$$*)' $(RUN.$1) $$<
endef
$(foreach v,$(SPEED_VARIANTS),$(eval $(call support_test_rules,$v)))

# What they say last.
DIES_OF_fault    := fault
DIES_OF_overflow := stack overflow

# ---- Tests with the simulator ----------------------------------------------------------------------------------------

HOST_TEST_PARTS := $(if $(UNITY_SOURCE),$(BUILD)/host-gcc/unity.o) $(call host_libraries,host-gcc)

define host_test_rules
$(BUILD)/host-gcc/$1_%: $(BUILD)/host-gcc/tests/$2/$1_%.o $(HOST_TEST_PARTS)
	$$(call link_host,host-gcc)

$(LOGS)/host-gcc/$1_%.log: $(BUILD)/host-gcc/$1_%
	$$(call SAY,RUN $$<)
	$$Q$(RUN) $$@ $(HOST_LIMIT) $$<
endef
$(eval $(call host_test_rules,prop,property))
$(eval $(call host_test_rules,fault,fault))
$(eval $(call host_test_rules,vcan,vcan))

$(LOGS)/pytest/%.xml: $(PROGRAMS)
	$(call SAY,RUN pytest tests/$*)
	$Q$(RUN) $(@:.xml=.log) $(PYTEST_LIMIT) $(PYTHON) -m pytest -q -n $(JOBS) -p no:cacheprovider --junitxml=$@ tests/$*

$(LOGS)/pytest/python.xml: $(PYTHON_SITE)/joulepath/__init__.py

$(LOGS)/pytest/page.xml: $(PAGE_FILES) $(PAGE_LIBRARY) $(PYTHON_SITE)/joulepath/__init__.py

# What the examples of the READMEs are linked with.
$(LOGS)/pytest/tools.xml: $(foreach v,host cortex-m4,$(BUILD)/$v/libcan.a $(call float_library,$v) $(BUILD)/$v/libjoulepath.a)

# All in one emulated kernel: it takes a while to boot, and to import plugins that no test there needs. What is slow in it
# comes after it.
$(LOGS)/pytest/vcan.xml: $(PROGRAMS) $(patsubst %,$(BUILD)/host-gcc/%,$(call names,$(VCAN_TESTS)))
	$(call SAY,RUN pytest tests/vcan)
	$Q$(RUN) $(@:.xml=.log) $(PYTEST_LIMIT) env PYTEST_DISABLE_PLUGIN_AUTOLOAD=1 tools/operate/with_vcan.sh --interfaces 2 -- \
	    $(PYTHON) -m pytest -q -p no:cacheprovider --junitxml=$@ tests/vcan/test_vcan.py

$(LOGS)/pytest/vcan_results.xml: $(LOGS)/pytest/vcan.xml
	$(call SAY,RUN pytest tests/vcan/test_vcan_results.py)
	$Q$(RUN) $(@:.xml=.log) $(PYTEST_LIMIT) $(PYTHON) -m pytest -q -p no:cacheprovider --junitxml=$@ \
	    tests/vcan/test_vcan_results.py

# `make install` installs them.
$(LOGS)/pytest/package.xml: $(PROGRAMS)

# ---- Firmware --------------------------------------------------------------------------------------------------------

# Of each kind one, and the one that is made to crash.
MPS2_TESTED := courier24 burger gao2018

$(LOGS)/pytest/firmware.xml: $(patsubst %,$(BUILD)/firmware/%/emulated.elf,$(ROBOTS) $(SKID_ROBOTS) $(PATROL_ROBOTS)) $(BUILD)/firmware/courier24/joulepath.elf \
                               $(MPS2_TESTED:%=$(BUILD)/mps2/%/emulated.elf) $(BUILD)/mps2/courier24/joulepath.elf

# The fault handler alone, whose crashes the image could not tell of.
$(BUILD)/firmware/test_faults: $(addprefix $(BUILD)/firmware/,tests/firmware/test_faults.o tests/target/console.o \
                               tests/target/arm/semihosting.o hal/stm32f4/vectors.o $(CORTEX_M:.c=.o)) \
                               $(BUILD)/firmware/libcan.a $(STM32F4_SCRIPTS)
	$(call link_firmware,$(CCM))

$(LOGS)/firmware/test_faults.log: $(BUILD)/firmware/test_faults
	$(call SAY,RUN $<)
	$Q$(RUN) $@ $(UNIT_LIMIT) qemu-system-arm -M netduinoplus2 $(SEMIHOSTING) $<

# The same on the other board.
$(BUILD)/firmware-m7/test_faults: $(addprefix $(BUILD)/firmware-m7/,tests/firmware/test_faults.o tests/target/console.o \
                                  tests/target/arm/semihosting.o hal/mps2/vectors.o $(CORTEX_M:.c=.o) libcan.a) $(MPS2_SCRIPTS)
	$(call link_mps2,0)

$(LOGS)/firmware-m7/test_faults.log: $(BUILD)/firmware-m7/test_faults
	$(call SAY,RUN $<)
	$Q$(RUN) $@ $(UNIT_LIMIT) qemu-system-arm -M mps2-an500 $(SEMIHOSTING) $<

# The application on the core while its tick comes by a timer, for so many ticks.
PLANNING = $(addprefix $(BUILD)/firmware/,tests/firmware/test_planning.o tests/target/console.o tests/target/arm/semihosting.o \
                                          hal/stm32f4/vectors.o $(CORTEX_M:.c=.o) hal/stm32f4/timer.o) \
           $(BUILD)/firmware/libcan.a $(BUILD)/firmware/libjoulepath.a $(STM32F4_SCRIPTS)
PLANNING_CLOCK = qemu-system-arm -M netduinoplus2 -icount shift=3 $(SEMIHOSTING)

$(BUILD)/firmware/tests/firmware/test_planning.o: MODULE_FLAGS = -DTARGET_CORE='"STM32F405"'

$(BUILD)/firmware/test_planning: $(PLANNING)
	$(call link_firmware,$(EMULATED_CCM) -Wl$(COMMA)--defsym=planning_ticks=4000)

$(BUILD)/firmware/bench_planning: $(PLANNING)
	$(call link_firmware,$(EMULATED_CCM) -Wl$(COMMA)--defsym=planning_ticks=1000000)

$(LOGS)/firmware/test_planning.log: $(BUILD)/firmware/test_planning
	$(call SAY,RUN $<)
	$Q$(RUN) $@ $(UNIT_LIMIT) $(PLANNING_CLOCK) $<

# main.c on fake registers.
define main_test_rules
$(BUILD)/$1/test_main: $(addprefix $(BUILD)/$1/,tests/firmware/test_main.o libdrivers.a libcan.a libjoulepath.a) \
                       $(if $(BOARD.$1),$(call support,$1)) $(if $(UNITY_SOURCE),$(BUILD)/$1/unity.o)
	$$(call $(if $(BOARD.$1),link_target,link_core),$1)
endef
$(foreach v,host-gcc cortex-m4,$(eval $(call main_test_rules,$v)))

# ---- Gates -----------------------------------------------------------------------------------------------------------

GATE_VARIANTS  := $(UNIT_CORES) $(GROWTH_VARIANTS)
GATE_LIBRARIES := $(foreach v,$(sort $(GATE_VARIANTS)),$(BUILD)/$v/libjoulepath.a $(call float_library,$v) $(BUILD)/$v/libcan.a)
# Of the programs on the whole application the one that learns links the most.
GATE_IMAGES    := $(UNIT_CORES:%=$(BUILD)/%/test_ecu_learning)
export GATE_CFLAGS := -std=c11 $(WARNINGS) -Iinclude -I. -Itests/unity -Itests/target -isystem $(BUILD)/lcm $(HOST) -DTARGET_CORE="any" -DFIRMWARE_ROBOT_NAME=courier24 -DFIRMWARE_LATTICE_NAME=courier24 -DFIRMWARE_SKID_NAME=burger -DFIRMWARE_PATROL_NAME=patrol -DFIRMWARE_LEARNS -DFIRMWARE_KNOWS_CELLS -DFIRMWARE_NAVIGATES

$(LOGS)/gates/symbols.log: $(GATE_LIBRARIES)
	$(call SAY,RUN gate symbols)
	$Q$(RUN) $@ $(GATE_LIMIT) tests/gates/symbols.sh $(GATE_LIBRARIES)

# What is simulated, and what simulates it.
STRICT_MATH := $(filter-out %/libsupport.a,$(call host_libraries,host)) $(PROGRAMS:$(BUILD)/bin/%=$(BUILD)/host/sim/programs/%.o)

$(LOGS)/gates/strict_math.log: $(STRICT_MATH)
	$(call SAY,RUN gate strict_math)
	$Q$(RUN) $@ $(GATE_LIMIT) tests/gates/strict_math.sh $(STRICT_MATH)

# One core of the five: what grows on the others grows there too. `make numbers` measures all.
GROWTH_CYCLES := $(filter $(BUILD)/bench/%-$(GROWTH_CORE).json,$(CYCLES))

$(LOGS)/gates/growth.log: $(GROWTH_VARIANTS:%=$(BUILD)/%/whole) $(BUILD)/firmware/whole $(GROWTH_CYCLES)
	$(call SAY,RUN gate growth)
	$Q$(RUN) $@ $(GATE_LIMIT) tests/gates/growth.sh '$(BUILD)/$(GROWTH_CORE)-os/' \
	    '$(GROWTH_VARIANTS:%=$(BUILD)/%/) $(BUILD)/firmware/' '$(GROWTH_CYCLES)' '$(BUILD)/$(GROWTH_CORE)/'

$(LOGS)/gates/firmware.log: $(GATE_IMAGES)
	$(call SAY,RUN gate firmware)
	$Q$(RUN) $@ $(GATE_LIMIT) tests/gates/firmware.sh $(GATE_IMAGES)

# The unit tests, and the property tests of what no example foresees. None has threads: their counts would be lost.
COVERAGE_PROPERTIES := prop_cell_costs prop_far_sweep prop_home prop_lattice_way prop_line_path prop_planner prop_planner_large prop_planner_memory prop_planner_scout prop_planner_turns prop_pose_field prop_scan_match prop_segment prop_trajectory_optimiser prop_waypoints
COVERAGE_TESTS      := $(call unit_programs,host-coverage) $(COVERAGE_PROPERTIES:%=$(BUILD)/host-coverage/%)

$(BUILD)/host-coverage/prop_%: $(BUILD)/host-coverage/tests/property/prop_%.o $(UNITY_SOURCE:%=$(BUILD)/host-coverage/unity.o) \
                               $(BUILD)/host/libsupport.a $(BUILD)/host/libsim.a $(BUILD)/host/libcan_float.a $(BUILD)/host/libcan.a \
                               $(BUILD)/host-coverage/libjoulepath_float.a $(BUILD)/host-coverage/libjoulepath.a
	$(call link_host,host-coverage)

$(LOGS)/gates/coverage.log: $(COVERAGE_TESTS)
	$(call SAY,RUN gate coverage)
	$Q$(RUN) $@ $(GATE_LIMIT) tests/gates/coverage.sh $^

$(LOGS)/gates/%.log: tests/gates/%.sh | $(LCM_HEADERS)
	$(call SAY,RUN gate $*)
	$Q$(RUN) $@ $(GATE_LIMIT) $<

# shown GATE: its results without what passed.
define shown
	@mkdir -p $(BUILD) && tests/gates/$1.sh $2 >$(BUILD)/$1.txt; status=$$?; grep -v ':PASS$$' $(BUILD)/$1.txt; exit $$status
endef

.PHONY: coverage
coverage: export PAGES := yes
coverage: ## lines and branches of src/ that the host tests take: a table, each line in build/coverage/index.html
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(COVERAGE_TESTS)
	$(call shown,coverage,$(COVERAGE_TESTS))

.PHONY: misra
misra: ## check include/ and src/ for MISRA C:2012 and print what is deviated from, how often and why
	@tools/setup.sh test
	$(call shown,misra)

.PHONY: analyse
analyse: ## follow every path of the library, the HAL and the simulator with clang's static analyser (ten minutes)
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(LCM_HEADERS)
	$(call shown,analyse)
