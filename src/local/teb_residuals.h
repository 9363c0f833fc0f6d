/** Residuals of the band and their analytic derivatives. Private to the TEB. */
#ifndef JOULEPATH_LOCAL_TEB_RESIDUALS_H
#define JOULEPATH_LOCAL_TEB_RESIDUALS_H

#include <joulepath/teb.h>

/** Whether the laser says where the first pose is; otherwise it is where the wheels say. */
bool jp_teb_has_odometry(const struct jp_teb *teb);

/** Sums up half the squares of all residuals of the band, and the terms of its normal equations that are not kept. A
 *  sum that is not below `limit` is not complete, nor are the terms then. */
float jp_teb_linearise(struct jp_teb *teb, float limit);

#endif
