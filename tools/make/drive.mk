# Look at it: missions, plans, patrols and campaigns in the simulator.

# BUS=vcan or slcan: controller and robot are two programs on a bus; pil: the controller is the image in QEMU.
DRIVE.       = $(BUILD)/bin/jp-mission $(SCENARIO) --output $(BUILD)/sil
DRIVE.slcan  = tools/operate/bus_mission.sh slcan $(SCENARIO) $(BUILD)/sil
DRIVE.pil    = tools/operate/bus_mission.sh pil $(SCENARIO) $(BUILD)/sil
DRIVE.vcan   = tools/operate/with_vcan.sh -- tools/operate/bus_mission.sh vcan $(SCENARIO) $(BUILD)/sil
BUS          ?=

# WORLD=mujoco: another physics in the place of jp-plant, on a bus of its own; CONDITIONS are options of tools.mujoco.mission.
WORLD        ?=
CONDITIONS   ?=
DRIVE.mujoco = $(PYTHON) -m tools.mujoco.mission $(SCENARIO) --output $(BUILD)/sil $(CONDITIONS)

SETUP.slcan  = operate
SETUP.vcan   = vcan
SETUP.pil    = operate firmware
SETUP.mujoco = mujoco
SCENARIO_ROBOT = $(shell sed -n 's/^robot *= *"\(.*\/\)\?\([^"/]*\)\.cfg".*/\2/p' $(SCENARIO))

.PHONY: sil
sil: ## drive the paper's mission (or SCENARIO=file) in the simulator, over BUS=vcan, slcan or pil, or in WORLD=mujoco; report in build/sil
	$(if $(filter-out mujoco,$(WORLD)),$(error WORLD=$(WORLD): must be mujoco, or left out))
	$(if $(and $(WORLD),$(BUS)),$(error WORLD=$(WORLD) has a bus of its own; leave BUS out))
	$(if $(DRIVE.$(BUS)),,$(error BUS=$(BUS): must be vcan, slcan or pil))
	@tools/setup.sh sil $(SETUP.$(or $(WORLD),$(BUS)))
	@$(MAKE) $(PARALLEL) all $(if $(filter pil,$(BUS)),$(BUILD)/firmware/$(SCENARIO_ROBOT)/emulated.elf)
	@rm -rf $(BUILD)/sil
	$(DRIVE.$(or $(WORLD),$(BUS)))
	$(PYTHON) -m tools.report.report $(BUILD)/sil
	$(if $(WORLD)$(BUS),$(PYTHON) -m tools.operate.show_frames $(BUILD)/sil/frames.log)

.PHONY: front
front: ## energy over time of a route (SCENARIO=file): foretold, driven, the least that exists; picture in build/front
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-front $(BUILD)/bin/jp-robot
	@rm -rf $(BUILD)/front
	$(BUILD)/bin/jp-front $(SCENARIO) --output $(BUILD)/front
	$(PYTHON) -m tools.measure.time_front $(BUILD)/front
	$(PYTHON) -m tools.report.time_front_picture $(BUILD)/front

# The skid-steered robot plans unless another one is asked for. IMPORT holds options of tools.design.import_map, such
# as --cell-size 1 for a MovingAI map, a --window, or the --resolution of LATTICE.
PLAN_ROBOT = $(if $(filter file,$(origin ROBOT)),zhang2018,$(ROBOT))
PLAN_TASK  = $(if $(START),--start=$(START)) $(if $(GOAL),--goal=$(GOAL)) $(if $(LATTICE),--lattice $(LATTICE))
MAP       ?= jacksboro

.PHONY: plan
plan: ## plan over a map (MAP=file START=x,y,deg GOAL=x,y ROBOT=name LATTICE=file IMPORT=options) and write the report to build/plan
	@tools/setup.sh design
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-plan
	@rm -rf $(BUILD)/plan
	$(PYTHON) -m tools.design.import_map $(MAP) $(BUILD)/plan/map.json --resolution 0.2 $(IMPORT)
	$(BUILD)/bin/jp-plan $(BUILD)/plan/map.json --robot sim/robots/$(PLAN_ROBOT).cfg $(PLAN_TASK) \
	    --output $(BUILD)/plan; status=$$?; \
	    [ $$status -le 1 ] && $(PYTHON) -m tools.report.plan_report $(BUILD)/plan && exit $$status

