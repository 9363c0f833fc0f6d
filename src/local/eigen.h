/** Eigenvectors of symmetric matrices of x, y and the heading. Private to libjoulepath_float. */
#ifndef JOULEPATH_LOCAL_EIGEN_H
#define JOULEPATH_LOCAL_EIGEN_H

struct jp_eigen {
    float values[3];     /**< the least stands first */
    float vectors[3][3]; /**< vectors[i], of length 1, belongs to values[i] */
};

/** Jacobi's method. Constant work: 18 rotations. */
void jp_eigen_find(float matrix[3][3], struct jp_eigen *eigen);

#endif
