#include "src/local/eigen.h"

#include <string.h>

#include "src/base/plane.h"

#define JACOBI_SWEEPS 6

/* Turns the axes p and q so that a[p][q] vanishes and a[p][p] is the lesser of both. */
static void rotate(float a[3][3], float vectors[3][3], int p, int q)
{
    const struct jp_plane_point turn = jp_plane_direction(0.5f * jp_plane_bearing(a[q][q] - a[p][p], 2.0f * a[p][q]));
    const float c = turn.x;
    const float s = turn.y;

    for (int i = 0; i < 3; i++) {
        const float ip = a[i][p];
        const float iq = a[i][q];

        a[i][p] = c * ip - s * iq;
        a[i][q] = s * ip + c * iq;
    }
    for (int i = 0; i < 3; i++) {
        const float pi = a[p][i];
        const float qi = a[q][i];
        const float vp = vectors[p][i];
        const float vq = vectors[q][i];

        a[p][i] = c * pi - s * qi;
        a[q][i] = s * pi + c * qi;
        vectors[p][i] = c * vp - s * vq;
        vectors[q][i] = s * vp + c * vq;
    }
}

void jp_eigen_find(float matrix[3][3], struct jp_eigen *eigen)
{
    float a[3][3];

    (void)memcpy(a, matrix, sizeof a);
    (void)memset(eigen, 0, sizeof *eigen);
    for (int i = 0; i < 3; i++) {
        eigen->vectors[i][i] = 1.0f;
    }
    for (int sweep = 0; sweep < JACOBI_SWEEPS; sweep++) {
        rotate(a, eigen->vectors, 0, 1);
        rotate(a, eigen->vectors, 0, 2);
        rotate(a, eigen->vectors, 1, 2);
    }
    for (int i = 0; i < 3; i++) {
        eigen->values[i] = a[i][i];
    }
}
