# The Python package.

PYTHON_WHEEL   := $(BUILD)/python/wheel
PYTHON_SITE    := $(BUILD)/python/site
PYTHON_SOURCES := $(wildcard tools/python/* tools/python/joulepath/* tools/python/native/* sim/robots/*.cfg sim/scenarios/*.cfg) \
                  $(wildcard tools/*.py $(patsubst %,tools/%/*,design identify operate report)) $(CORE) $(FLOAT) $(CAN) $(filter-out sim/lcm/%,$(SIM)) $(wildcard include/joulepath/*.h src/*/*.h hal/*.h hal/*/*.h sim/*/*.h sim/programs/*.c)

# Without what pip would look for beyond this machine.
$(PYTHON_SITE)/joulepath/__init__.py: $(PYTHON_SOURCES) tools/make/robots.sh
	$(call SAY,PIP $(PYTHON_SITE))
	@rm -rf $(PYTHON_WHEEL) $(PYTHON_SITE) && mkdir -p $(PYTHON_WHEEL)
	$Q$(PYTHON) -m pip wheel --quiet --disable-pip-version-check --no-build-isolation --no-deps --wheel-dir $(PYTHON_WHEEL) tools/python
	$Q$(PYTHON) -m pip install --quiet --disable-pip-version-check --no-index --no-deps --target $(PYTHON_SITE) $(PYTHON_WHEEL)/joulepath-*.whl
	@touch $@

.PHONY: python
python: ## build the Python package: its wheel in build/python/wheel
	@tools/setup.sh python
	@$(MAKE) $(PYTHON_SITE)/joulepath/__init__.py
	@ls $(PYTHON_WHEEL)/*.whl

.PHONY: bench-python
bench-python: ## measure the Python package: from a checkout to the first joules in a fresh environment, planning beside jp-plan (5 minutes)
	@tools/setup.sh python test
	@$(MAKE) $(PARALLEL) $(BUILD)/bin/jp-plan $(PYTHON_SITE)/joulepath/__init__.py
	@mkdir -p $(BUILD)/bench
	$(PYTHON) -m tools.measure.bench_python install planning
