# Variants: compilers, flags, boards and emulators.

# Contraction is off, and on 32 bits SSE computes, so that the host programs give the same numbers under every compiler.
WARNINGS := -Wall -Wextra -Wconversion -Wshadow -Werror
# A backtrace names functions and lines; where the variables of optimised code are takes the compiler long to say.
COMMON   := -std=c11 -g1 $(WARNINGS) -Iinclude -I. -I$(UNITY) -isystem $(BUILD)/lcm -MMD -MP $(if $(SIDE),-DJP_NAVIGATION_SIDE=$(SIDE)) \
            $(if $(PLANNER),-DJP_NAVIGATION_PLANNER=$(PLANNER)) $(if $(CELLS),-DJP_PATROL_CELLS=$(CELLS))
HOST     := -D_GNU_SOURCE -ffp-contract=off -DUNITY_INCLUDE_DOUBLE -DUNITY_SUPPORT_64
SANITIZE := -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=all
BARE     := -ffunction-sections -fdata-sections -fcallgraph-info=su -Itests/target -DUNITY_INCLUDE_CONFIG_H -DUNITY_SUPPORT_64
ARM      := $(BARE) -mthumb
M4F      := -mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16
M7F      := -mcpu=cortex-m7 -mfloat-abi=hard -mfpu=fpv5-sp-d16
SSE      := -msse2 -mfpmath=sse
RV32     := $(BARE) -march=rv32imac -mabi=ilp32 --specs=picolibc.specs

# Both compilers and both word sizes, in two variants.
HOST_TESTS     := host-gcc host-clang-m32
# Thumb-1 for size, DSP and FPU for speed, and another instruction set; `make test-targets` runs the others too.
UNIT_CORES     := cortex-m0 cortex-m4 rv32
BITS_CORES     := cortex-m4 rv32
ALL_UNIT_CORES := cortex-m0 cortex-m3 cortex-m4 cortex-m7 rv32
ARM_VARIANTS   := $(filter cortex%,$(ALL_UNIT_CORES)) cortex-m0-o2 cortex-m3-os cortex-m4-os cortex-m7-os
RV_VARIANTS    := rv32 rv32-os
# Whose numbers `make test` watches.
GROWTH_CORE     := cortex-m4
GROWTH_VARIANTS := $(GROWTH_CORE) $(GROWTH_CORE)-os
VARIANTS     := host host-coverage host-fuzz host-mcdc host-mutants release firmware firmware-m7 $(HOST_TESTS) $(ARM_VARIANTS) $(RV_VARIANTS)

# Each core's builds for speed and for size.
CORES            := cortex-m0 cortex-m3 cortex-m4 cortex-m7 rv32
SPEED_cortex-m0  := cortex-m0-o2
SIZE_cortex-m0   := cortex-m0
SPEED_VARIANTS   := $(foreach c,$(CORES),$(or $(SPEED_$c),$c))
SIZE_VARIANTS    := $(foreach c,$(CORES),$(or $(SIZE_$c),$c-os))

# Where the float library is: on the hosts and on the cores with an FPU.
FPU_CORES        := cortex-m4 cortex-m7
FLOAT_VARIANTS   := host host-coverage host-fuzz host-mcdc host-mutants release firmware-m7 $(HOST_TESTS) $(FPU_CORES) $(FPU_CORES:%=%-os)

COMPILER.host            = $(CC)
COMPILER.release         = $(CC)
COMPILER.firmware        = arm-none-eabi-gcc
COMPILER.firmware-m7     = arm-none-eabi-gcc
COMPILER.host-coverage   = gcc
COMPILER.host-fuzz       = clang
COMPILER.host-gcc        = gcc
# The first that measures MC/DC.
COMPILER.host-mcdc       = clang-19
COMPILER.host-mutants    = gcc
COMPILER.host-clang-m32  = clang -m32
$(foreach v,$(ARM_VARIANTS),$(eval COMPILER.$v = arm-none-eabi-gcc))
$(foreach v,$(RV_VARIANTS),$(eval COMPILER.$v = riscv64-unknown-elf-gcc))

