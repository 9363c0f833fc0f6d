#include "src/base/reciprocal.h"

/* The copies that are called where the compiler does not write the function in line. */
extern inline struct jp_reciprocal jp_reciprocal_of(int64_t x);
extern inline jp_q24 jp_share_of(int64_t x, const struct jp_reciprocal *reciprocal);
