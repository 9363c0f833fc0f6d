# A page in the browser: the same C, compiled to WebAssembly.

PAGE      := $(BUILD)/page
WASM      := $(BUILD)/wasm
WEB       := $(wildcard sim/page/web/*)
PAGE_C    := $(filter-out sim/page/robot_bytes.c,$(wildcard sim/page/*.c))
# Those that are built in.
PAGE_ROBOTS := $(wildcard $(patsubst %,sim/robots/%.cfg,$(ROBOTS) $(SKID_ROBOTS) $(patsubst src/tables/patrol_%.c,%,$(wildcard src/tables/patrol_*.c))))
# Of the simulator what the scenes stand on. What nobody calls in it, such as what reads files, is not linked.
PAGE_SIM  := $(wildcard sim/balancer/*.c sim/skid_steer/*.c sim/four_wheel/*.c sim/scenes/*.c) $(addprefix sim/,$(addsuffix .c, \
             $(addprefix base/,cell_pack clearance digital error fingerprint random strict_math world_fault) \
             $(addprefix missions/,cruise_plan navigation_balancer navigation_sight navigation_skid navigation_task patrol_energy \
                 patrol_mission plan_lattice))) hal/hal.c

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

$(WASM)/page_robots.c: $(BUILD)/host/robot_bytes $(PAGE_ROBOTS) $(BUILD)/robots.c tools/make/page.mk
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

PAGE_FILES := $(WEB:sim/page/web/%=$(PAGE)/%) $(PAGE)/core.wasm.js

.PHONY: page
page: ## make the page in the browser: open build/page/index.html, or put build/page anywhere on the web
	@tools/setup.sh page
	@$(MAKE) $(PARALLEL) $(PAGE_FILES)

# ---- The same for this machine, to compare bits with -----------------------------------------------------------------

NATIVE := $(BUILD)/page-native

COMPILER.page-native = $(CC)
FLAGS.page-native    = $(HOST) -O2 -fPIC -fvisibility=hidden -ffunction-sections -fdata-sections

$(NATIVE)/%.o: %.c tools/make/variants.mk $(SETTINGS)
	$(call compile,page-native)

$(patsubst %.c,$(NATIVE)/%.o,$(FLOAT)): MODULE_FLAGS = $(FLAGS_FLOAT)

$(NATIVE)/%.o: $(BUILD)/%.c
	@mkdir -p $(@D)
	$Q$(COMPILER.page-native) $(COMMON) $(FLAGS.page-native) -c $< -o $@

$(NATIVE)/page_robots.o: $(WASM)/page_robots.c
	@mkdir -p $(@D)
	$Q$(COMPILER.page-native) $(COMMON) $(FLAGS.page-native) -c $< -o $@

PAGE_NATIVE = $(patsubst %.c,$(NATIVE)/%.o,$(PAGE_C) $(PAGE_SIM) $(CORE) $(FLOAT)) $(NATIVE)/robots.o $(NATIVE)/page_robots.o

$(NATIVE)/libpage.so: $(PAGE_NATIVE)
	$(call SAY,LD $@)
	$Q$(COMPILER.page-native) -shared -Wl,--gc-sections -Wl,--no-undefined -Wl,-Bsymbolic $^ -lm -o $@

PAGE_LIBRARY := $(NATIVE)/libpage.so

.PHONY: bench-page
bench-page: ## measure the page: size, first frame, speed, bits; and make its picture
	@tools/setup.sh test
	@$(MAKE) $(PARALLEL) $(PAGE_FILES) $(PAGE_LIBRARY)
	$(PYTHON) tests/page/bench_page.py
	$(PYTHON) tests/page/picture.py sim/page/page.png
