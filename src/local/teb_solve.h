/** Banded normal equations: sums of residuals and their solution. Private to the TEB. */
#ifndef JOULEPATH_LOCAL_TEB_SOLVE_H
#define JOULEPATH_LOCAL_TEB_SOLVE_H

#include <joulepath/teb.h>

/** All zero, for the rows of `count` poses. */
void jp_teb_clear_equations(struct jp_teb *teb);

/** Adds a residual with its derivatives by `width` <= JP_TEB_BAND variables from those of pose `first` on. */
void jp_teb_add_residual(struct jp_teb *teb, unsigned first, unsigned width, const float *derivatives, float residual);

/** Takes a variable out: its step will be 0. */
void jp_teb_fix(struct jp_teb *teb, unsigned row);

/** Solves (N + damping diag N) step = −gradient by Cholesky; the step takes the gradient's place. False: N is not
 *  positive definite, in float's precision. Work: rows × JP_TEB_BAND²/2. */
bool jp_teb_solve(struct jp_teb *teb);

#endif
