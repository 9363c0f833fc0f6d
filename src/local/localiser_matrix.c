#include "src/local/localiser_matrix.h"

#include <string.h>

#include "src/base/plane.h"

/* Cholesky's factor, with the inverse of its diagonal. */
static bool factorise(float matrix[3][3], float factor[3][3])
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j <= i; j++) {
            float sum = matrix[i][j];

            for (int k = 0; k < j; k++) {
                sum -= factor[i][k] * factor[j][k];
            }
            if (i != j) {
                factor[i][j] = sum * factor[j][j];
            } else if (sum > 0.0f) {
                factor[i][i] = 1.0f / jp_plane_square_root(sum);
            } else {
                return false;
            }
        }
    }
    return true;
}

/* Of the triangular factor, in its place. */
static void invert_factor(float factor[3][3])
{
    factor[1][0] = -factor[1][0] * factor[0][0] * factor[1][1];
    factor[2][0] = -(factor[2][0] * factor[0][0] + factor[2][1] * factor[1][0]) * factor[2][2];
    factor[2][1] = -factor[2][1] * factor[1][1] * factor[2][2];
}

bool jp_localiser_invert(float matrix[3][3], float inverse[3][3])
{
    float factor[3][3];

    (void)memset(factor, 0, sizeof factor);
    if (!factorise(matrix, factor)) {
        return false;
    }
    invert_factor(factor);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            inverse[i][j] = factor[0][i] * factor[0][j] + factor[1][i] * factor[1][j] + factor[2][i] * factor[2][j];
        }
    }
    return true;
}

void jp_localiser_multiply(float matrix[3][3], const float vector[3], float product[3])
{
    for (int i = 0; i < 3; i++) {
        product[i] = matrix[i][0] * vector[0] + matrix[i][1] * vector[1] + matrix[i][2] * vector[2];
    }
}
