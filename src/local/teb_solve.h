/** Banded normal equations and their solution. Private to the TEB. */
#ifndef JOULEPATH_LOCAL_TEB_SOLVE_H
#define JOULEPATH_LOCAL_TEB_SOLVE_H

#include <joulepath/teb.h>

/** Puts together the rows of a pose, in which what may not move is fixed: N's, and minus the gradient as the step. */
void jp_teb_assemble(const struct jp_teb *teb, unsigned pose, struct jp_teb_factor *rows);

/** Solves (N + damping diag N) step = −gradient by Cholesky, of the terms that are kept; the steps are in the factor.
 *  False: N is not positive definite, in float's precision. Work: poses; no more for any terms. */
bool jp_teb_solve(struct jp_teb *teb);

#endif
