/** Symmetric matrices of x, y and the heading. Private to the localiser. */
#ifndef JOULEPATH_LOCAL_LOCALISER_MATRIX_H
#define JOULEPATH_LOCAL_LOCALISER_MATRIX_H

#include <stdbool.h>

/** The inverse of a positive definite matrix; false: it is none, in float's precision. */
bool jp_localiser_invert(float matrix[3][3], float inverse[3][3]);

/** The product with a vector. */
void jp_localiser_multiply(float matrix[3][3], const float vector[3], float product[3]);

#endif
