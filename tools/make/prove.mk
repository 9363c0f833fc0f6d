# Proof: Frama-C's Eva on the drivers of tests/proof.

PROVE := $(BUILD)/prove
ROOM  ?=

# The linker tells from them what a driver stands on.
PROVED_LIBRARIES := $(addprefix $(BUILD)/host/,libcan.a libjoulepath.a)

.PHONY: prove
prove: ## prove that no module has undefined behaviour, of all rooms or ROOM=name; results are in build/prove
	@tools/setup.sh prove
	@$(MAKE) $(PARALLEL) $(PROVED_LIBRARIES)
	$Q$(PYTHON) -m tools.measure.prove --folder $(PROVE) --room '$(ROOM)' --jobs $(JOBS) $(PROVED_LIBRARIES)
