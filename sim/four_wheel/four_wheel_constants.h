/** Constants of a robot with four steered and driven wheels and a laser scanner, and how it is driven. */
#ifndef JOULEPATH_SIM_FOUR_WHEEL_FOUR_WHEEL_CONSTANTS_H
#define JOULEPATH_SIM_FOUR_WHEEL_FOUR_WHEEL_CONSTANTS_H

#include "sim/files/config_fields.h"

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
        double time_constant_s;      /**< of the servo, while its rate is not at the limit */
        double friction_nm;          /**< of the contact that turns on the spot, a wheel */
        double contact_m;            /**< mean radius of the contact: what rolls this fast while it turns scrubs less */
        double efficiency;           /**< of the gear */
        double torque_constant_nm_a; /**< at the steering axis, with the gear's losses */
        double resistance_ohm;       /**< of the motor */
        double radius_min_m;         /**< of turns while driving, of the robot's centre */
    } steering;
    struct {
        double speed_m_s;         /**< of a wheel's tread */
        double acceleration_m_s2; /**< of a wheel's tread, what the controller may ask for */
        double torque_nm;         /**< at a wheel */
        double time_constant_s;   /**< of the speed servo with the robot's mass, while the torque is not at the limit */
        double friction_nm_s_per_rad; /**< bearings and gear, a wheel */
        double efficiency;            /**< of the gear */
        double torque_constant_nm_a;  /**< at the wheel, with the gear's losses */
        double resistance_ohm;        /**< of the motor with its bridge */
    } drive;
    struct {
        double stiffness_n_s_per_m; /**< force over slip velocity, a wheel */
        double friction;            /**< largest force over load */
        double rolling;             /**< rolling resistance over load */
    } tyre;
    struct {
        double voltage_v; /**< of the battery */
        double power_w;   /**< of computer, laser scanner and servos at rest */
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
    struct {
        double range_m;     /**< what is farther away is not looked at */
        double gap_m;       /**< between points of different things */
        double tolerance_m; /**< of points from the line that stands for them */
        int beams_min;      /**< fewer points side by side are noise */
    } scan;
    struct {
        double extent_m;      /**< of a thing that may move */
        double range_m;       /**< how far it looks for them */
        double speed_min_m_s; /**< slower things stand */
        double speed_max_m_s; /**< nothing moves faster */
        double margin_m;      /**< how far something may be after a second from where its velocity leads */
    } movers;
    struct {
        double clearance_m;       /**< that is kept from who walks or may walk on */
        double acceleration_m_s2; /**< of people who start and stop */
        double rest_s;            /**< for which the robot has stood when somebody can reach it */
        double stays_s;           /**< who has stood for so long stays */
    } people;
    struct {
        double speed_m_s;
        double reverse_m_s;
        double turn_rate_rad_s;
        double acceleration_m_s2;
        double turn_acceleration_rad_s2;
        double clearance_m; /**< of the footprint from obstacles, wanted */
        double interval_s;  /**< between two poses */
        double hysteresis_s;
        int rounds; /**< of association of obstacles, a cycle */
        int steps;  /**< of Levenberg-Marquardt, in a round */
    } band;
    struct { /**< of the band's squared residuals */
        double nonholonomic_per_m2;
        double speed_s2_per_m2;
        double turn_rate_s2_per_rad2;
        double turn_radius_s2_per_m2;
        double acceleration_s4_per_m2;
        double turn_acceleration_s4_per_rad2;
        double obstacle_per_m2;
        double path_per_m2;
        double energy_per_j;
        double no_reversing_s2_per_m2;
        double wheel_odometry_per_m2; /**< and rad², as below */
        double laser_odometry_per_m2;
    } weights;
    struct {
        double from_deg; /**< heading error beyond which the robot turns in place before it drives */
        double rate_rad_s;
        double acceleration_rad_s2;
        double clearance_m;       /**< of the footprint from obstacles, in a turn and in a step */
        double glide_clearance_m; /**< of the footprint from obstacles while the robot turns as it drives */
        double second_w; /**< what a second less is worth beyond its energy, where ways to turn are chosen by cost */
        double step_m_s; /**< with the wheels across, to where there is room to turn */
    } turning;
    struct {
        double horizon_m; /**< of the path that is planned at a time */
        double position_tolerance_m;
        double heading_tolerance_deg;
        double latency_s; /**< from a cycle's pose to wheels that do what was decided */
        double jump_m;    /**< largest step of the laser's pose away from the prediction; of its heading: rad */
        double wait_s;    /**< before giving up */
        int dropouts;     /**< scans that may be missing, and poses that may jump, in a row */
        double blind_m;   /**< distance driven by wheel odometry alone */
    } patrol;

    /** Where the robot is on the map. */
    struct {
        double way_share;           /**< by which wheel odometry errs, standard deviation */
        double turn_share;          /**< likewise */
        double deviation_rad_per_m; /**< of its heading, likewise */
        double start_m;             /**< standard deviation of the pose that it is told at the start */
        double start_deg;
        double lost_m; /**< standard deviation beyond which the robot is lost */
        double lost_deg;
    } localiser;
    struct {
        double speed_m_s;
        double lookahead_s;
        double lookahead_min_m;
        double lookahead_max_m;
        double lateral_acceleration_m_s2;
        double acceleration_m_s2;
        double tolerance_m; /**< of the path's end */
    } pursuit;
};

#endif
