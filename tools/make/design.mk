# From a robot file to tables and codecs.

# A new table is declared too.
DECLARE = $(PYTHON) -m tools.design.tables_header

.PHONY: tables
tables: ## declare what is in src/tables/ in include/joulepath/tables.h
	@tools/setup.sh design
	$(DECLARE)

.PHONY: robot
robot: ## all tables of ROBOT=name from sim/robots/name.cfg, tried out; its report: build/robot/name/report.html
	@tools/setup.sh design
	@$(MAKE) $(PARALLEL) $(addprefix $(BUILD)/bin/,jp-robot jp-lattice jp-skid-identify jp-patrol-config jp-four-wheel-identify)
	@$(PYTHON) -m tools.design.robot_design $(ROBOT)

.PHONY: gains
gains: ## design the controller of ROBOT=name: sim/robots/name.cfg to src/tables/robot_name.c
	@tools/setup.sh design
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-robot
	$(PYTHON) -m tools.design.gain_design --initial-energy $(ROBOT)
	@$(DECLARE)

.PHONY: skid-robot
skid-robot: ## design the controller of the skid-steered or differential-drive ROBOT=name: src/tables/skid_robot_name.c
	@tools/setup.sh design
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-robot
	$(PYTHON) -m tools.design.skid_robot $(ROBOT)
	@$(DECLARE)

.PHONY: horizon
horizon: ## make the tables of the transients of ROBOT=name: src/tables/horizon_name.c and horizon_name_battery.c
	@tools/setup.sh design
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-robot
	$(PYTHON) -m tools.design.horizon $(ROBOT)
	@$(DECLARE)

.PHONY: codec
codec: ## make the C codec of the CAN messages from hal/can/joulepath.dbc
	@tools/setup.sh operate
	$(PYTHON) -m tools.design.can_codec

# Of skid steer and differential drive the model is another one.
SKID_TYPES    := skid_steer differential_drive
ROBOT_TYPE     = $(shell sed -n 's/^type = "\(.*\)";$$/\1/p' sim/robots/$(ROBOT).cfg)

.PHONY: identify
identify: ## identify the energy models of ROBOT=name in the simulator: src/tables/energy_name.c, or skid_energy_name.c or four_wheel_energy_name.c with what it can learn
	@$(MAKE) identify_$(if $(filter $(SKID_TYPES),$(ROBOT_TYPE)),skid,$(if $(filter four_wheel,$(ROBOT_TYPE)),four_wheel,balancer))
	@$(DECLARE)

.PHONY: identify_balancer
identify_balancer:
	@tools/setup.sh design
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-robot $(BUILD)/bin/jp-identify
	$(BUILD)/bin/jp-identify sim/robots/$(ROBOT).cfg --output $(BUILD)/identify/$(ROBOT)
	$(PYTHON) -m tools.design.identify $(ROBOT)
	$(PYTHON) -m tools.design.identify $(ROBOT) --energy battery

.PHONY: identify_skid
identify_skid:
	@tools/setup.sh design
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-skid-identify
	$(BUILD)/bin/jp-skid-identify $(ROBOT) --output $(BUILD)/identify/$(ROBOT)
	$(PYTHON) -m tools.design.skid_identify $(ROBOT)

.PHONY: identify_four_wheel
identify_four_wheel:
	@tools/setup.sh design
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-four-wheel-identify
	$(BUILD)/bin/jp-four-wheel-identify $(ROBOT) --output $(BUILD)/identify/$(ROBOT)
	$(PYTHON) -m tools.design.four_wheel_identify $(ROBOT)

# LOG: one file or several. MASS and DISTANCE ("file metres") are what was measured beside; WRITE is the corrected file.
.PHONY: identify-log
identify-log: ## identify the constants of ROBOT=name from a LOG=file of it (MASS=kg DISTANCE="file m" WRITE=file)
	@tools/setup.sh design operate
	@$(MAKE) $(PARALLEL) all
	$(PYTHON) -m tools.identify.log_identify $(ROBOT) $(LOG) $(if $(MASS),--mass $(MASS)) \
	    $(if $(DISTANCE),--distance $(DISTANCE)) $(if $(WRITE),--write $(WRITE))

.PHONY: learning
learning: ## make what ROBOT=name can learn of its energy: src/tables/learning_name.c and learning_name_battery.c
	@tools/setup.sh design
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-robot $(BUILD)/bin/jp-trip
	$(PYTHON) -m tools.design.learning $(ROBOT)
	@$(DECLARE)

.PHONY: lattice
lattice: ## make the state lattice of ROBOT=name: src/tables/lattice_name.c; of FILE=some.mprim: build/lattice/name.json
	@tools/setup.sh design
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-lattice
	$(PYTHON) -m tools.design.lattice $(ROBOT) $(if $(FILE),--import $(FILE) --json $(BUILD)/lattice/$(ROBOT).json)
	@$(DECLARE)

.PHONY: path
path: ## make limits and steering of a path of ROBOT=name, which its sides steer: src/tables/path_limits_name.c, path_drive_name.c
	@tools/setup.sh design
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-robot
	$(PYTHON) -m tools.design.path_table $(ROBOT)
	@$(DECLARE)

.PHONY: battery
battery: ## make the cells of the battery of ROBOT=name from sim/robots/packs/name.cfg: src/tables/battery_name.c
	@tools/setup.sh design
	$(PYTHON) -m tools.design.battery $(ROBOT)
	@$(DECLARE)

PATROL_ROBOT = $(if $(filter file,$(origin ROBOT)),patrol,$(ROBOT))

.PHONY: patrol-config
patrol-config: ## make the C tables of the patrol robot's controller (ROBOT=patrol): src/tables/patrol_name.c
	@tools/setup.sh design
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-patrol-config
	$(PYTHON) -m tools.design.patrol_table $(PATROL_ROBOT)
	@$(DECLARE)
