/**
 * A robot whose two sides steer it by their speeds, over ground that rises and falls, and its energy ledger, in double
 * precision: skid steer (two axles or more, the wheels of a side turn together) or differential drive (one axle, a
 * caster).
 *
 * Body: rigid, at velocity (forward, left) in the plane that lies best on the ground under its contacts, and turning
 * about that plane's normal. Gravity acts by the gradient of the elevation under the centre of mass, so no energy is
 * won or lost on any ground; what the curvature of the ground does to the loads is left out.
 *
 * Loads: a plane over the contacts (springs that are alike), from gravity, the height of the centre of mass and the
 * contacts' forces, which it follows within SKID_SUSPENSION_TIME. No contact pulls; a robot whose contacts would have
 * to has tipped and stays where it is.
 *
 * Tyres: the lumped LuGre model in two dimensions (Velenis, Tsiotras, Canudas-de-Wit, MED 2002) without Stribeck
 * effect, normalised by the load N. With the slip velocity s of the tread over the ground and its deflection z
 *
 *   ż = s − (σ0 |s|/μ + κ |ω r|) z,  force = −N (σ0 z + σ1 ż),  κ = 1.2/contact length
 *
 * so the force grows by σ0/κ of the load for each unit of slip, stays within the circle μ N, and holds the robot on a
 * slope without creep. σ1 fades at high slip, so that the contact never gives what it did not get.
 *
 * Wheels: rolling resistance, gear and bearings are dry friction; they hold until the wheel has turned by what it turns
 * at limits.speed_m_s in SKID_PRESLIDING_TIME, without creep.
 *
 * Motor of a side: i = (d V − K g ω)/R within the current limit; its gear passes η of the driving torque, and braking
 * takes 1/η of the motor's. Bridges off: no current flows, rolling resistance and dry friction alone hold or brake.
 * Both bridges on with duty 0: the motors are shorted and brake, and the robot creeps down a slope. Bridges return to
 * the battery what motor.recuperation says, and burn the rest.
 */
#ifndef JOULEPATH_SIM_SKID_STEER_SKID_PLANT_H
#define JOULEPATH_SIM_SKID_STEER_SKID_PLANT_H

#include <stdbool.h>

#include "sim/base/cell_pack.h"
#include "sim/base/planar.h"
#include "sim/skid_steer/skid_ground.h"
#include "sim/skid_steer/skid_steer_model.h"

/** The integrator's longest step, s. */
#define SKID_STEP 0.00025

/** A step follows rates up to this many in its length. */
#define SKID_STEP_RATE_MAX 1.5

#define SKID_SUSPENSION_TIME 0.02
#define SKID_PRESLIDING_TIME (1.0 / 1500)

enum { SKID_LEFT, SKID_RIGHT, SKID_SIDES };

#define SKID_CONTACTS_MAX (2 * SKID_STEER_AXLES_MAX + 1)

/** What acts on the robot during one step. */
struct skid_input {
    double duty[SKID_SIDES]; /**< −1…1 of the bus voltage; positive drives forward */
    bool driven;             /**< false: bridges off */
};

/**
 * J since the start. At any time
 * battery = supply + electronics + bridge + copper + gear + slip_along + slip_across + rolling + caster + impact
 *           + change of the kinetic and potential energy.
 */
struct skid_ledger {
    double battery;     /**< ∫ V0 I: of the cells, less what polarisation takes; falls while they are charged */
    double supply;      /**< lost in the battery's resistance */
    double electronics; /**< what the electronics draw */
    double bridge;      /**< braking energy that the bridges burn */
    double copper;      /**< ∫ i² R, both motors */
    double gear;        /**< lost in gears and bearings */
    double slip_along;  /**< work of the tyres' slip along the wheels; what their treads store included */
    double slip_across; /**< the same across them: scrubbing */
    double rolling;     /**< of the driven wheels */
    double caster;
    double impact; /**< kinetic energy that a tipping robot lost */
};

/** Doubles only. */
struct skid_side {
    double angle; /**< of the wheels since the start, rad */
    double rate;  /**< rad/s */
    double drag;  /**< of dry friction, −1…1 of the most that it can be */
};

/** Deflection of a contact's tread, m; doubles only. */
struct skid_tread {
    double along;
    double across;
};

