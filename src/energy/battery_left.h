/** The energy that known cells still have. Private to the core. */
#ifndef JOULEPATH_ENERGY_BATTERY_LEFT_H
#define JOULEPATH_ENERGY_BATTERY_LEFT_H

#include "src/energy/battery_filter.h"

/** At the expected load until the reserve, as the robot's own sensors will count it, J. */
jp_energy jp_battery_cells_energy(const struct jp_battery *battery, const struct jp_battery_config *config);

/** Standard deviation of it, J. */
jp_energy jp_battery_cells_deviation(const struct jp_battery *battery, const struct jp_battery_config *config);

#endif
