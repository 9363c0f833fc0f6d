/** A route of a robot that its sides steer as a path, planned slice by slice, and the legs of it. Private to the core.
 */
#ifndef JOULEPATH_NAVIGATE_SKID_RUN_H
#define JOULEPATH_NAVIGATE_SKID_RUN_H

#include <joulepath/skid_pilot.h>

/** Of the wheels, m. */
static inline jp_q16 jp_skid_run_half_track(const struct jp_skid_pilot_config *config)
{
    return config->limits.width >> 9;
}

/** Lays the lines of a route in pieces of memory; failures as jp_line_path(). */
enum jp_status jp_skid_run_lay(struct jp_skid_run *run, const struct jp_skid_pilot_config *config,
                               const struct jp_line_route *route, uint8_t slower);

/** Lays a turn on the spot where a route starts, or a path without pieces. */
void jp_skid_run_lay_turn(struct jp_skid_run *run, const struct jp_skid_pilot_config *config,
                          const struct jp_line_route *route, jp_angle heading);

/** A slice of planning what was laid, by the prices of a model: a corner, the speeds from a stand to the next, or the
 *  halves of an arc. False: all of it was planned. */
bool jp_skid_run_plan(struct jp_skid_run *run, const struct jp_skid_pilot_config *config,
                      const struct jp_skid_energy_model *model);

/** From a leg, all zero before the first one, to the next. False: there is none, and *leg is not written. */
bool jp_skid_run_next_leg(const struct jp_skid_run *run, struct jp_skid_leg *leg);

/** The piece of a leg after the first ones, all of which are on one ground. */
uint16_t jp_skid_run_end_of_ground(const struct jp_skid_run *run, const struct jp_skid_leg *leg);

/** What is known of the robot, and of grounds, or null. */
struct jp_skid_knowledge {
    const struct jp_skid_learner *robot;
    const struct jp_skid_grounds *grounds;
};

/** Adds a leg of a planned run to a drive, and what it lasts to *duration, s. */
void jp_skid_run_leg_energy(const struct jp_skid_run *run, const struct jp_skid_leg *leg,
                            const struct jp_skid_knowledge *known, struct jp_skid_ground_drive *drive,
                            jp_q16 *duration);

#endif
