/** What a driver gives to the core: anything that a header allows. */
#ifndef JOULEPATH_TESTS_PROOF_ANY_H
#define JOULEPATH_TESTS_PROOF_ANY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(__FRAMAC__)
#include "__fc_builtin.h"
#else
/* The compiler finds out what a driver stands on. */
void Frama_C_make_unknown(char *memory, size_t size);
int Frama_C_interval(int low, int high);
unsigned Frama_C_unsigned_int_interval(unsigned low, unsigned high);
long long Frama_C_long_long_interval(long long low, long long high);
void Frama_C_show_each_end(void);
#endif

/** Any bytes. */
#define ANY(object) Frama_C_make_unknown((char *)&(object), sizeof(object))

#define any_between(low, high) Frama_C_interval(low, high)
#define any_int()              Frama_C_interval(INT32_MIN, INT32_MAX)
#define any_unsigned(high)     Frama_C_unsigned_int_interval(0U, high)
#define any_long(low, high)    Frama_C_long_long_interval(low, high)
#define any_bool()             (Frama_C_interval(0, 1) != 0)

/** A loop of any length. */
#define ANY_TIMES while (any_bool())

/** The end of each driver: without it the report says that the analyser did not arrive there. */
#define ARRIVED() Frama_C_show_each_end()

#endif
