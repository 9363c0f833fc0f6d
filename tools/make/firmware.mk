# The image for the STM32F405. Its navigator has room for a map of SIDE × SIDE cells and for PLANNER KiB of the planner;
# hal/app/navigation_memory.h says how much without them. What does not fit the linker refuses.

# image_of ROBOT: what main.c and firmware_KIND.c of an image are compiled with.
image_of = -DFIRMWARE_ROBOT_NAME=$1 -DFIRMWARE_SKID_NAME=$1 -DFIRMWARE_PATROL_NAME=$1 $(if $(filter learning_$1,$(PILOT_TABLES)),-DFIRMWARE_LEARNS) \
           $(if $(wildcard src/tables/pack_$1.c),-DFIRMWARE_KNOWS_CELLS) \
           $(if $(wildcard src/tables/navigation_$1.c),-DFIRMWARE_NAVIGATES -DFIRMWARE_LATTICE_NAME=$(or $(patsubst src/tables/lattice_%.c,%,$(wildcard src/tables/lattice_$1_navigation.c)),$1))

# image_rules BOARD VARIANT ROBOT FOLDER: its objects, and the file for the board.
define image_rules
$4/%.o: hal/firmware/%.c tools/make/variants.mk $(SETTINGS)
	@mkdir -p $$(@D)
	$$(call SAY,CC $$@)
	$$Q$(COMPILER.$2) $(COMMON) $(FLAGS.$2) $(call image_of,$3) -c $$< -o $$@

$4/%.o: hal/$1/%.c tools/make/variants.mk $(SETTINGS)
	@mkdir -p $$(@D)
	$$(call SAY,CC $$@)
	$$Q$(COMPILER.$2) $(COMMON) $(FLAGS.$2) $(call image_of,$3) -c $$< -o $$@

$4/joulepath.bin: $4/joulepath.elf
	$$Qarm-none-eabi-objcopy -O binary $$< $$@
endef

# firmware_rules ROBOT KIND
define firmware_rules
$(call image_rules,stm32f4,firmware,$1,$(BUILD)/firmware/$1)

$(BUILD)/firmware/$1/joulepath.elf $(BUILD)/firmware/$1/emulated.elf: $(addprefix $(BUILD)/firmware/$1/,main.o firmware_$2.o) \
                                    $(BOARD_OBJECTS) $(BUILD)/firmware/libcan.a $(BUILD)/firmware/libjoulepath.a $(STM32F4_SCRIPTS)
	$$(call link_firmware,$$(if $$(filter %emulated.elf,$$@),$$(EMULATED_CCM),$$(CCM)))
endef
# What is the same in every image.
BOARD_OBJECTS := $(patsubst %.c,$(BUILD)/firmware/%.o,$(filter-out hal/stm32f4/main.c,$(STM32F4)) $(CORTEX_M))
STM32F4_SCRIPTS := $(wildcard hal/stm32f4/*.ld hal/cortex_m/*.ld)

$(foreach r,$(ROBOTS),$(eval $(call firmware_rules,$r,balancer)))
$(foreach r,$(SKID_ROBOTS),$(eval $(call firmware_rules,$r,skid)))

# mps2_rules ROBOT KIND FOLDER: the image for the Cortex-M7 of the MPS2 board. In emulated.elf time is the simulator's.
define mps2_rules
$(call image_rules,mps2,firmware-m7,$1,$3)

$3/joulepath.elf $3/emulated.elf: $(addprefix $3/,main.o firmware_$2.o) $(MPS2_OBJECTS) $(MPS2_SCRIPTS) \
                                    $(addprefix $(BUILD)/firmware-m7/,libcan_float.a libcan.a libjoulepath_float.a libjoulepath.a)
	$$(call link_mps2,$$(if $$(filter %emulated.elf,$$@),1,0))
endef
MPS2_OBJECTS := $(patsubst %.c,$(BUILD)/firmware-m7/%.o,$(filter-out hal/mps2/main.c,$(MPS2)) $(CORTEX_M))
MPS2_SCRIPTS := $(wildcard hal/mps2/*.ld hal/cortex_m/*.ld)

# The patrol robot's only board; the others' second one.
$(foreach r,$(PATROL_ROBOTS),$(eval $(call mps2_rules,$r,patrol,$(BUILD)/firmware/$r)))
$(foreach r,$(ROBOTS),$(eval $(call mps2_rules,$r,balancer,$(BUILD)/mps2/$r)))
$(foreach r,$(SKID_ROBOTS),$(eval $(call mps2_rules,$r,skid,$(BUILD)/mps2/$r)))

# link_mps2 LOCKSTEP
define link_mps2
	@mkdir -p $(@D)
	$(call SAY,LD $@)
	$Q$(COMPILER.firmware-m7) $(FLAGS.firmware-m7) -nostartfiles --specs=nano.specs -Wl,--gc-sections -Wl,--fatal-warnings \
	    -Wl,-Map=$@.map -Wl,--defsym=firmware_lockstep=$1 -Lhal/mps2 -Lhal/cortex_m -Tmps2_an500.ld $(filter %.o,$^) $(filter %.a,$^) -o $@
endef

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
	    -Wl,-Map=$@.map -Wl,--defsym=firmware_ccm=$1 -Lhal/stm32f4 -Lhal/cortex_m -Tstm32f405.ld $(filter %.o,$^) $(filter %.a,$^) -o $@
endef

BOARD          ?= stm32f405
FIRMWARE_FOLDER = $(if $(filter $(ROBOT),$(PATROL_ROBOTS)),$(BUILD)/firmware/$(ROBOT),$(FOLDER.$(BOARD)))
FOLDER.stm32f405 = $(BUILD)/firmware/$(ROBOT)
FOLDER.mps2      = $(BUILD)/mps2/$(ROBOT)
FLASH_stm32f405  = @echo 'flash it: st-flash write $(FIRMWARE_FOLDER)/joulepath.bin 0x08000000'

.PHONY: firmware
firmware: ## build the image with ROBOT=name, for BOARD=stm32f405 or mps2 (SIDE=cells PLANNER=KiB of its navigator; patrol: mps2 alone, CELLS of its map): ELF, bin and map in build/firmware/name or build/mps2/name
	$(if $(filter $(ROBOT),$(ROBOTS) $(SKID_ROBOTS) $(PATROL_ROBOTS)),,$(error ROBOT=$(ROBOT): must be one of $(ROBOTS) $(SKID_ROBOTS) $(PATROL_ROBOTS)))
	$(if $(FOLDER.$(BOARD)),,$(error BOARD=$(BOARD): must be stm32f405 or mps2))
	@tools/setup.sh firmware
	@$(MAKE) $(PARALLEL) $(FIRMWARE_FOLDER)/joulepath.bin
	@arm-none-eabi-size $(FIRMWARE_FOLDER)/joulepath.elf
	$(if $(filter $(ROBOT),$(PATROL_ROBOTS)),,$(FLASH_$(BOARD)))