# NAVIGATE holds options of jp-navigate, such as --hidden 12 or --view 1.5. BUS=in-process: map, goal and what it sees go
# to the firmware's application in frames; pil: to the image in QEMU.
NAVIGATE.           = $(BUILD)/bin/jp-navigate
NAVIGATE.in-process = $(BUILD)/bin/jp-navigate --bus in-process --frames
NAVIGATE.pil        = tools/operate/navigate_in_qemu.sh $(NAVIGATE_ROBOT)
NAVIGATE_ROBOT = $(if $(filter file,$(origin ROBOT)),courier24,$(ROBOT))
# A robot for rough ground finds its way over hills, the others in an office. It refuses by itself what is too steep for it.
NAVIGATE_HILLS = $(filter zhang2018,$(NAVIGATE_ROBOT))
NAVIGATE_MAP   = $(if $(filter file,$(origin MAP)),$(if $(NAVIGATE_HILLS),jacksboro,sim/scenarios/office.map),$(MAP))
NAVIGATE_IMPORT = $(if $(filter file,$(origin MAP)),$(if $(NAVIGATE_HILLS),--steep 89,--cell-size 0.2),$(IMPORT))
NAVIGATE_ALONG  = --start=198,186,-135 --goal=143,131.5 # the fault
NAVIGATE_TASK   = $(if $(strip $(PLAN_TASK)),$(PLAN_TASK),$(if $(filter file,$(origin MAP)),$(if $(NAVIGATE_HILLS),$(NAVIGATE_ALONG))))
NAVIGATE_CELL   = $(shell sed -n 's/^ *cell_m *= *\([0-9.]*\);.*/\1/p' sim/robots/$(NAVIGATE_ROBOT).cfg)

.PHONY: navigate
navigate: ## let ROBOT=courier24, burger or zhang2018 find its way (MAP=file START=x,y,deg GOAL=x,y SEED=1 NAVIGATE=options) among boxes that the map does not show, by itself or over BUS=in-process or pil; report in build/navigate
	$(if $(NAVIGATE.$(BUS)),,$(error BUS=$(BUS): must be in-process or pil))
	@tools/setup.sh design $(SETUP.$(BUS))
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-navigate $(if $(filter pil,$(BUS)),$(BUILD)/firmware/$(NAVIGATE_ROBOT)/emulated.elf)
	@rm -rf $(BUILD)/navigate
	$(PYTHON) -m tools.design.import_map $(NAVIGATE_MAP) $(BUILD)/navigate/map.json --resolution $(or $(NAVIGATE_CELL),0.1) $(NAVIGATE_IMPORT)
	$(NAVIGATE.$(BUS)) $(BUILD)/navigate/map.json --robot sim/robots/$(NAVIGATE_ROBOT).cfg $(NAVIGATE_TASK) \
	    --seed $(SEED) $(NAVIGATE) --output $(BUILD)/navigate; status=$$?; \
	    [ $$status -le 1 ] && $(PYTHON) -m tools.report.navigate_report $(BUILD)/navigate && exit $$status

RESULTS ?= $(BUILD)/sil

.PHONY: foxglove
foxglove: ## make a log for Foxglove and PlotJuggler of RESULTS=build/sil, plan, navigate or patrol, and a layout
	@tools/setup.sh operate
	$(PYTHON) -m tools.report.foxglove_log $(RESULTS)

# A scene from a seed, or a map of others with START and GOAL.
SCENE      ?= beside-obstacle
SEED       ?= 1
PATROL_MAP  = $(if $(filter file,$(origin MAP)),,$(MAP))

.PHONY: patrol
patrol: ## drive the patrol robot (SCENE=name SEED=1, or MAP=file START=x,y,deg GOAL=x,y,deg); report in build/patrol
	@tools/setup.sh sil $(if $(PATROL_MAP),design)
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-patrol
	@rm -rf $(BUILD)/patrol
	$(if $(PATROL_MAP),$(PYTHON) -m tools.design.import_map $(MAP) $(BUILD)/patrol/map.json --resolution 0.05 $(IMPORT))
	$(BUILD)/bin/jp-patrol $(if $(PATROL_MAP),--map=$(BUILD)/patrol/map.json $(PLAN_TASK),$(SCENE)) --seed=$(SEED) \
	    --output $(BUILD)/patrol; status=$$?; \
	    [ $$status -le 1 ] && $(PYTHON) -m tools.report.patrol_report $(BUILD)/patrol && exit $$status

# The courier unless another one is asked for. CAMPAIGN holds options of tools.campaign.campaign, such as
# --faults or --fresh.
CAMPAIGN_ROBOT = $(if $(filter file,$(origin ROBOT)),courier24,$(ROBOT))
MISSIONS      ?= 1000

.PHONY: campaign
campaign: ## run MISSIONS=1000 varied missions of ROBOT=courier24 (SEED=1 SCHEDULER=tcp://host:port CAMPAIGN=options)
	@tools/setup.sh campaign
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-trip
	$(PYTHON) -m tools.campaign.campaign $(CAMPAIGN_ROBOT) --missions $(MISSIONS) --seed $(SEED) \
	    $(if $(SCHEDULER),--scheduler $(SCHEDULER)) $(CAMPAIGN)
