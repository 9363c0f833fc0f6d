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
# A robot for rough ground finds its way over hills, the others in an office; no elevations go over the bus. It refuses by
# itself what is too steep for it.
NAVIGATE_HILLS = $(if $(BUS),,$(filter zhang2018,$(NAVIGATE_ROBOT)))
NAVIGATE_MAP   = $(if $(filter file,$(origin MAP)),$(if $(NAVIGATE_HILLS),jacksboro,sim/scenarios/office.map),$(MAP))
NAVIGATE_IMPORT = $(if $(filter file,$(origin MAP)),$(if $(NAVIGATE_HILLS),--steep 89,--cell-size 0.2),$(IMPORT))
NAVIGATE_ALONG  = --start=198,186,-135 --goal=143,131.5 # the fault
NAVIGATE_TASK   = $(if $(strip $(PLAN_TASK)),$(PLAN_TASK),$(if $(filter file,$(origin MAP)),$(if $(NAVIGATE_HILLS),$(NAVIGATE_ALONG))))
NAVIGATE_CELL   = $(shell sed -n 's/^ *cell_m *= *\([0-9.]*\);.*/\1/p' sim/robots/$(NAVIGATE_ROBOT).cfg)

.PHONY: navigate
ifneq ($(filter $(ROBOT),$(PATROL_ROBOTS)),)
# It has a laser of its own, and no lattice.
NAVIGATE_PATROL_MAP   = $(if $(filter file,$(origin MAP)),$(DATA)/depot.yaml,$(MAP))
NAVIGATE_PATROL_START = 3,3,0
NAVIGATE_PATROL_GOAL  = 25,12,90
NAVIGATE_PATROL_BOXES = --hidden=6
navigate:
	@$(MAKE) $(PARALLEL) patrol MAP=$(NAVIGATE_PATROL_MAP) START=$(or $(START),$(NAVIGATE_PATROL_START)) \
	    GOAL=$(or $(GOAL),$(NAVIGATE_PATROL_GOAL)) NAVIGATE=$(or $(NAVIGATE),$(NAVIGATE_PATROL_BOXES))
else
navigate: ## let ROBOT=name (courier24, burger, zhang2018, patrol or yours) find its way (MAP=file START=x,y,deg GOAL=x,y SEED=1 NAVIGATE=options) among boxes that the map does not show, by itself or over BUS=in-process or pil; report in build/navigate
	$(if $(NAVIGATE.$(BUS)),,$(error BUS=$(BUS): must be in-process or pil))
	@tools/setup.sh design $(SETUP.$(BUS))
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-navigate $(if $(filter pil,$(BUS)),$(BUILD)/firmware/$(NAVIGATE_ROBOT)/emulated.elf)
	@rm -rf $(BUILD)/navigate
	$(PYTHON) -m tools.design.import_map $(NAVIGATE_MAP) $(BUILD)/navigate/map.json --resolution $(or $(NAVIGATE_CELL),0.1) $(NAVIGATE_IMPORT)
	$(NAVIGATE.$(BUS)) $(BUILD)/navigate/map.json --robot sim/robots/$(NAVIGATE_ROBOT).cfg $(NAVIGATE_TASK) \
	    --seed $(SEED) $(NAVIGATE) --output $(BUILD)/navigate; status=$$?; \
	    [ $$status -le 1 ] && $(PYTHON) -m tools.report.navigate_report $(BUILD)/navigate && exit $$status
endif

# REACH holds options of jp-navigate, such as --home 95; BATTERY joules are in the battery.
BATTERY = $(if $(NAVIGATE_HILLS),9000,400)

.PHONY: reach
reach: ## let ROBOT=name (courier24, burger, zhang2018 or yours) drive to a goal and home on BATTERY joules (MAP=file START=x,y,deg GOAL=x,y SEED=1 REACH=options), and draw from where it comes home: picture in build/reach
	@tools/setup.sh design
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-navigate
	@rm -rf $(BUILD)/reach
	$(PYTHON) -m tools.design.import_map $(NAVIGATE_MAP) $(BUILD)/reach/map.json --resolution $(or $(NAVIGATE_CELL),0.1) $(NAVIGATE_IMPORT)
	$(BUILD)/bin/jp-navigate $(BUILD)/reach/map.json --robot sim/robots/$(NAVIGATE_ROBOT).cfg $(NAVIGATE_TASK) \
	    --seed $(SEED) --battery $(BATTERY) $(REACH) --output $(BUILD)/reach; status=$$?; \
	    [ $$status -le 1 ] && $(PYTHON) -m tools.report.reach_picture $(BUILD)/reach && exit $$status

# A yard whose mud takes 2.5 times the rolling resistance, or a map of others with IMPORT, START and GOAL. GROUNDS holds
# options of jp-grounds, such as --trips 10.
GROUNDS_MAP    = $(if $(filter file,$(origin MAP)),sim/scenarios/yard.map,$(MAP))
GROUNDS_IMPORT = $(if $(filter file,$(origin MAP)),--grounds asphalt=1$(comma)1 mud=2.5$(comma)0.8 grass=1.4$(comma)0.9,$(IMPORT))
GROUNDS_TASK   = $(if $(strip $(PLAN_TASK)),$(PLAN_TASK),$(if $(filter file,$(origin MAP)),--start=4$(comma)11$(comma)0 --goal=36$(comma)11))
GROUNDS_ROBOT  = $(if $(filter file,$(origin ROBOT)),zhang2018,$(ROBOT))
comma          = ,

