/** Robot files whose type is "four_wheel": four steered and driven wheels and a laser scanner. */
#ifndef JOULEPATH_SIM_FOUR_WHEEL_FILE_H
#define JOULEPATH_SIM_FOUR_WHEEL_FILE_H

#include <joulepath/four_wheel.h>

#include "config_fields.h"

/** Ticks of the controller in a second. */
#define FOUR_WHEEL_RATE_HZ 100

struct four_wheel_file {
    char name[CONFIG_NAME_SIZE];
    struct {
        double length_m; /**< of the footprint, centred between the wheels */
        double width_m;
        double wheelbase_m;   /**< axle to axle */
        double track_m;       /**< left to right contact */
        double mass_kg;       /**< with the wheels */
        double inertia_kg_m2; /**< about the vertical through the centre */
    } body;
    struct {
        double radius_m;
        double inertia_kg_m2; /**< about the axle, with the rotor behind its gear */
    } wheel;
    struct {
        double limit_deg; /**< to either side of straight ahead */
        double rate_rad_s;
        double time_constant_s; /**< of the servo, while its rate is not at the limit */
        double friction_nm;     /**< of the contact that turns on the spot, a wheel */
    } steering;
    struct {
        double speed_m_s;         /**< of a wheel's tread */
        double acceleration_m_s2; /**< of a wheel's tread, what the controller may ask for */
        double torque_nm;         /**< at a wheel */
        double time_constant_s;   /**< of the speed servo with the robot's mass, while the torque is not at the limit */
        double friction_nm_s_per_rad; /**< bearings and gear, a wheel */
    } drive;
    struct {
        double stiffness_n_s_per_m; /**< force over slip velocity, a wheel */
        double friction;            /**< largest force over load */
        double rolling;             /**< rolling resistance over load */
    } tyre;
    struct {
        double power_w; /**< of computer, laser scanner and servos at rest */
    } electronics;
    struct {
        double x_m; /**< forward of the centre */
        double y_m; /**< to the left of the centre */
        int beams;
        double field_deg; /**< spanned by the beams, symmetric about straight ahead */
        double range_m;
        double noise_m; /**< standard deviation */
        double rate_hz; /**< at most FOUR_WHEEL_RATE_HZ, which it divides */
    } laser;
    struct {
        int wheel_counts_per_turn;
        int steering_counts_per_turn;
    } encoder;
};

/** Of struct four_wheel_file. */
extern const struct config_field four_wheel_fields[];
extern const size_t four_wheel_field_count;

/**
 * Reads and checks a robot file. On failure prints one line on stderr (file, key or line, what, what to do), returns
 * false, and *robot is not to be used.
 */
bool four_wheel_file_load(const char *path, struct four_wheel_file *robot);

/** What the core needs of it, for FOUR_WHEEL_RATE_HZ. jp_four_wheel_check() accepts that of every robot that loads. */
struct jp_four_wheel_config four_wheel_config(const struct four_wheel_file *robot);

#endif
