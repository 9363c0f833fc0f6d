# Proof: Frama-C's Eva on the drivers of tests/proof.

PROVE := $(BUILD)/prove
ROOM   ?=
# Which public functions the drivers reach, in tests/proof/functions.yaml: RECORD=1.
RECORD ?=

# The linker tells from them what a driver stands on.
PROVED_LIBRARIES := $(addprefix $(BUILD)/host/,libcan.a libjoulepath.a)

.PHONY: prove
prove: ## prove that no module has undefined behaviour, of all rooms or ROOM=name; results are in build/prove
	@tools/setup.sh prove
	@$(MAKE) $(PARALLEL) $(PROVED_LIBRARIES)
	$Q$(PYTHON) -m tools.measure.prove --folder $(PROVE) --room '$(ROOM)' --jobs $(JOBS) \
	    $(if $(RECORD),--record) $(PROVED_LIBRARIES)

# What takes one number, for every one: minutes.
EXHAUSTIVE := $(PROVE)/arcs

.PHONY: exhaust
exhaust: $(EXHAUSTIVE:=.done) ## run for every number what takes one, where the proof argues with it (tests/proof/exhaustive)

$(EXHAUSTIVE): $(PROVE)/%: tests/proof/exhaustive/%.c $(addprefix src/,trajectory/segment_arc.c trajectory/segment_math.c \
                           base/fixed.c trajectory/segment_arc.h trajectory/segment_math.h base/compiler.h base/integer.h) \
                           include/joulepath/fixed.h
	$(call SAY,CC $@)
	$Qmkdir -p $(@D)
	$Q$(CC) -std=c11 -O2 -Wall -Wextra -fsanitize=undefined -fno-sanitize-recover=all -I. -Iinclude $(filter %.c,$^) -o $@

%.done: %
	$(call SAY,RUN $<)
	$Q$<
	$Qtouch $@
