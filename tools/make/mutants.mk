# How good the tests are: conditions that they show to matter, faults in the code that they notice, faults of the robot that
# they inject.

# A room of tests/proof/rooms.yaml, a folder or a source; without, all rooms that can hurt someone.
ROOM ?=
CHOSEN_ROOMS = $(foreach r,$(ROOM),--room $r)

MCDC_TESTS     := $(call unit_programs,host-mcdc)

.PHONY: mcdc
mcdc: ## MC/DC of the rooms that can hurt someone, or of ROOM="balancer src/map …", by their unit tests (clang 19)
	@tools/setup.sh test mcdc
	@$(MAKE) $(PARALLEL) mcdc_tests
	$Q$(PYTHON) -m tools.measure.mcdc $(CHOSEN_ROOMS) --jobs $(JOBS) --json $(BUILD)/bench/mcdc.json \
	    --objects $(BUILD)/host-mcdc $(MCDC_TESTS)

.PHONY: mcdc_tests
mcdc_tests: $(MCDC_TESTS)

# ---- Mutants ---------------------------------------------------------------------------------------------------------

# In a library of its own, so that a mutant takes the place of its functions.
MUTANT_LIBRARY := $(BUILD)/host-mutants/libcore.so
MUTANT_TESTS   := $(call unit_programs,host-mutants)
# Of equal bits: they notice what the unit tests do not, but not what is right.
MUTANT_HASHES  := $(patsubst tests/bits/%.c,$(BUILD)/host-mutants/%,$(BITS_TESTS))

$(MUTANT_LIBRARY): $(patsubst %.c,$(BUILD)/host-mutants/%.o,$(CORE) $(FLOAT) $(CAN) $(CAN_FLOAT)) $(MEMBERS)
	@mkdir -p $(@D)
	$(call SAY,LD $@)
	$Q$(COMPILER.host-mutants) -shared $(GOLD) $(filter %.o,$^) -o $@

$(foreach t,$(UNIT_TESTS) $(FLOAT_TESTS),$(eval $(call unit_object,host-mutants,$t)))

$(MUTANT_HASHES): $(BUILD)/host-mutants/%: $(BUILD)/host-mutants/tests/bits/%.o $(BUILD)/host-mutants/tests/support/scene.o

$(MUTANT_TESTS) $(MUTANT_HASHES): $(if $(UNITY_SOURCE),$(BUILD)/host-mutants/unity.o) $(BUILD)/host-mutants/libdrivers.a $(MUTANT_LIBRARY)
	@mkdir -p $(@D)
	$(call SAY,LD $@)
	$Q$(COMPILER.host-mutants) $(FLAGS.host-mutants) $(GOLD) $(filter %.o,$^) $(filter %.a,$^) $(MUTANT_LIBRARY) \
	    -Wl,-rpath,$(abspath $(@D)) -Wl,--allow-shlib-undefined -lm -o $@

MUTANT_FOLDER ?= $(BUILD)/mutants

# Every so many mutants of each room instead of all: SAMPLE=200.
SAMPLE ?=
SEED   ?= 1
# Of what is measured, a row in tests/proof/MUTANTS.md: RECORD=1.
RECORD ?=
# Only the unit tests of this folder judge, so that it is quicker and what is killed a lower bound: JUDGES=map.
JUDGES ?=

MUTANT_JUDGES = $(filter $(if $(JUDGES),$(basename $(notdir $(wildcard tests/unit/$(JUDGES)/*.c))),%),$(notdir $(MUTANT_TESTS)))

.PHONY: mutants
mutants: ## faults put into the rooms that can hurt someone, or into ROOM="balancer src/map …": which do the unit tests notice?
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) mutant_tests
	$Q$(PYTHON) -m tools.measure.mutants $(CHOSEN_ROOMS) --jobs $(JOBS) $(if $(SAMPLE),--sample $(SAMPLE) --seed $(SEED)) \
	    $(if $(RECORD),--record tests/proof/MUTANTS.md) $(if $(JUDGES),--judges $(JUDGES)) \
	    --build $(BUILD)/host-mutants --counting $(BUILD)/host-coverage --folder $(MUTANT_FOLDER) --json $(BUILD)/bench/mutants.json \
	    --flags '-std=c11 -Iinclude -I. -I$(UNITY) $(HOST)' --headers '$(shell gcc -print-file-name=include)' \
	    $(if $(JUDGES),,$(foreach t,$(notdir $(MUTANT_HASHES)),--hash $t)) $(MUTANT_JUDGES)

.PHONY: mutant_tests
mutant_tests: $(MUTANT_TESTS) $(MUTANT_HASHES) $(call unit_programs,host-coverage) $(MUTANT_HASHES:$(BUILD)/host-mutants/%=$(BUILD)/host-coverage/%)

# ---- The matrix of faults --------------------------------------------------------------------------------------------

FAULT_MATRICES := $(patsubst tests/fault/%.c,$(BUILD)/host-gcc/%,$(wildcard tests/fault/fault_matrix_*.c))

.PHONY: faults
faults: $(FAULT_MATRICES) ## make tests/FAULTS.md: every fault in every state on every transport, by which test, and what is seen
	$Q$(PYTHON) -m tools.measure.fault_matrix $(FAULT_MATRICES)

# Its page is proved fresh there.
$(LOGS)/pytest/tools.xml: $(FAULT_MATRICES)