/** All that is integrated. Doubles only. */
struct skid_state {
    double x; /**< of the centre of mass on the map, m */
    double y;
    double heading;        /**< of the body's x axis on the map, rad */
    double forward;        /**< m/s, in the plane of the ground */
    double left;           /**< m/s */
    double turn_rate;      /**< about the normal of the ground, rad/s */
    double pressed_ahead;  /**< specific force of the contacts that the loads follow, m/s² */
    double pressed_across; /**< to the left */
    struct skid_side sides[SKID_SIDES];
    struct skid_ledger ledger;
    struct skid_tread treads[SKID_CONTACTS_MAX]; /**< axle by axle from the rear, left before right; then the caster */
};

/** Where a contact is and how it grips. */
struct skid_contact {
    struct planar_point place; /**< from the centre of mass, m */
    int side;                  /**< SKID_SIDES: none, it is the caster */
    double friction;
    double resistance; /**< of its ground to rolling, against the robot file's */
    double stiffness;
    double damping;
    double relaxation;   /**< κ, 1/m */
    double static_share; /**< of the weight, on level ground at rest */
    bool lifted;         /**< it carries nothing; the others carry its share */
};

/** How the robot lies on the ground and what its contacts do, at the end of the last step. */
struct skid_attitude {
    double rise_ahead;  /**< of the body's plane, over run, along its x axis */
    double rise_across; /**< the same to its left */
    double normal[3];   /**< of the plane, in the map's axes, of length 1 */
    double roll_rate;   /**< of the body about its x axis, rad/s */
    double pitch_rate;  /**< about its y axis, forward positive */
    double force_ahead; /**< specific force of the contacts, m/s² */
    double force_left;
    double load[SKID_CONTACTS_MAX]; /**< N */
    double current[SKID_SIDES];     /**< A; positive drives forward */
    double bus_voltage;             /**< V */
};

struct skid_plant {
    struct skid_steer_model model;
    struct skid_ground ground;
    struct skid_surface surface;
    struct skid_contact contacts[SKID_CONTACTS_MAX];
    int contact_count;
    double loads[3][3];        /**< inverse of the moments of the contacts' places */
    double side_inertia;       /**< wheels and rotor of a side, at the wheels, kg·m² */
    double presliding;         /**< rad */
    double step;               /**< of the integrator, at most, s */
    double jam[SKID_SIDES];    /**< dry friction of a side beside its own, N·m */
    double start_elevation;    /**< of the centre of mass, m */
    struct cell_source source; /**< what feeds it: supply of the robot file, which never empties, or, */
    struct cell_pack pack;     /**< when has_pack, these cells, once a step */
    bool has_pack;
    struct skid_state state;
    struct skid_attitude attitude;
    bool tipped;
};

/** At rest at a pose of the middle between its axles, with wheels at angle 0. The model is copied; what `ground` points
 *  to stays in use. */
void skid_plant_init(struct skid_plant *plant, const struct skid_steer_model *model, const struct skid_ground *ground,
                     const struct planar_pose *pose);

/** Lays a surface on the ground, what its pointer shows stays in use. What a wheel is on changes between the steps. */
void skid_plant_lay(struct skid_plant *plant, const struct skid_surface *surface);

/** From now on cells feed it. */
void skid_plant_feed(struct skid_plant *plant, const struct cell_constants *cell, const struct cell_wiring *wiring,
                     const struct cell_condition *condition);

/** Runge–Kutta steps (4th order) of equal length, plant->step at most; the ledger is integrated with the state. */
void skid_plant_step(struct skid_plant *plant, const struct skid_input *input, double seconds);

/** Of the middle between the axles, on the map. */
struct planar_pose skid_plant_pose(const struct skid_plant *plant);

/** Of body, wheels and rotors, J. */
double skid_plant_kinetic_energy(const struct skid_plant *plant);

/** Against the start, J. */
double skid_plant_potential_energy(const struct skid_plant *plant);

/** What the ledger misses: battery less all that it went to, J; `start`: the kinetic energy at the start. */
double skid_plant_residual(const struct skid_plant *plant, double start);

/** Upper bound of the fastest rate of the equations at speeds up to twice limits.speed_m_s, 1/s. */
double skid_plant_rate(const struct skid_steer_model *model);

#endif
