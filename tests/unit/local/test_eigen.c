/* Eigenvectors of symmetric matrices: what defines them, in double precision. */
#include "src/local/eigen.h"

#include "tests/support/near.h"
#include "tests/target/random.h"

static struct jp_eigen eigen;
static uint32_t state;

void setUp(void)
{
    state = 5;
}

void tearDown(void)
{
}

static float entry(void)
{
    return (float)(int32_t)(target_random(&state) % 2001U) * 0.001f - 1.0f;
}

static float dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The vectors are of length 1 and square to each other, the matrix only stretches each, and the least comes first. */
static void expect_eigen(float matrix[3][3])
{
    jp_eigen_find(matrix, &eigen);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            TEST_ASSERT_NEAR(1.0e-5f, i == j ? 1.0f : 0.0f, dot(eigen.vectors[i], eigen.vectors[j]));
            TEST_ASSERT_NEAR(1.0e-5f, eigen.values[i] * eigen.vectors[i][j], dot(matrix[j], eigen.vectors[i]));
        }
    }
    TEST_ASSERT_TRUE(eigen.values[0] <= eigen.values[1] + 1.0e-6f);
    TEST_ASSERT_TRUE(eigen.values[1] <= eigen.values[2] + 1.0e-6f);
}

static void test_random_matrices(void)
{
    for (unsigned run = 0; run < 100U; run++) {
        float matrix[3][3];

        for (int i = 0; i < 3; i++) {
            for (int j = 0; j <= i; j++) {
                matrix[i][j] = entry();
                matrix[j][i] = matrix[i][j];
            }
        }
        expect_eigen(matrix);
    }
}

static void test_matrices_that_are_diagonal_already(void)
{
    for (int first = 0; first < 3; first++) {
        float matrix[3][3] = {{0.0f}};

        matrix[first][first] = 0.5f;
        matrix[(first + 1) % 3][(first + 1) % 3] = -0.25f;
        expect_eigen(matrix);
    }
}
