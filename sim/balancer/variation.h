/**
 * How one robot of a kind differs from its robot file: what varies from robot to robot and from day to day. The
 * controller, its gains and the energy model stay those of the file.
 */
#ifndef JOULEPATH_SIM_BALANCER_VARIATION_H
#define JOULEPATH_SIM_BALANCER_VARIATION_H

#include "sim/balancer/robot_file.h"
#include "sim/base/random.h"

struct variation {
    double ground_friction;  /**< factor on ground.friction */
    double payload_kg;       /**< added to body.mass_kg at its centre of mass; less than 0: the body is lighter */
    double motor_resistance; /**< factor on motor.resistance_ohm: temperature, make */
    double motor_friction;   /**< factor on motor.friction */
    double capacity;         /**< factor on supply.capacity_wh: age */
};

/** A number of struct variation. */
struct variation_member {
    const char *name;   /**< in options */
    const char *column; /**< in tables */
    size_t offset;
    double low; /**< variation_draw() draws from low…high; the payload from limits.payload_kg of the robot file */
    double high;
    double min; /**< variation_parse() takes min…max */
    double max;
};

extern const struct variation_member variation_members[];
extern const size_t variation_member_count;

/** As in the robot file. */
extern const struct variation variation_none;

/** The number that this member is. */
double variation_value(const struct variation *variation, const struct variation_member *member);

/** Uniform: ground friction 0.6…1.6, the payload of the robot file, motor resistance 0.92…1.12, motor friction
 * 0.8…1.25, capacity 0.7…1. */
void variation_draw(struct random *random, const struct robot_file *file, struct variation *variation);

/** The robot file of the varied robot. */
void variation_apply(const struct variation *variation, const struct robot_file *nominal, struct robot_file *varied);

/** Sets what `text` names, such as "friction=1.5,payload=1", and leaves the rest. False after one line on stderr that
 *  begins with `option`; then *variation is not to be used. */
bool variation_parse(const char *option, const char *text, struct variation *variation);

#endif
