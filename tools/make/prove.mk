# Proof: Frama-C's Eva on the drivers of tests/prove.

PROVE := $(BUILD)/prove
ROOM  ?=

.PHONY: prove
prove: ## prove that no module has undefined behaviour, of all rooms or ROOM=name; what was proved is kept in build/prove
	@tools/setup.sh prove
	@$(MAKE) $(PARALLEL) $(call host_libraries,host)
	$Q$(PYTHON) -m tools.measure.prove --folder $(PROVE) --room '$(ROOM)' --jobs $(JOBS) \
	    $(addprefix $(BUILD)/host/,libcan.a libjoulepath.a)
