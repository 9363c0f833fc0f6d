# Fuzzing: clang's libFuzzer looks for inputs that take new branches.

# In `make test` a target runs on its seeds and so many other inputs, the same each time: some seconds' worth.
FUZZ_RUNS                  ?= 6000
FUZZ_RUNS.balancer          = 1500
FUZZ_RUNS.balancer_ecu      = 300
FUZZ_RUNS.four_wheel_robot  = 1500
FUZZ_RUNS.home              = 400
FUZZ_RUNS.lattice           = 1500
FUZZ_RUNS.line_path         = 2000
FUZZ_RUNS.localiser         = 200
FUZZ_RUNS.map_stream        = 2000
FUZZ_RUNS.patrol            = 1200
FUZZ_RUNS.patrol_ecu        = 120
FUZZ_RUNS.pilot             = 2000
FUZZ_RUNS.planner           = 800
FUZZ_RUNS.robot_file        = 1500
FUZZ_RUNS.scenario          = 2500
FUZZ_RUNS.skid_ecu          = 400
FUZZ_RUNS.skid_parts        = 800
FUZZ_SEED                  ?= 1
FUZZ_LIMIT                 ?= 180

FUZZ := $(BUILD)/fuzz
FUZZ_PROGRAMS = $(FUZZ_TARGETS:%=$(BUILD)/host-fuzz/%)

$(BUILD)/host-fuzz/fuzz_%: $(BUILD)/host-fuzz/tests/fuzz/fuzz_%.o $(call host_libraries,host-fuzz)
	@mkdir -p $(@D)
	$(call SAY,LD $@)
	$Q$(COMPILER.host-fuzz) $(FLAGS.host-fuzz) -fsanitize=fuzzer $(filter %.o,$^) $(filter %.a,$^) $(LIBRARIES) -o $@

$(LOGS)/host-fuzz/fuzz_%.log: $(BUILD)/host-fuzz/fuzz_% tools/measure/fuzz.py
	$(call SAY,RUN $<)
	$Q$(RUN) $@ $(FUZZ_LIMIT) $(PYTHON) -m tools.measure.fuzz --folder $(FUZZ)/short --runs $(or $(FUZZ_RUNS.$*),$(FUZZ_RUNS)) --seed $(FUZZ_SEED) $<

SECONDS ?= 60
TARGET  ?=
FUZZED   = $(if $(TARGET),$(TARGET:%=$(BUILD)/host-fuzz/fuzz_%),$(FUZZ_PROGRAMS))

.PHONY: fuzz
fuzz: ## look SECONDS=60 long for inputs that break each target of tests/fuzz, or TARGET=name; finds are in build/fuzz
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(FUZZED)
	$Q$(PYTHON) -m tools.measure.fuzz --folder $(FUZZ) --seconds $(SECONDS) --json $(FUZZ)/fuzz.json $(FUZZED)