# Neither errno of a root nor a trap is looked at, and no bit of a result depends on them.
FLAGS.host            = $(HOST) -O2 -fno-math-errno -fno-trapping-math
# For others: a newer compiler's warnings must not stop an installation.
FLAGS.release         = -O2 -Wno-error -ffunction-sections -fdata-sections
# For a debugger on the board. The core has no floating point, so interrupts need not save its registers.
FLAGS.firmware        = -g -mthumb -mcpu=cortex-m4 -O2 -ffunction-sections -fdata-sections -fcallgraph-info=su
# Of a robot that finds its way by laser, in single precision.
FLAGS.firmware-m7     = -g -mthumb $(M7F) -O2 -ffunction-sections -fdata-sections -fcallgraph-info=su
FLAGS.host-coverage   = $(HOST) -O0 --coverage
# Coverage guides the inputs.
FLAGS.host-fuzz       = $(HOST) $(SANITIZE) -fsanitize=fuzzer-no-link -O1
# What this compiler warns of besides is not its task here.
FLAGS.host-mcdc       = $(HOST) -w -O0 -fprofile-instr-generate -fcoverage-mapping -fcoverage-mcdc
FLAGS.host-mutants    = $(HOST) -O0 -fPIC
FLAGS.host-gcc        = $(HOST) $(SANITIZE) -O1
# Only short tests run there: clang takes longer to optimise what the sanitizers add than they to run without that.
FLAGS.host-clang-m32  = $(HOST) $(SANITIZE) -O0 $(SSE)
FLAGS.cortex-m0       = $(ARM) -mcpu=cortex-m0 -Os
FLAGS.cortex-m0-o2    = $(ARM) -mcpu=cortex-m0 -O2
FLAGS.cortex-m3       = $(ARM) -mcpu=cortex-m3 -O2
FLAGS.cortex-m3-os    = $(ARM) -mcpu=cortex-m3 -Os
FLAGS.cortex-m4       = $(ARM) $(M4F) -O2
FLAGS.cortex-m4-os    = $(ARM) $(M4F) -Os
FLAGS.cortex-m7       = $(ARM) $(M7F) -O2
FLAGS.cortex-m7-os    = $(ARM) $(M7F) -Os
FLAGS.rv32            = $(RV32) -O2
FLAGS.rv32-os         = $(RV32) -Os

# A test is long and runs once: it is quicker to compile it plainly than to run it fast.
FLAGS_TESTS = -O0

# A square root is one instruction, and nothing is computed in double by mistake.
FLAGS_FLOAT = -ffp-contract=off -fno-math-errno -Wdouble-promotion

# Cortex-M4 executes the code of Cortex-M0, and its board has more memory than the micro:bit.
BOARD.cortex-m0       = arm/microbit
BOARD.cortex-m0-o2    = arm/mps2-an386
BOARD.cortex-m3       = arm/mps2-an385
BOARD.cortex-m3-os    = $(BOARD.cortex-m3)
BOARD.cortex-m4       = arm/mps2-an386
BOARD.cortex-m4-os    = $(BOARD.cortex-m4)
BOARD.cortex-m7       = arm/mps2-an500
BOARD.cortex-m7-os    = $(BOARD.cortex-m7)
BOARD.rv32            = riscv/virt
BOARD.rv32-os         = $(BOARD.rv32)

RUN.cortex-m0       = qemu-system-arm -M microbit $(SEMIHOSTING)
RUN.cortex-m0-o2    = $(RUN.cortex-m4)
RUN.cortex-m3       = qemu-system-arm -M mps2-an385 $(SEMIHOSTING)
RUN.cortex-m4       = qemu-system-arm -M mps2-an386 $(SEMIHOSTING)
RUN.cortex-m7       = qemu-system-arm -M mps2-an500 $(SEMIHOSTING)
RUN.rv32            = qemu-system-riscv32 -M virt -bios none $(SEMIHOSTING)
# For what counts instructions: a clock that counts them, with which the emulator takes half as long again.
COUNTING            = -icount shift=0
SEMIHOSTING         = -nographic -semihosting-config enable=on,target=native -kernel
