/** Memory beside the microcontroller's own, on boards that have it: of MPS2 with the AN500 image its PSRAM. It is not
 *  cleared. */
#ifndef TARGET_EXTERNAL_H
#define TARGET_EXTERNAL_H

#include <stddef.h>
#include <stdint.h>

#define TARGET_EXTERNAL_SIZE ((size_t)16 << 20)

/** Of the linker script: TARGET_EXTERNAL_SIZE bytes. */
extern uint64_t target_external[];

#endif
