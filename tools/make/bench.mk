# Measure: benches, figures, sizes, stacks and instructions of the cores.

# What is measured on each core: sizes in the builds for size, instructions in those for speed, and of the stack the worst
# of both.
SIZE_IMAGES  := $(SIZE_VARIANTS:%=$(BUILD)/%/whole)
STACK_IMAGES := $(SIZE_IMAGES) $(SPEED_VARIANTS:%=$(BUILD)/%/whole) $(BUILD)/firmware/whole
CYCLES       := $(foreach b,$(filter-out $(FLOAT_BENCHES),$(TARGET_BENCHES)),$(SPEED_VARIANTS:%=$(BUILD)/bench/$b-%.json)) \
                $(foreach b,$(FLOAT_BENCHES),$(FPU_CORES:%=$(BUILD)/bench/$b-%.json))

define target_bench_rules
$(BUILD)/$1/target_%: $(BUILD)/$1/tests/bench/target_%.o $(call support,$1) $(BUILD)/$1/tests/support/scene.o $(BUILD)/$1/libdrivers.a \
                      $(BUILD)/$1/libcan.a $(call float_library,$1) $(BUILD)/$1/libjoulepath.a
	$$(call link_target,$1)

$(BUILD)/bench/target_%-$1.json: $(BUILD)/$1/target_%
	@mkdir -p $$(@D)
	$$(call SAY,BENCH $$<)
	$$Q$(RUN.$1) $$< $(COUNTING) >$$@ 2>&1 </dev/null
endef
$(foreach v,$(SPEED_VARIANTS),$(eval $(call target_bench_rules,$v)))

# The whole library and what it needs of the compiler's, to be measured and not to be run. It is larger than the flash of the
# Cortex-M0's board.
WHOLE_BOARD.cortex-m0 := $(BOARD.cortex-m0-o2)

define whole_rules
$(BUILD)/$1/tests/target/whole.o: MODULE_FLAGS = -g -fno-eliminate-unused-debug-types

$(BUILD)/$1/whole: $(BUILD)/$1/tests/target/whole.o $(call support,$1) $(BUILD)/$1/libcan.a $(call float_library,$1) $(BUILD)/$1/libjoulepath.a
	@mkdir -p $$(@D)
	$$(call SAY,LD $$@)
	$$Q$$(COMPILER.$1) $(FLAGS.$1) -nostartfiles $(if $(filter cortex%,$1),--specs=nano.specs) -Wl,--no-gc-sections \
	    -Ltests/target -Ttests/target/$(or $(WHOLE_BOARD.$1),$(BOARD.$1)).ld -Wl,--whole-archive $$(filter %.o %.a,$$^) -Wl,--no-whole-archive -o $$@
endef
$(foreach v,$(sort $(SPEED_VARIANTS) $(SIZE_VARIANTS)),$(eval $(call whole_rules,$v)))

