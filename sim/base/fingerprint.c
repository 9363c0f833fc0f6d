#include "sim/base/fingerprint.h"

#define PRIME UINT64_C(0x100000001B3)

void fingerprint_add(uint64_t *fingerprint, const void *value, size_t size)
{
    const unsigned char *byte = value;

    for (size_t i = 0; i < size; i++) {
        *fingerprint = (*fingerprint ^ byte[i]) * PRIME;
    }
}
