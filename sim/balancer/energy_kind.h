/** Which energy is meant: that of the motors as the paper defines it, or what leaves the battery (joulepath/meter.h).
 */
#ifndef JOULEPATH_SIM_BALANCER_ENERGY_KIND_H
#define JOULEPATH_SIM_BALANCER_ENERGY_KIND_H

#include <stdbool.h>

enum energy_kind {
    ENERGY_MOTOR,  /**< (ul² + ur²)/Rm + Ps */
    ENERGY_BATTERY /**< ul il + ur ir + Ps */
};

/** "motor" or "battery". */
const char *energy_kind_name(enum energy_kind kind);

/** False when `name` is neither. */
bool energy_kind_parse(const char *name, enum energy_kind *kind);

#endif
