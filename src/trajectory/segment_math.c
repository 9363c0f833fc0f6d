#include "src/trajectory/segment_math.h"

/* The copies that are called where the compiler does not write the function in line. */
extern inline unsigned jp_leading_zeros(uint32_t a);
extern inline uint32_t jp_reciprocal(uint32_t a, unsigned *zeros);
extern inline int32_t jp_fraction30(uint32_t a, uint32_t b);
extern inline int32_t jp_quotient31(int32_t a, int32_t b);
extern inline uint32_t jp_square_root32(uint32_t a);
