# The image for the STM32F405. Its navigator has room for a map of SIDE × SIDE cells and for PLANNER KiB of the planner;
# hal/app/navigation_memory.h says how much without them. What does not fit the linker refuses.

# firmware_rules ROBOT KIND
define firmware_rules
$(BUILD)/firmware/$1/%.o: hal/stm32f4/%.c tools/make/variants.mk $(SETTINGS)
	@mkdir -p $$(@D)
	$$(call SAY,CC $$@)
	$$Q$(COMPILER.firmware) $(COMMON) $(FLAGS.firmware) -DFIRMWARE_ROBOT_NAME=$1 -DFIRMWARE_SKID_NAME=$1 $(if $(filter learning_$1,$(PILOT_TABLES)),-DFIRMWARE_LEARNS) $(if $(wildcard src/tables/navigation_$1.c),-DFIRMWARE_NAVIGATES -DFIRMWARE_LATTICE_NAME=$(or $(patsubst src/tables/lattice_%.c,%,$(wildcard src/tables/lattice_$1_navigation.c)),$1)) -c $$< -o $$@

$(BUILD)/firmware/$1/joulepath.elf $(BUILD)/firmware/$1/emulated.elf: $(addprefix $(BUILD)/firmware/$1/,main.o firmware_$2.o) \
                                    $(BOARD_OBJECTS) $(BUILD)/firmware/libcan.a $(BUILD)/firmware/libjoulepath.a $(wildcard hal/stm32f4/*.ld)
	$$(call link_firmware,$$(if $$(filter %emulated.elf,$$@),$$(EMULATED_CCM),$$(CCM)))

$(BUILD)/firmware/$1/joulepath.bin: $(BUILD)/firmware/$1/joulepath.elf
	$$Qarm-none-eabi-objcopy -O binary $$< $$@
endef
# What is the same in every image.
BOARD_OBJECTS := $(patsubst %.c,$(BUILD)/firmware/%.o,$(filter-out $(IMAGE),$(STM32F4)))

$(foreach r,$(ROBOTS),$(eval $(call firmware_rules,$r,balancer)))
$(foreach r,$(SKID_ROBOTS),$(eval $(call firmware_rules,$r,skid)))

# patrol_firmware_rules ROBOT: the image for the Cortex-M7 of the MPS2 board. Its body is simulated, so that the same
# image runs on the board and in QEMU.
define patrol_firmware_rules
$(BUILD)/firmware/$1/%.o: hal/mps2/%.c tools/make/variants.mk $(SETTINGS)
	@mkdir -p $$(@D)
	$$(call SAY,CC $$@)
	$$Q$(COMPILER.firmware-m7) $(COMMON) $(FLAGS.firmware-m7) -DFIRMWARE_PATROL_NAME=$1 -c $$< -o $$@

$(BUILD)/firmware/$1/joulepath.elf $(BUILD)/firmware/$1/emulated.elf: $(MPS2:hal/mps2/%.c=$(BUILD)/firmware/$1/%.o) \
                                    $(addprefix $(BUILD)/firmware-m7/,libcan_float.a libcan.a libjoulepath_float.a libjoulepath.a) hal/mps2/mps2_an500.ld
	@mkdir -p $$(@D)
	$$(call SAY,LD $$@)
	$$Q$(COMPILER.firmware-m7) $(FLAGS.firmware-m7) -nostartfiles --specs=nano.specs -Wl,--gc-sections -Wl,--fatal-warnings \
	    -Wl,-Map=$$@.map -Thal/mps2/mps2_an500.ld $$(filter %.o,$$^) $$(filter %.a,$$^) -o $$@

$(BUILD)/firmware/$1/joulepath.bin: $(BUILD)/firmware/$1/joulepath.elf
	$$Qarm-none-eabi-objcopy -O binary $$< $$@
endef
$(foreach r,$(PATROL_ROBOTS),$(eval $(call patrol_firmware_rules,$r)))

COMMA := ,

# Memory beside the core. QEMU before 8.0 has none, but the board's RAM is longer there by as much.
CCM          = 0x10000000
EMULATED_CCM = $(if $(filter 5 6 7,$(QEMU_MAJOR)),0x20020000,$(CCM))
QEMU_MAJOR   = $(shell qemu-system-arm --version | sed -n 's/.* version \([0-9]*\).*/\1/p')

# link_firmware CCM
define link_firmware
	@mkdir -p $(@D)
	$(call SAY,LD $@)
	$Q$(COMPILER.firmware) $(FLAGS.firmware) -nostartfiles --specs=nano.specs -Wl,--gc-sections -Wl,--fatal-warnings \
	    -Wl,-Map=$@.map -Wl,--defsym=firmware_ccm=$1 -Lhal/stm32f4 -Tstm32f405.ld $(filter %.o,$^) $(filter %.a,$^) -o $@
endef

.PHONY: firmware
firmware: ## build the image with ROBOT=name, for the STM32F405 (SIDE=cells PLANNER=KiB of its navigator) or, of patrol, a Cortex-M7 (CELLS of its map): ELF, bin and map in build/firmware/name
	$(if $(filter $(ROBOT),$(ROBOTS) $(SKID_ROBOTS) $(PATROL_ROBOTS)),,$(error ROBOT=$(ROBOT): must be one of $(ROBOTS) $(SKID_ROBOTS) $(PATROL_ROBOTS)))
	@tools/setup.sh firmware
	@$(MAKE) $(PARALLEL) $(BUILD)/firmware/$(ROBOT)/joulepath.bin
	@arm-none-eabi-size $(BUILD)/firmware/$(ROBOT)/joulepath.elf
	$(if $(filter $(ROBOT),$(PATROL_ROBOTS)),,@echo 'flash it: st-flash write $(BUILD)/firmware/$(ROBOT)/joulepath.bin 0x08000000')
