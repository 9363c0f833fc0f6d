# Rules: objects, libraries and host programs.

# Objects are made again when the compiler, Unity or the navigator's sizes of the last build were others.
SETTINGS := $(BUILD)/settings
$(SETTINGS): FORCE
	@mkdir -p $(@D) && echo '$(CC) $(UNITY) $(SIDE) $(PLANNER) $(CELLS)' | cmp -s - $@ || echo '$(CC) $(UNITY) $(SIDE) $(PLANNER) $(CELLS)' >$@

# A library is made again when a source joined or left it.
MEMBERS := $(BUILD)/members
$(MEMBERS): FORCE
	@mkdir -p $(@D) && echo '$(CORE) $(FLOAT) $(CAN) $(CAN_FLOAT) $(DRIVERS) $(SIM) $(SUPPORT)' | cmp -s - $@ || echo '$(CORE) $(FLOAT) $(CAN) $(CAN_FLOAT) $(DRIVERS) $(SIM) $(SUPPORT)' >$@

# core_name VARIANT: as people write it.
core_name = $(patsubst rv%,RV%,$(patsubst cortex-m%,Cortex-M%,$(firstword $(subst -o, ,$1))))

# What calls the tests of a file is made of it.
$(BUILD)/runners/%.c: %.c tools/make/runner.sh
	@mkdir -p $(@D)
	@tools/make/runner.sh $< >$@

define compile
	@mkdir -p $(@D)
	$(call SAY,CC $@)
	$Q$(COMPILER.$1) $(COMMON) $(FLAGS.$1) $(MODULE_FLAGS) $(if $(BOARD.$1),-DTARGET_CORE='"$(call core_name,$1)"') -c $< -o $@
endef

define variant_rules
$(BUILD)/$1/%.o: %.c tools/make/variants.mk $(SETTINGS) $(if $(filter host%,$1),| $(LCM_HEADERS))
	$$(call compile,$1)

$(TESTS:%.c=$(BUILD)/$1/%.o): $(BUILD)/$1/%.o: $(BUILD)/runners/%.c tools/make/variants.mk $(SETTINGS) $(if $(filter host%,$1),| $(LCM_HEADERS))
	$$(call compile,$1)

$(patsubst %.c,$(BUILD)/$1/%.o,$(FLOAT) $(CAN_FLOAT)): MODULE_FLAGS = $(FLAGS_FLOAT)
$(patsubst %.c,$(BUILD)/$1/%.o,$(UNIT_TESTS)): MODULE_FLAGS = $(FLAGS_TESTS)
$(patsubst %.c,$(BUILD)/$1/%.o,$(FLOAT_TESTS)): MODULE_FLAGS = $(FLAGS_FLOAT) $(FLAGS_TESTS)

$(BUILD)/$1/libjoulepath_float.a: $(FLOAT:%.c=$(BUILD)/$1/%.o) $(MEMBERS)
	$$(call archive)

$(BUILD)/$1/libjoulepath.a: $(CORE:%.c=$(BUILD)/$1/%.o) $(MEMBERS)
	$$(call archive)

$(BUILD)/$1/libcan.a: $(CAN:%.c=$(BUILD)/$1/%.o) $(MEMBERS)
	$$(call archive)

$(BUILD)/$1/libcan_float.a: $(CAN_FLOAT:%.c=$(BUILD)/$1/%.o) $(MEMBERS)
	$$(call archive)

# On fake registers: first, because one of them also stands in for wait.c.
$(BUILD)/$1/libdrivers.a: $(BUILD)/$1/tests/support/stm32_fake.o $(DRIVERS:%.c=$(BUILD)/$1/%.o) $(MEMBERS)
	$$(call archive)

$(BUILD)/$1/lcm/%.o: $(BUILD)/lcm/%.h
	@mkdir -p $$(@D)
	$$Q$$(COMPILER.$1) $$(COMMON) $$(FLAGS.$1) -w -c $(BUILD)/lcm/$$*.c -o $$@

$(BUILD)/$1/libsupport.a: $(SUPPORT:%.c=$(BUILD)/$1/%.o) $(MEMBERS)
	$$(call archive)

$(BUILD)/$1/libsim.a: $(SIM:%.c=$(BUILD)/$1/%.o) $(LCM_TYPES:%=$(BUILD)/$1/lcm/%.o) $(BUILD)/$1/robots.o $(MEMBERS)
	$$(call archive)

$(BUILD)/$1/robots.o: $(BUILD)/robots.c
	@mkdir -p $$(@D)
	$$Q$$(COMPILER.$1) $$(COMMON) $$(FLAGS.$1) -c $$< -o $$@

$(BUILD)/$1/unity.o: $(UNITY_SOURCE) $(SETTINGS)
	@mkdir -p $$(@D)
	$$Q$$(COMPILER.$1) $$(COMMON) $$(FLAGS.$1) -w -c $$< -o $$@
