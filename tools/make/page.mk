# A page in the browser: the same C, compiled to WebAssembly.

PAGE      := $(BUILD)/page
WASM      := $(BUILD)/wasm
WEB       := $(wildcard sim/page/web/*)
PAGE_C    := $(filter-out sim/page/robot_bytes.c,$(wildcard sim/page/*.c))
PAGE_ROBOTS := $(addprefix sim/robots/,gao2018.cfg courier24.cfg zhang2018.cfg burger.cfg patrol.cfg)
# Of the simulator what reads no files and draws on nothing but C's library.
PAGE_SIM  := $(addprefix sim/,$(addsuffix .c, \
             base/clearance base/digital base/error base/fingerprint base/random base/world_fault \
             balancer/energy_unit balancer/fault_names balancer/hal_sim balancer/instruments balancer/plant balancer/rig \
             balancer/world missions/cruise_plan missions/navigation_balancer missions/navigation_sight missions/navigation_skid \
             four_wheel/four_wheel_plant four_wheel/laser four_wheel/patrol_config four_wheel/patrol_members four_wheel/solid_map four_wheel/four_wheel_drive four_wheel/four_wheel_file \
             missions/navigation_task missions/patrol_energy missions/patrol_mission missions/plan_lattice scenes/patrol_draft scenes/patrol_scene scenes/patrol_world skid_steer/skid_ground skid_steer/skid_hal_sim \
             skid_steer/skid_instruments skid_steer/skid_plant skid_steer/skid_robots skid_steer/skid_steer_model \
             skid_steer/skid_world)) hal/hal.c

COMPILER.wasm = clang --target=wasm32-wasi
FLAGS.wasm    = $(HOST) -O2
MODULE        = -mexec-model=reactor -Wl,--gc-sections -Wl,--strip-all -Wl,-z,stack-size=1048576

$(WASM)/%.o: %.c tools/make/variants.mk $(SETTINGS)
	$(call compile,wasm)

$(patsubst %.c,$(WASM)/%.o,$(FLOAT)): MODULE_FLAGS = $(FLAGS_FLOAT)

$(WASM)/robots.o: $(BUILD)/robots.c
	@mkdir -p $(@D)
	$Q$(COMPILER.wasm) $(COMMON) $(FLAGS.wasm) -c $< -o $@

# The robots' constants, as C.
$(BUILD)/host/robot_bytes: $(BUILD)/host/sim/page/robot_bytes.o $(call host_libraries,host)
	$(call link_host,host)

$(WASM)/page_robots.c: $(BUILD)/host/robot_bytes $(PAGE_ROBOTS)
	@mkdir -p $(@D)
	$Q$< $(PAGE_ROBOTS) >$@

$(WASM)/page_robots.o: $(WASM)/page_robots.c
	$Q$(COMPILER.wasm) $(COMMON) $(FLAGS.wasm) -c $< -o $@

$(WASM)/joulepath.wasm: $(patsubst %.c,$(WASM)/%.o,$(PAGE_C) $(PAGE_SIM) $(CORE) $(FLOAT)) $(WASM)/robots.o $(WASM)/page_robots.o
	$(call SAY,LD $@)
	$Q$(COMPILER.wasm) $(FLAGS.wasm) $(MODULE) $^ -o $@

# In a script, because a page that is opened from a disk may not read other files.
$(PAGE)/core.wasm.js: $(WASM)/joulepath.wasm
	@mkdir -p $(@D)
	$Q{ printf 'const coreWasm = "'; base64 -w 0 $<; printf '";\n'; } >$@

$(PAGE)/%: sim/page/web/%
	@mkdir -p $(@D)
	@cp $< $@

PAGE_FILES = $(WEB:sim/page/web/%=$(PAGE)/%) $(PAGE)/core.wasm.js

.PHONY: page
page: ## make the page in the browser: open build/page/index.html, or put build/page anywhere on the web
	@tools/setup.sh page
	@$(MAKE) $(PARALLEL) $(PAGE_FILES)
