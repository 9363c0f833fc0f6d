/**
 * The balancing robot's non-linear equations of motion and its energy ledger, in double precision.
 *
 * State: wheel angle θ (mean of both wheels, absolute), body pitch ψ (forward positive), yaw φ (left positive), their
 * rates, and the position of the wheel axis' middle on the plane. Each wheel turns at θ̇ ∓ W/(2R) φ̇ (left, right), its
 * motor carries i = (u − n Kb ω)/Rm with ω the wheel's speed relative to the body, and drives it with n Kt i.
 * The model is that of the paper's reference robot: it leaves out the gyroscopic pair ±M L R sinψ φ̇ (φ̇ on θ, θ̇ on φ),
 * which does no work.
 */
#ifndef JOULEPATH_SIM_BALANCER_PLANT_H
#define JOULEPATH_SIM_BALANCER_PLANT_H

#include <stdbool.h>

#include "sim/balancer/robot_constants.h"

#define PLANT_GRAVITY 9.81 /**< m/s² */

/** Pitch at which the body hits the ground: 75°, rad. */
#define PLANT_FALL_PITCH 1.3089969389957472

struct plant_state {
    double wheel; /**< θ, rad */
    double pitch; /**< ψ, rad */
    double yaw;   /**< φ, rad */
    double wheel_rate;
    double pitch_rate;
    double yaw_rate;
};

/** A step is stable while the fastest damping rate is below this many steps. */
#define PLANT_STEP_RATE_MAX 2.5

/** What acts on the robot during one step. */
struct plant_input {
    double voltage_left;  /**< V */
    double voltage_right; /**< V */
    bool driven;          /**< false: bridges off, no current flows and the robot coasts */
    double push_n;        /**< horizontal force forward at the body's centre of mass */
    double yaw_torque_nm; /**< from outside, left positive */
};

/**
 * Energies since the start, J. At any time
 * mechanical energy = its start value + electrical − copper − friction − conversion + push − impact + change.
 */
struct plant_ledger {
    double electrical; /**< ∫ u i, both motors; falls while they generate */
    double copper;     /**< ∫ i² Rm */
    double friction;   /**< ∫ fm ω² + fw θ̇², each wheel */
    double conversion; /**< ∫ (Kb − Kt) n i ω: the motors' loss between back-EMF and torque, such as iron, brushes and
                            gears; 0 for an ideal motor (Kt = Kb), negative while one with Kb > Kt generates */
    double push;       /**< work of push and yaw torque */
    double impact;     /**< mechanical energy that the ground took in a fall, or the hand that holds the robot */
    double change;     /**< mechanical energy that came with a payload and left with it: plant_change() */
    double motor;      /**< ∫ (ul² + ur²)/Rm: the paper's motor energy; not part of the balance */
};

struct plant_acceleration {
    double wheel; /**< rad/s² */
    double pitch;
    double yaw;
};

/** Constants of the equations. */
struct plant_constants {
    double wheel_radius;
    double body_height;    /**< L */
    double half_track;     /**< W/(2R) */
    double wheel_inertia;  /**< (2m+M)R² + 2Jw + 2n²Jm */
    double pitch_inertia;  /**< M L² + Jψ + 2n²Jm */
    double coupling;       /**< M L R */
    double rotor_coupling; /**< 2n²Jm */
    double yaw_inertia;    /**< upright */
    double swing_inertia;  /**< M L² */
    double weight_moment;  /**< M g L */
    double resistance;
    double torque_per_ampere; /**< n Kt, at the wheel */
    double volts_per_rate;    /**< n Kb, at the wheel */
    double motor_friction;
    double ground_friction;
};

struct plant {
    struct plant_constants constants;
    struct plant_state state;
    struct plant_ledger ledger;
    double x;    /**< m */
    double y;    /**< m */
    bool held;   /**< a hand holds the robot: it does not move, driven motors stall */
    bool fallen; /**< as held, by the ground */
};

/** Upright and at rest at the origin. */
void plant_init(struct plant *plant, const struct robot_file *robot);

/** From now on the constants are those of `robot`; state and ledger go on, so a payload comes and leaves at the robot's
 *  own speed. */
void plant_change(struct plant *plant, const struct robot_file *robot);

/** One Runge–Kutta step (4th order) with constant input; the ledger is integrated with the state. */
void plant_step(struct plant *plant, const struct plant_input *input, double seconds);

/** A hand stops the robot, sets it to this pitch, also after a fall, and holds it. */
void plant_hold(struct plant *plant, double pitch);

/** The hand lets go. */
void plant_release(struct plant *plant);

/** Accelerations in the present state. */
struct plant_acceleration plant_acceleration(const struct plant *plant, const struct plant_input *input);

/** Wheel speeds relative to the body, rad/s. */
double plant_motor_rate_left(const struct plant *plant);
double plant_motor_rate_right(const struct plant *plant);

/** Motor currents, A; positive drives forward. */
double plant_current_left(const struct plant *plant, const struct plant_input *input);
double plant_current_right(const struct plant *plant, const struct plant_input *input);

/** Kinetic and potential energy, J; the wheel axis is height 0. */
double plant_mechanical_energy(const struct plant *plant);

/** Upper bound of the fastest damping rate near upright, 1/s. */
double plant_damping_rate(const struct plant_constants *constants);

#endif