endef
$(foreach v,$(VARIANTS),$(eval $(call variant_rules,$v)))

# `q` keeps members of one name from two directories apart.
define archive
	@mkdir -p $(@D)
	@rm -f $@
	$Qar qcs $@ $(filter %.o,$^)
endef

# Gold takes half as long as the other linker, where it is.
GOLD := $(if $(shell command -v ld.gold 2>/dev/null),-fuse-ld=gold)

define link_host
	@mkdir -p $(@D)
	$(call SAY,LD $@)
	$Q$(COMPILER.$1) $(FLAGS.$1) $(GOLD) $(filter %.o,$^) $(filter %.a,$^) $(LIBRARIES) -o $@
endef

# Without the simulator's libraries, which a 32-bit host need not have.
define link_core
	@mkdir -p $(@D)
	$(call SAY,LD $@)
	$Q$(COMPILER.$1) $(FLAGS.$1) $(GOLD) $(filter %.o,$^) $(filter %.a,$^) -lm -o $@
endef

define link_target
	@mkdir -p $(@D)
	$(call SAY,LD $@)
	$Q$(COMPILER.$1) $(FLAGS.$1) -nostartfiles $(if $(filter cortex%,$1),--specs=nano.specs) -Wl,--gc-sections \
	    -Ltests/target -Ttests/target/$(BOARD.$1).ld $(filter %.o,$^) $(filter %.a,$^) -o $@
endef

$(BUILD)/bin/%: $(BUILD)/host/sim/programs/%.o $(call host_libraries,host)
	$(call link_host,host)

$(BUILD)/bench/bench_%: $(BUILD)/host/tests/bench/bench_%.o $(call host_libraries,host)
	$(call link_host,host)

$(BUILD)/bench/%_drives: $(BUILD)/host/tests/bench/%_drives.o $(call host_libraries,host)
	$(call link_host,host)

$(BUILD)/bench/day_drives $(BUILD)/bench/bench_patrol_round: $(BUILD)/host/tests/bench/patrol_rounds.o

$(BUILD)/bench/bench_plan: $(addprefix $(BUILD)/host/tests/bench/,igraph_peer.o ompl_peer.o plain_search.o plan_peers.o plan_replans.o plan_savings.o)
$(BUILD)/bench/bench_plan: private COMPILER.host = g++
$(BUILD)/bench/bench_plan: private LIBRARIES += -lompl -ligraph

# The peers are C++, as OMPL is. Its ompl.pc also links what it was built with.
$(BUILD)/host/tests/bench/%_peer.o: tests/bench/%_peer.cpp
	@mkdir -p $(@D)
	$(call SAY,CXX $@)
	$Qg++ -O2 -Wall -Wextra -Werror -MMD -I. -Iinclude $(patsubst -I%,-isystem %,$(shell pkg-config --cflags $*)) -c $< -o $@

# Property tests at bench length, without the sanitizers.
$(BUILD)/bench/prop_%: $(BUILD)/host/tests/property/prop_%.o $(call host_libraries,host) $(UNITY_SOURCE:%=$(BUILD)/host/unity.o)
	$(call link_host,host)

# All at once: they share a Python package.
$(LCM_HEADERS) &: $(LCM_TYPES:%=sim/lcm/%.lcm)
	@rm -rf $(BUILD)/lcm
	@mkdir -p $(BUILD)/lcm
	$Qlcm-gen --c --python --c-cpath $(BUILD)/lcm --c-hpath $(BUILD)/lcm --ppath $(BUILD)/lcm $^

$(BUILD)/robots.c: tools/make/robots.sh FORCE
	@mkdir -p $(@D)
	@new=$@.$$$$; $< src/tables >$$new; if cmp -s $$new $@; then rm $$new; else mv $$new $@; fi

.PHONY: FORCE
FORCE:

# ---- A robot in the making -------------------------------------------------------------------------------------------

# Programs that know one robot alone, by the tables of a folder: make CANDIDATE=folder folder/jp-balance
ifdef CANDIDATE
$(CANDIDATE)/robots.c: tools/make/robots.sh FORCE
	@$< $(CANDIDATE)/tables >$@

$(CANDIDATE)/jp-%: $(BUILD)/host/sim/programs/jp-%.o $(CANDIDATE)/robots.c $(call host_libraries,host)
	$(call SAY,LD $@)
	$Q$(COMPILER.host) -std=c11 -Iinclude -I. $(FLAGS.host) $(CANDIDATE)/robots.c $(wildcard $(CANDIDATE)/tables/*.c) \
	    $(filter %.o,$^) $(filter %.a,$^) $(LIBRARIES) -o $@
endif
