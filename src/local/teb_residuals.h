/** Residuals of the band and their analytic derivatives. Private to the TEB. */
#ifndef JOULEPATH_LOCAL_TEB_RESIDUALS_H
#define JOULEPATH_LOCAL_TEB_RESIDUALS_H

#include <joulepath/teb.h>

/** Sums up the normal equations of the band, in which what may not move is fixed. Half the sum of squares of all
 *  residuals; one that is not below `limit` is not complete, nor are the equations then. */
float jp_teb_linearise(struct jp_teb *teb, float limit);

#endif