# The image of the board, of whose objects some are apart from the others.
$(BUILD)/firmware/whole: $(BUILD)/firmware/courier24/joulepath.elf
	@cp $(<D)/*.ci $(@D)
	@cp $< $@

# Maps of others, where they are. MovingAI cells become as large as lets the robot through and the map fit.
DATA ?= ../shared/data
MAPS := $(patsubst $(DATA)/%,$(BUILD)/maps/%.json,$(wildcard $(DATA)/*.map $(DATA)/*.yaml))

$(BUILD)/maps/Berlin_1_256.map.json: CELL_SIZE = 0.8
CELL_SIZE = 1

$(BUILD)/maps/%.map.json: $(DATA)/%.map tools/design/import_map.py
	$Q$(PYTHON) -m tools.design.import_map $< $@ --cell-size $(CELL_SIZE) --resolution 0.2

$(BUILD)/maps/%.yaml.json: $(DATA)/%.yaml tools/design/import_map.py
	$Q$(PYTHON) -m tools.design.import_map $< $@ --resolution 0.2

# The same on cells of 0.1 m, for the navigator.
NAVIGATE_MAPS := $(patsubst $(DATA)/%,$(BUILD)/navigate-maps/%.json,$(wildcard $(DATA)/*.map $(DATA)/*.yaml))

$(BUILD)/navigate-maps/%.map.json: $(DATA)/%.map tools/design/import_map.py
	@mkdir -p $(@D)
	$Q$(PYTHON) -m tools.design.import_map $< $@ --cell-size 0.8 --resolution 0.1

$(BUILD)/navigate-maps/%.yaml.json: $(DATA)/%.yaml tools/design/import_map.py
	@mkdir -p $(@D)
	$Q$(PYTHON) -m tools.design.import_map $< $@ --resolution 0.1

.PHONY: bench-plan
bench-plan: ## measure the planner on the 20 scenes, beside its peers, and on MAPS="a.json…"
	@tools/setup.sh test bench
	@$(MAKE) $(PARALLEL) $(BUILD)/bench/bench_plan $(MAPS)
	@mkdir -p $(BUILD)/bench-plan
	$(BUILD)/bench/bench_plan --rows $(BUILD)/bench-plan/rows.json $(MAPS) >$(BUILD)/bench/bench_plan.json
	$(PYTHON) -m tools.measure.bench_plan $(BUILD)/bench-plan/rows.json $(BUILD)/bench/bench_plan.tables.json

.PHONY: tutorial
tutorial: ## do what tools/TUTORIAL.md says in a fresh copy, and measure each step (10 minutes)
	@tools/setup.sh test firmware
	@mkdir -p $(BUILD)/tutorial
	$(PYTHON) -m tools.measure.bench_tutorial

.PHONY: bench-maps
bench-maps: ## measure the planner on MAPS="a.json…" (tools/design/import_map.py) and LATTICES="b.json…" (make lattice FILE=…)
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(BUILD)/bench/bench_maps
	@mkdir -p $(BUILD)/bench-plan
	$(BUILD)/bench/bench_maps --rows $(BUILD)/bench-plan/maps.json $(LATTICES:%=--lattice %) $(MAPS) >$(BUILD)/bench/bench_maps.json

.PHONY: bench-mujoco
bench-mujoco: ## drive the robots in MuJoCo: missions, slopes, steps, poor parts, pushes, forecasts that learn (30 minutes)
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) all
	@mkdir -p $(BUILD)/bench
	$(PYTHON) -m tools.measure.bench_mujoco

.PHONY: bench-navigate
bench-navigate: ## measure the navigator: 1 000 drives on dense maps with boxes that they do not show, twice, and on maps of others (6 minutes)
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) all $(BUILD)/bench/bench_navigate $(NAVIGATE_MAPS)
	$(BUILD)/bench/bench_navigate >$(BUILD)/bench/bench_navigate.json
	$(if $(NAVIGATE_MAPS),$(PYTHON) -m tools.measure.bench_navigate $(NAVIGATE_MAPS))

.PHONY: bench-home
bench-home: ## measure robots that come home on what is in their battery: trips at the border of the return map, and in use (20 minutes)
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(BUILD)/bench/bench_home
	$(BUILD)/bench/bench_home >$(BUILD)/bench/bench_home.json

.PHONY: bench-return-map
bench-return-map: ## count the instructions of a return map of 300 × 300 cells on an emulated Cortex-M7 (half a minute)
	@tools/setup.sh test firmware
	@$(MAKE) $(PARALLEL) $(BUILD)/bench/target_return_map-cortex-m7.json

.PHONY: bench-image
bench-image: ## measure the navigator of the firmware's image: 20 drives in QEMU, 100 in process, a million ticks, memory (35 minutes)
	@tools/setup.sh sil operate firmware
	@$(MAKE) $(PARALLEL) all $(BUILD)/bench/bench_cuts \
	    $(addprefix $(BUILD)/firmware/,courier24/joulepath.elf courier24/emulated.elf bench_planning)
	$(BUILD)/bench/bench_cuts >$(BUILD)/bench/bench_cuts.json
	$(PLANNING_CLOCK) $(BUILD)/firmware/bench_planning >$(BUILD)/bench/image_ticks.json 2>&1 </dev/null
	$(PYTHON) -m tools.measure.bench_image

.PHONY: bench-patrol
bench-patrol: ## measure the patrol robot on its scenes, beside path following, and pure pursuit on paths
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(addprefix $(BUILD)/bench/,bench_patrol bench_joules bench_pursuit)
	@mkdir -p $(BUILD)/bench-patrol
	$(BUILD)/bench/bench_patrol --rows $(BUILD)/bench-patrol/scenes.json >$(BUILD)/bench/bench_patrol.json
	$(BUILD)/bench/bench_joules >$(BUILD)/bench/bench_joules.json
	$(BUILD)/bench/bench_pursuit --rows $(BUILD)/bench-patrol/courses.json >$(BUILD)/bench/bench_pursuit.json
	$(PYTHON) -m tools.measure.bench_patrol $(BUILD)/bench-patrol/scenes.json $(BUILD)/bench-patrol/courses.json \
	    $(BUILD)/bench/bench_patrol.tables.json

.PHONY: bench-patrol-round
bench-patrol-round: ## measure hours of patrol on a battery: three simulated hours among people (five minutes)
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(BUILD)/bench/bench_patrol_round
	$(BUILD)/bench/bench_patrol_round --rows $(BUILD)/bench/patrol_round_rows.json >$(BUILD)/bench/bench_patrol_round.json

# Not among the figures: it takes too long. Another time, from another seed on: DAY='2 7001'.
.PHONY: drive-day
drive-day: ## let two patrol robots go round among people for a day (DAY='hours first-seed'; ten minutes)
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(BUILD)/bench/day_drives
	$(BUILD)/bench/day_drives $(DAY) >$(BUILD)/bench/day_drives.json

# Not among the figures: it takes too long. Another number of drives, from another seed on: DRIVES='300 1'.
.PHONY: drive-people
drive-people: ## drive the patrol robot 10 000 times among people who do not look (DRIVES='number first-seed')
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(BUILD)/bench/people_drives
	$(BUILD)/bench/people_drives $(DRIVES) >$(BUILD)/bench/people_drives.json

# The finest cells of 0.05, 0.1 and 0.2 m of which the map is at most 1024 wide, where a cell of MovingAI is 1 m.
LOCALISE_MAPS := $(patsubst $(DATA)/%,$(BUILD)/localise-maps/%.json,$(wildcard $(addprefix $(DATA)/,depot.yaml tb3_sandbox.yaml \
                 warehouse-10-20-10-2-1.map room-64-64-8.map)))

$(BUILD)/localise-maps/warehouse-10-20-10-2-1.map.json: CELL = 0.2
$(BUILD)/localise-maps/%.json: CELL = 0.1

$(BUILD)/localise-maps/%.map.json: $(DATA)/%.map tools/design/import_map.py
	@mkdir -p $(@D)
	$Q$(PYTHON) -m tools.design.import_map $< $@ --cell-size 1 --resolution $(CELL)

$(BUILD)/localise-maps/%.yaml.json: $(DATA)/%.yaml tools/design/import_map.py
	@mkdir -p $(@D)
	$Q$(PYTHON) -m tools.design.import_map $< $@ --resolution 0.05

.PHONY: bench-localise
bench-localise: ## measure localisation on maps of others, beside a particle filter
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(BUILD)/bench/bench_localise $(LOCALISE_MAPS)
	$(BUILD)/bench/bench_localise $(LOCALISE_MAPS) >$(BUILD)/bench/bench_localise.json

.PHONY: bench-goals
bench-goals: ## measure the patrol robot to 200 random goals on each map of others, among boxes that it does not show
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(BUILD)/bench/bench_goals $(LOCALISE_MAPS)
	$(BUILD)/bench/bench_goals $(LOCALISE_MAPS) >$(BUILD)/bench/bench_goals.json

.PHONY: bench-patrol-plans
bench-patrol-plans: ## measure what planning by joules brings the patrol robot beside planning by length, driven on maps of others
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(BUILD)/bench/bench_patrol_plans $(LOCALISE_MAPS)
	$(BUILD)/bench/bench_patrol_plans $(LOCALISE_MAPS) >$(BUILD)/bench/bench_patrol_plans.json

.PHONY: bench-skid-drive
bench-skid-drive: ## measure what plans of the skid-steered robot take when they are driven over the 20 scenes (4 minutes)
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(BUILD)/bench/bench_skid_drive
	@mkdir -p $(BUILD)/bench-skid-drive
	$(BUILD)/bench/bench_skid_drive --rows $(BUILD)/bench-skid-drive/rows.json >$(BUILD)/bench/bench_skid_drive.json

.PHONY: bench-limit
bench-limit: ## measure how far above the least energy that exists scenarios and random routes are driven
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) all
	@mkdir -p $(BUILD)/bench
	$(PYTHON) -m tools.measure.bench_limit

.PHONY: bench-logs
bench-logs: ## measure what logs tell of robots whose file is wrong by 20 %, and the forecasts of the corrected file
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) all
	@mkdir -p $(BUILD)/bench
	$(PYTHON) -m tools.measure.bench_logs

.PHONY: bench-robots
bench-robots: ## measure how robots that nobody has seen balance and drive, designed from their data sheets
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) all
	@mkdir -p $(BUILD)/bench
	$(PYTHON) -m tools.measure.bench_robots

.PHONY: bench-intervals
bench-intervals: ## measure how many missions of six robots are inside the intervals that were forecast (30 minutes)
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) all
	@mkdir -p $(BUILD)/bench
	$(PYTHON) -m tools.measure.bench_intervals

.PHONY: bench-restart
bench-restart: ## measure, in real time, a controller that is killed in mid-drive and started again (6 minutes)
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-ecu $(BUILD)/bench/bench_restart
	@mkdir -p $(BUILD)/bench-restart
	$(BUILD)/bench/bench_restart --rows $(BUILD)/bench-restart/rows.json >$(BUILD)/bench/bench_restart.json

.PHONY: bench-skid-bus
bench-skid-bus: ## drive 10 000 random missions of robots that their sides steer, over a faulty bus and with what fails (half an hour)
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(BUILD)/bench/bench_skid_bus
	$(BUILD)/bench/bench_skid_bus >$(BUILD)/bench/bench_skid_bus.json

# The maps of others are left out where they are not.
ARGS.bench_grid = $(if $(wildcard $(DATA)/*.map),--data $(DATA))

# Property tests at bench length.
PROPERTIES := battery battery_filter cells fixed four_wheel four_wheel_plant grid_planner grid_prices horizon patrol_energy planner planner_memory pure_pursuit scan_match segment skid_changes skid_energy skid_odometry skid_plans skid_plant skid_robot store teb
ARGS.battery          = --count 100000000
ARGS.battery_filter   = --count 400 --seed 20261126
ARGS.cells            = --count 200 --seed 20261126
ARGS.fixed            = --count 4294967296
ARGS.four_wheel       = --count 1000000
ARGS.four_wheel_plant = --count 1000
ARGS.grid_planner     = --count 4000
ARGS.grid_prices      = --count 4000 --seed 20261126
ARGS.horizon          = --count 1000
ARGS.planner          = --count 100000
ARGS.planner_memory   = --count 1200
ARGS.pure_pursuit     = --count 400
ARGS.scan_match       = --count 40
ARGS.segment          = --count 10000
ARGS.skid_changes     = --count 25 --seed 20261126
ARGS.skid_odometry    = --count 20
ARGS.skid_plans       = --count 500 --seed 20261126
ARGS.store            = --count 10000
ARGS.teb              = --count 500

# One bench after the other, so that they do not share the cores.
.PHONY: figures
figures: ## run all benches, keep their figures in tests/bench/figures.json and make the pages and pictures of them
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) all $(BENCHES:%=$(BUILD)/bench/%) \
	    $(BUILD)/firmware/gao2018/emulated.elf $(PROPERTIES:%=$(BUILD)/bench/prop_%) $(BUILD)/host-gcc/prop_decoders
	@rm -f $(BUILD)/bench/*.json
	@$(MAKE) bench-plan
	@$(MAKE) bench-patrol
	@$(MAKE) bench-localise
	@$(MAKE) bench-skid-drive
	@$(MAKE) bench-limit
	@$(MAKE) bench-robots
	@$(MAKE) bench-intervals
	@$(MAKE) bench-logs
	@$(MAKE) bench-mujoco
	@$(MAKE) bench-restart
	@$(MAKE) bench-skid-bus
	@$(MAKE) bench-image
	@$(MAKE) bench-page
	@$(MAKE) bench-python
	@$(MAKE) coverage
	@set -e; $(foreach b,$(BENCHES),echo '  BENCH $b'; $(BUILD)/bench/$b $(ARGS.$b) >$(BUILD)/bench/$b.json;)
	@$(MAKE) size stack cycles test-targets bench-return-map
	@set -e; $(foreach p,$(PROPERTIES),echo '  BENCH prop_$p'; $(BUILD)/bench/prop_$p $(ARGS.$p) --json $(BUILD)/bench/$p.json;)
	$(BUILD)/host-gcc/prop_decoders --count 100000000 --json $(BUILD)/bench/decoders.json
	$(PYTHON) -m tools.measure.bench_bus
	$(PYTHON) -m tools.operate.show_frames $(BUILD)/bus/vcan/frames.log --tables $(BUILD)/bench/frames.tables.json
	@rm -f $(ALL_BITS_LOGS)
	@$(MAKE) $(PARALLEL) $(ALL_BITS_LOGS)
	$(PYTHON) -m tools.measure.bits $(ALL_BITS_LOGS) --output $(BUILD)/bench/bits.json
	$(BUILD)/bin/jp-identify sim/robots/gao2018.cfg --output $(BUILD)/identify/gao2018
	$(PYTHON) -m tools.design.identify gao2018 --tables $(BUILD)/identify/gao2018 --bench $(BUILD)/bench/identify.json
	$(PYTHON) -m tools.design.identify gao2018 --energy battery --tables $(BUILD)/identify/gao2018 \
	    --bench $(BUILD)/bench/identify_battery.json
	$(BUILD)/bin/jp-mission sim/scenarios/gao2018_mission.cfg --output $(BUILD)/figures
	$(PYTHON) -m tools.report.report $(BUILD)/figures
	cp $(BUILD)/figures/path.png sim/scenarios/gao2018_mission.png
	$(MAKE) front SCENARIO=sim/scenarios/gao2018_short.cfg
	cp $(BUILD)/front/front.png sim/scenarios/gao2018_short_front.png
	$(MAKE) plan
	cp $(BUILD)/plan/plan.png sim/scenarios/jacksboro_plan.png
	$(MAKE) patrol SCENE=warehouse
	cp $(BUILD)/patrol/patrol.png sim/scenarios/patrol_warehouse.png
	$(MAKE) patrol MAP=$(DATA)/depot.yaml ROUND=sim/scenarios/depot_round.cfg
	cp $(BUILD)/patrol/patrol.png sim/scenarios/depot_round.png
	$(MAKE) navigate SEED=3 START=1.5,1.5,90 GOAL=14,1
	cp $(BUILD)/navigate/navigate.png sim/scenarios/office_navigate.png
	$(MAKE) navigate ROBOT=zhang2018 SEED=1
	cp $(BUILD)/navigate/navigate.png sim/scenarios/jacksboro_navigate.png
	$(MAKE) grounds SEED=1
	cp $(BUILD)/grounds/grounds.png sim/scenarios/yard_grounds.png
	$(MAKE) campaign ROBOT=courier24 SEED=1 MISSIONS=1000 CAMPAIGN='--fresh --bench $(BUILD)/bench/campaign.json'
	cp $(BUILD)/campaign/courier24/campaign.png sim/scenarios/courier24_campaign.png
	$(PYTHON) -m tools.measure.figures; status=$$?; \
	    [ $$status -le 1 ] && $(PYTHON) -m tools.report.front_picture $(BUILD)/plan sim/scenarios/joulepath.png && exit $$status

.PHONY: pages
pages: ## make FIGURES.md, and the figures in the READMEs, of tests/bench/figures.json
	@tools/setup.sh sil
	$(PYTHON) -m tools.measure.figure_pages

define measure
	@tools/setup.sh test
	+@$(MAKE) -s $(PARALLEL) $2
	@$(PYTHON) -m tools.measure.$1 $(if $(filter %-diff,$@),--diff) $(if $(filter %.json,$2),$2,$(dir $2))
endef

.PHONY: size stack cycles size-diff stack-diff cycles-diff
size: ## flash and RAM of each module on five cores
	$(call measure,size,$(SIZE_IMAGES))

stack: ## worst-case stack of each entry point on five cores
	$(call measure,stack,$(STACK_IMAGES))

cycles: ## worst-case instructions on five cores
	$(call measure,cycles,$(CYCLES))

.PHONY: instruction-bounds
instruction-bounds: ## static bounds of the ticks' instructions on a Cortex-M4, beside what was measured
	@tools/setup.sh test
	+@$(MAKE) -s $(PARALLEL) $(addprefix $(BUILD)/cortex-m4/,target_controller target_skid_robot target_four_wheel)
	@$(PYTHON) -m tools.measure.instruction_bound $(BUILD)/cortex-m4

size-diff: ## the same against the last commit's numbers; so stack-diff and cycles-diff
	$(call measure,size,$(SIZE_IMAGES))

stack-diff:
	$(call measure,stack,$(STACK_IMAGES))

cycles-diff:
	$(call measure,cycles,$(CYCLES))

.PHONY: numbers
numbers: size stack cycles ## accept size, stack and cycles as they are now, and make the pages of them
	@$(PYTHON) -m tools.measure.growth --accept
	@$(PYTHON) -m tools.measure.figures $(BUILD)/bench/size.json $(BUILD)/bench/stack.json $(CYCLES)
