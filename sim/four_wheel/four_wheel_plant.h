/**
 * The four-wheel robot on the plane and its energy ledger, in double precision.
 *
 * A rigid body on four wheels, each steered by a servo (first order, limited in rate) and turned by a speed servo
 * (proportional and integral, limited in torque). A contact slides over the ground at its slip velocity; the ground
 * answers against it with `stiffness` times that, at most friction times load. Loads are equal: slopes are gentle and
 * the robot low. Steering has no inertia; its work is the friction of the contact that turns on the spot, which falls
 * as the wheel rolls: torque times s/√(s² + v²) with s the speed of turning at the contact's radius.
 *
 * A motor is a resistance behind a gear. Where it brakes, what gear and windings leave goes back into the battery.
 */
#ifndef JOULEPATH_SIM_FOUR_WHEEL_FOUR_WHEEL_PLANT_H
#define JOULEPATH_SIM_FOUR_WHEEL_FOUR_WHEEL_PLANT_H

#include <joulepath/four_wheel.h>

#include "sim/base/cell_pack.h"
#include "sim/base/planar.h"
#include "sim/four_wheel/four_wheel_constants.h"

#define FOUR_WHEEL_GRAVITY     9.81 /* m/s² */
#define FOUR_WHEEL_PATCHES_MAX 8

/** Step of the integrator, s; it follows damping rates up to FOUR_WHEEL_STEP_RATE_MAX a step. */
#define FOUR_WHEEL_STEP          0.001
#define FOUR_WHEEL_STEP_RATE_MAX 2.0

/**
 * Ground that is unlike the rest: wet, loose or sloping. Where patches overlap the first one counts. A wheel rolls
 * without slip at steady speed on any ground; it slides while a force acts, which is what `pull` is for.
 */
struct four_wheel_patch {
    struct planar_point low; /**< corners of a rectangle along the axes, m */
    struct planar_point high;
    double friction;       /**< of the tyre's, a factor above 0, at most 1 */
    double stiffness_left; /**< of the tyre's, a factor above 0, at most 1, for the wheels on the left */
    double stiffness_right;
    struct planar_point pull; /**< acceleration that a slope gives, for each wheel's share of the mass, m/s² */
};

struct four_wheel_contact {
    double angle;    /**< of steering, rad */
    double roll;     /**< of the wheel since the start, rad */
    double rate;     /**< rad/s */
    double integral; /**< of the speed servo's error, m */
};

struct four_wheel_state {
    struct planar_pose pose;
    double forward;   /**< velocity of the centre along the heading, m/s */
    double left;      /**< across it, m/s */
    double turn_rate; /**< rad/s */
    struct four_wheel_contact wheels[JP_WHEELS];
};

/**
 * J since the start:
 *
 *   battery      = electronics + copper + gear + drive + steering
 *   drive + pull = slip + rolling + friction + change of the kinetic energy
 */
struct four_wheel_ledger {
    double battery;     /**< what it has given: ∫ u i of all motors, and the electronics */
    double electronics; /**< ∫ their power */
    double copper;      /**< ∫ i² R, all motors */
    double gear;        /**< lost in gears, of driving and steering */
    double drive;       /**< mechanical work at the wheels; braking gives some back */
    double pull;        /**< work of sloping patches */
    double slip;        /**< lost in sliding contacts */
    double rolling;     /**< lost in rolling */
    double friction;    /**< lost in bearings and gears */
    double steering;    /**< work against the contacts that turn, lost at once */
};

struct four_wheel_plant {
    const struct four_wheel_file *robot;
    struct four_wheel_state state;
    struct four_wheel_ledger ledger;
    struct four_wheel_patch patches[FOUR_WHEEL_PATCHES_MAX];
    size_t patch_count;
    struct cell_pack pack; /**< what feeds it, when has_pack; else the voltage of the robot file, which never falls */
    bool has_pack;
    struct jp_wheels measured; /**< by the encoders, at the end of the last tick; speed: mean of the tick */
    double bus_voltage;        /**< at the end of the last tick, V */
    double slip_max;           /**< largest slip velocity of a contact at the end of the last tick, m/s */
};

/** At rest at a pose, wheels straight, no patches. `robot` stays in use. */
void four_wheel_plant_init(struct four_wheel_plant *plant, const struct four_wheel_file *robot,
                           const struct planar_pose *pose);

/** False when there are FOUR_WHEEL_PATCHES_MAX already. */
bool four_wheel_plant_add_patch(struct four_wheel_plant *plant, const struct four_wheel_patch *patch);

/** From now on cells feed it. Its servos take what power they need at whatever voltage. */
void four_wheel_plant_feed(struct four_wheel_plant *plant, const struct cell_constants *cell,
                           const struct cell_wiring *wiring, const struct cell_condition *condition);

/** One tick of 1/FOUR_WHEEL_RATE_HZ towards these wheel angles and speeds; angles beyond the limit stop there. */
void four_wheel_plant_tick(struct four_wheel_plant *plant, const struct jp_wheels *targets);

/** A patch without end that rises, m/m, towards x and y, of the robot's own ground else. */
struct four_wheel_patch four_wheel_slope(double rise_x, double rise_y);

/** What the balance of the motors misses, J. */
double four_wheel_plant_supply_error(const struct four_wheel_plant *plant);

/** Of body and wheels, J. */
double four_wheel_plant_kinetic_energy(const struct four_wheel_plant *plant);

/** Upper bound of the fastest damping rate, 1/s: the step of the integrator must be a small part of its inverse. */
double four_wheel_plant_damping_rate(const struct four_wheel_file *robot);

#endif
