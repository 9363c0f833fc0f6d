/** CRC-32 of IEEE 802.3, as zlib has it. */
#ifndef JOULEPATH_HAL_STORAGE_CRC32_H
#define JOULEPATH_HAL_STORAGE_CRC32_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Goes on from the CRC of what came before, 0 at the start. Two table look-ups a byte; may be called from an ISR. */
uint32_t jp_crc32(uint32_t crc, const uint8_t *bytes, size_t length);

#ifdef __cplusplus
}
#endif

#endif
