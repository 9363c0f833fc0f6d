/** FNV-1a over the bytes of values: equal runs have equal fingerprints. */
#ifndef JOULEPATH_SIM_BASE_FINGERPRINT_H
#define JOULEPATH_SIM_BASE_FINGERPRINT_H

#include <stddef.h>
#include <stdint.h>

#define FINGERPRINT_START UINT64_C(0xCBF29CE484222325)

/** The value must have no padding. */
void fingerprint_add(uint64_t *fingerprint, const void *value, size_t size);

#endif
