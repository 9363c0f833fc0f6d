/** What a metre of a planned path costs: to drive, and by what is near, as the band and the patrol count it. Private to
 *  the patrol. */
#ifndef JOULEPATH_LOCAL_PATROL_PLAN_PRICES_H
#define JOULEPATH_LOCAL_PATROL_PLAN_PRICES_H

#include <joulepath/grid_prices.h>
#include <joulepath/patrol.h>

/**
 * Prices of a grid of cells, m, whose paths keep a clearance of the footprint, m. A metre is driven at the band's
 * speed; beside things at that of jp_patrol_speed_beside(), and the band's price of clearance, of one thing, comes on
 * top: half the weight of obstacles times the square of what is missing, once an interval, in joules as its weight of a
 * second is. Failures as jp_grid_prices_set(). Work: as that, and seven metres.
 */
enum jp_status jp_patrol_plan_prices(const struct jp_patrol_config *config,
                                     const struct jp_four_wheel_energy_model *model, float clearance, float cell,
                                     struct jp_grid_prices *prices);

#endif
