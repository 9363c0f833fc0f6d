/** The cells that feed a robot which the navigator drives, and what the robot knows of their charge by its own meter
 * and bus voltage (joulepath/battery.h), of which at first it only has an idea. */
#ifndef JOULEPATH_SIM_MISSIONS_NAVIGATION_PACK_H
#define JOULEPATH_SIM_MISSIONS_NAVIGATION_PACK_H

#include "sim/missions/navigation_robot.h"

/** Of the charge and of the usable energy that it holds, J. */
struct navigation_charge {
    double charge; /**< true, share of the capacity */
    double known;  /**< by the robot, */
    double deviation;
    double joules; /**< true, at the terminals */
    double known_joules;
    double joules_deviation;
};

struct navigation_pack {
    double charge; /**< true, as it begins; the caller's */
    struct cell_constants cell;
    struct cell_wiring wiring;
    const struct navigation_robot *robot;
    struct jp_battery_config config;
    struct jp_battery battery;
    jp_energy energy; /**< metered when it began */
    double seconds;   /**< since then */
    int64_t voltage;  /**< sum of the ticks since the last update, V in Q16 */
    unsigned ticks;   /**< that many */
    unsigned ticks_an_update;
    double least_v;   /**< bus, mean of an update's ticks, since it began */
    jp_energy before; /**< metered at the last update */
    double most_w;    /**< greatest mean power between two updates */
};

/** The cells feed the robot, which stands, from now on; its idea of the charge is off by as much as the seed draws.
 * False after one line on stderr: it has no cells, or they cannot feed it. */
bool navigation_pack_start(struct navigation_pack *pack, const struct navigation_robot *robot, uint64_t seed);

/** After each tick of the robot. */
void navigation_pack_tick(struct navigation_pack *pack);

/** As struct jp_home_config wants them, in the unit of the robot's vehicle. */
struct jp_forecast navigation_pack_left(const struct navigation_pack *pack);
jp_q16 navigation_pack_given(const struct navigation_pack *pack);

/** The bus has fallen below what the robot drives at. */
bool navigation_pack_is_empty(const struct navigation_pack *pack);

struct navigation_charge navigation_pack_charge(const struct navigation_pack *pack);

#endif