.PHONY: grounds
grounds: ## let ROBOT=name (zhang2018, burger or yours) go again and again over a map of several grounds (MAP=file START=x,y,deg GOAL=x,y SEED=1 GROUNDS=options), and learn what they take; picture in build/grounds
	@tools/setup.sh design
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-grounds
	@rm -rf $(BUILD)/grounds
	$(PYTHON) -m tools.design.import_map $(GROUNDS_MAP) $(BUILD)/grounds/map.json --resolution 0.2 $(GROUNDS_IMPORT)
	$(BUILD)/bin/jp-grounds $(BUILD)/grounds/map.json --robot sim/robots/$(GROUNDS_ROBOT).cfg $(GROUNDS_TASK) --seed $(SEED) \
	    $(GROUNDS) --output $(BUILD)/grounds; status=$$?; \
	    [ $$status -le 1 ] && $(PYTHON) -m tools.report.grounds_picture $(BUILD)/grounds && exit $$status

RESULTS ?= $(BUILD)/sil

.PHONY: foxglove
foxglove: ## make a log for Foxglove and PlotJuggler of RESULTS=build/sil, plan, navigate or patrol, and a layout
	@tools/setup.sh operate
	$(PYTHON) -m tools.report.foxglove_log $(RESULTS)

# A scene from a seed, or a map of others with START and GOAL.
SCENE      ?= beside-obstacle
SEED       ?= 1
# By itself by several methods; or over BUS=in-process: map, goal and what it sees go to the firmware's application in
# frames; pil: to the image in QEMU.
PATROL.           = $(BUILD)/bin/jp-patrol --robot $(PATROL_ROBOT)
PATROL.in-process = $(BUILD)/bin/jp-patrol --robot $(PATROL_ROBOT) --bus in-process
PATROL.pil        = tools/operate/patrol_in_qemu.sh $(PATROL_ROBOT)
PATROL_ROBOT      = $(if $(filter file,$(origin ROBOT)),patrol,$(ROBOT))
PATROL_MAP  = $(if $(filter file,$(origin MAP)),,$(MAP))
PATROL_TASK = $(if $(ROUND),--round=$(ROUND) $(if $(HOURS),--hours=$(HOURS)),$(PLAN_TASK))
# Of a drive over a bus there is no log to draw; of a round there is.
PATROL_DRAWN = $(if $(ROUND),yes,$(if $(BUS),,yes))

.PHONY: patrol
ifeq ($(WORLD),mujoco)
# Over MAP alone: scenes and people are our world's. CONDITIONS are options of tools.mujoco.patrol.
patrol:
	$(if $(PATROL_MAP),,$(error WORLD=mujoco: give MAP, START and GOAL))
	$(if $(BUS),$(error WORLD=$(WORLD) has a bus of its own; leave BUS out))
	@tools/setup.sh design mujoco
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-ecu $(BUILD)/bin/jp-robot
	@rm -rf $(BUILD)/patrol
	$(PYTHON) -m tools.design.import_map $(MAP) $(BUILD)/patrol/map.json --resolution 0.05 $(IMPORT)
	$(PYTHON) -m tools.mujoco.patrol $(BUILD)/patrol/map.json $(PLAN_TASK) --robot $(PATROL_ROBOT) --seed $(SEED) \
	    --output $(BUILD)/patrol $(CONDITIONS)
else
patrol: ## drive the patrol robot, or ROBOT=name (SCENE=name SEED=1, or MAP=file START=x,y,deg GOAL=x,y,deg, or for HOURS=0.25 MAP=file ROUND=file), by itself or over BUS=in-process or pil, or over a MAP in WORLD=mujoco; report in build/patrol
	$(if $(WORLD),$(error WORLD=$(WORLD): must be mujoco, or left out))
	$(if $(PATROL.$(BUS)),,$(error BUS=$(BUS): must be in-process or pil))
	$(if $(ROUND),$(if $(PATROL_MAP),,$(error ROUND=$(ROUND): goes over a map; give MAP)))
	@tools/setup.sh sil $(if $(PATROL_MAP),design) $(SETUP.$(BUS))
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-patrol $(if $(filter pil,$(BUS)),$(BUILD)/firmware/$(PATROL_ROBOT)/emulated.elf)
	@rm -rf $(BUILD)/patrol
	$(if $(PATROL_MAP),$(PYTHON) -m tools.design.import_map $(MAP) $(BUILD)/patrol/map.json --resolution 0.05 $(IMPORT))
	$(PATROL.$(BUS)) $(if $(PATROL_MAP),--map=$(BUILD)/patrol/map.json $(PATROL_TASK) $(NAVIGATE),$(SCENE)) --seed=$(SEED) \
	    --output $(BUILD)/patrol; status=$$?; \
	    [ $$status -le 1 ] && $(if $(PATROL_DRAWN),$(PYTHON) -m tools.report.patrol_report $(BUILD)/patrol,true) && exit $$status
endif

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
