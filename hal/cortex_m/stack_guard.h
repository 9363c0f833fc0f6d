/** The guard below each stack, which the MPU forbids: larger than most frames, so that none steps over it. */
#ifndef JOULEPATH_HAL_CORTEX_M_STACK_GUARD_H
#define JOULEPATH_HAL_CORTEX_M_STACK_GUARD_H

/** Also in the linker scripts; of the MPU's region: 2^(SIZE + 1). */
#define STACK_GUARD_BYTES 256U
#define STACK_GUARD_SIZE  7U

_Static_assert(STACK_GUARD_BYTES == 1U << (STACK_GUARD_SIZE + 1U), "the MPU's size is that of the guard");

#endif
