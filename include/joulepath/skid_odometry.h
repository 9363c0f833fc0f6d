/**
 * Dead reckoning of skid steer and differential drive from wheel encoders, gyro, accelerometer and motor currents.
 *
 * The ticks between two steps add up encoder counts and gyro angle, without loss. A step takes with the increments Δs
 * of the mean way of the treads, Δφ of (right − left)/B and Δg of the gyro's angle:
 *
 *   gyro      Δg = b Δt + r Δφ (1 + growth) + noise: a Kalman filter of two states learns the bias b and r = ρ (1 + γ);
 *             the noise grows with the way and with the turn, so stands tell b, and turns tell r; the more pushes the
 *             robot, the less
 *   scale     γ = γ0 + (r/ρ0 − 1 − γ0) σγ²/(σγ² + σρ²): the part of r that its priors give to the gyro; the rest is
 *             slip, ρ. What a drive has taught of γ is the next one's prior (struct jp_gyro_scale): grounds change,
 *             gyros do not
 *   tilt      ṗ = ω q − ψ̇, q̇ = −ω p: a Kalman filter of the grade p ahead and q to the left and of the accelerometer's
 *             offset. What is measured is p, the pitch gyro tells how it changes, so a turn shows q; what speeds up or
 *             has just done so tells less
 *   slip      treads creep in proportion to their force, by the specific force, f ahead and l = q + v ω/g left:
 *             along = Δs − f (κ |Δs| + λ η Kx |Δθ|) + l η Hx Δθ ∓ κ F min(|Δs|, B |Δφ|/2)
 *             across = −l max(κ |Δs| − Kx |Δθ|/4, 0) + η c |Δθ|,  c = ±f Hy − l λ Ky,  η = (1 + (c/a)⁴)^(−1/4)
 *             Hx and Hy: load that moves to a side or to an axle moves the point about which it turns. It is
 *             between the axles, and the nearer to one, the less the treads yield: η. Tight turns hold what rolls
 *   grip      λ = η F0/F: the force F of the sides that turn it, by the motors' currents, tells how the ground grips
 *   growth    of the ratio, with c² less the square of what the robot slips along as it turns
 *   plan      along the mean heading of the step: (along √(1 − p²), across), and the heading turns by
 *             Δθ = (Δg − b Δt)/(1 + γ) (1 + p²/2 − q²/2)
 *   past      what is learned of b and γ was true before: the pose moves by its sensitivities to them
 *
 * Wheels that stand keep the pose but for that. It is the pose of the middle between the axles, whose position is seen
 * on the map. The grade comes from accelerometer and gyros alone.
 */
#ifndef JOULEPATH_SKID_ODOMETRY_H
#define JOULEPATH_SKID_ODOMETRY_H

#include <joulepath/path_drive.h>
#include <joulepath/point.h>
#include <joulepath/sensors.h>
#include <joulepath/skid_sides.h>
#include <joulepath/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/** One robot; tools/design/skid_odometry.py makes it from the robot file. */
struct jp_skid_odometry_config {
    uint32_t tick_rate;    /**< calls a second; 100…10 000 */
    uint32_t step_ticks;   /**< ticks of a step; 6…32 */
    int32_t way_per_count; /**< way of the tread for one count of a side, 2⁻⁴⁰ m; 2¹²…2³⁰ */
    int32_t turn_per_count; /**< turn of the body for one count of (right − left) without slip, 2⁻⁴⁰ turn; 2¹²…2³⁰ */
    jp_q24 ratio;                  /**< ρ0, turn of the body over that of the wheels by the robot file; 0.1…1.5 */
    jp_q24 ratio_deviation;        /**< σρ, standard deviation of ρ about it; 0.0001…0.5 */
    jp_q24 scale_deviation;        /**< σγ, of the gyro's scale; 0…0.1 */
    jp_turns_per_s bias_deviation; /**< of the gyro's bias at the start; 2⁻¹⁶…0.1 */
    uint32_t bias_memory;          /**< s in which the bias wanders by that; 1 000…100 000 000 */
    jp_turns_per_s gyro_noise;     /**< standard deviation of one reading; 2⁻²⁰…0.1 */
    jp_q24 way_noise; /**< turn that the wheels do not show in a metre, turn/√m, standard deviation; 2⁻¹⁶…0.1 */
    jp_q24 turn_noise;     /**< share of a turn by the wheels that varies, over one radian; 0.001…1 */
    jp_q24 tilt_deviation; /**< of the grade, g; 0.005…0.5 */
    jp_q24 tilt_change;    /**< of the grade in a metre, g/√m; 0.001…1 */
    jp_q24 accel_noise;    /**< of the accelerometer's mean over a step, g; 0.0005…0.1 */
    jp_q24 accel_offset;   /**< deviation of its offset, g; 0…0.5 */
    jp_q24 ratio_growth;   /**< share by which ρ grows for (m/turn)² that it slips aside as it turns; 0…16 1/m² */
    jp_q24 creep;          /**< κ, slip of the treads per g of specific force; 0…1 */
    jp_q24 turn_creep_along;  /**< Kx, way per radian of turn and g; 0…8 m */
    jp_q24 turn_creep_across; /**< Ky; 0…8 m */
    jp_q24 turn_shift_along;  /**< Hx, way per radian to the left and g to the left, by the load that moves; 0…8 m */
    jp_q24 turn_shift_across; /**< Hy, to the left, per radian to the left and g ahead; 0…8 m */
    jp_q24 turn_slide_most;   /**< a, to the side per radian at most, half the wheelbase; 0…4 m */
    jp_q24 caster_drag;       /**< force of the caster on its way over the weight, g; 0…0.2 */
    jp_q24 turn_force;        /**< (right − left) of the forces that turn it on the spot over the weight, g; 0…2 */
    jp_q24 force_per_ampere;  /**< force of a side over the weight without losses, g/A; 0…16 */
    jp_q24 efficiency;        /**< of the gear; 0.1…1 */
    jp_q24 rolling;           /**< resistance over load; 0…0.5 */
    jp_q24 way_deviation;     /**< share of the way by which the wheels are wrong, standard deviation; 0…0.1 */
    jp_q24 way_drift;         /**< random walk of the position over a metre, m/√m; 0…0.5 */
    jp_q24 turn_drift;        /**< the same over a radian of turn, m/√rad; 0…0.5 */
};

/** What is left to do of a step; private. */
enum jp_skid_odometry_part {
    JP_SKID_ADD_UP,
    JP_SKID_SLIP,
    JP_SKID_MOVE,
    JP_SKID_FILTER_HEADING,
    JP_SKID_CORRECT_POSE,
    JP_SKID_FILTER_TILT
};

/** Increments of a step; private. */
struct jp_skid_step {
    int32_t way;        /* of the treads, m, Q32 */
    int32_t side_way;   /* of a side against the mean, without sign */
    int32_t wheel_turn; /* 2⁻³² turn; so the next three */
    int32_t gyro_turn;
    int32_t gyro_pitch;
    int32_t turn; /* of the gyro, corrected */
    jp_q24 force; /* mean specific force ahead, g */
    int32_t counts[JP_SKID_SIDES];
    jp_q16 current[JP_SKID_SIDES];
    int32_t forward;        /* of the robot, m, Q32 */
    int32_t forward_before; /* in the step before */
    int32_t sideways;       /* to the left */
    int32_t pushed_turn;    /* by the wheels; a robot that is pushed aside skids less; 2⁻³² turn */
    jp_q24 pushed;          /* share of the ratio that what pushes it may change */
    int32_t plan;           /* forward on the map, m, Q32 */
    int32_t heading_turn;   /* on the map, 2⁻³² turn */
    int32_t way_x;          /* on the map, m, Q32 */
    int32_t way_y;
};

/** Filter of the gyro's bias and of r; private. */
struct jp_skid_gyro {
    int32_t bias;      /* of a step, 2⁻⁴⁰ turn */
    int32_t ratio;     /* r, Q30 */
    int32_t scale;     /* 1/(1 + γ), Q30 */
    int32_t bias_bias; /* covariance over the squares of the deviations at the start, Q30 */
    int32_t bias_ratio;
    int32_t ratio_ratio;
    int32_t bias_change; /* by the last step */
    int32_t scale_change;

    int32_t bias_unit;        /* bias_deviation in a step, 2⁻³² turn */
    int32_t ratio_unit;       /* deviation of r at the start, Q24 */
    int32_t ratio_weight;     /* deviation of r over that of b in a step, 2⁻³² turn; Q40 */
    int32_t ratio_reciprocal; /* 1/ρ0, Q24 */
    int32_t scale_share;      /* σγ²/(σγ² + σρ²), Q30 */
    int32_t scale_error;      /* γ0, Q30 */
    jp_q24 scale_deviation;   /* σγ */
    int32_t ratio_start;      /* ρ0 (1 + γ0), Q30 */
    int32_t bias_growth;      /* of bias_bias in a step */
    int32_t way_variance;     /* of a metre over bias_unit², Q14 */
    int32_t turn_variance;    /* the same of 2⁻³² turn, Q30 */
    int32_t per_turn_noise;   /* 1/turn_noise, Q4 */
    int64_t gyro_variance;    /* the same of a reading, Q30 */
    int64_t count_variance;   /* and of a count */
};

/** What the filter of the tilt knows. */
enum { JP_SKID_TILT_AHEAD, JP_SKID_TILT_LEFT, JP_SKID_TILT_OFFSET, JP_SKID_TILT_STATES };

/** Filter of the grades and of the accelerometer's offset; private. */
struct jp_skid_tilt {
    jp_q24 state[JP_SKID_TILT_STATES];              /* g */
    int32_t variance[JP_SKID_TILT_STATES];          /* over tilt_deviation², Q30 */
    int32_t offset_covariance[JP_SKID_TILT_OFFSET]; /* of the grades with the offset */
    int32_t grade_covariance;
    int32_t pitch_bias;     /* of a step, 2⁻⁴⁰ turn */
    jp_q24 unrest;          /* the greatest acceleration of late, fading, g */
    int32_t accel_variance; /* over tilt_deviation², Q30 */
    int32_t reciprocal;     /* 1/tilt_deviation, Q15 */
    int32_t fading;         /* 1/m, Q14 */
    int32_t acceleration;   /* 1/(Δt² g), 1/m, Q8 */
};

/** Slip by force; private. */
struct jp_skid_slip {
    int32_t along; /* of the last step in its turn, m/turn, Q24 */
    int32_t across;
    jp_q24 turn_force;   /* as learned */
    int32_t looseness;   /* λ, Q12 */
    int32_t creep_along; /* 2π λ Kx, m/turn, Q24 */
    int32_t creep_across;
    int32_t shift_along; /* 2π Hx, m/turn, Q24 */
    int32_t shift_across;
    int32_t most;        /* 2π a, m/turn, Q24 */
    int32_t per_most;    /* its reciprocal, turn/m, Q16 */
    int32_t wanted;      /* across in the last step if treads crept in proportion to their load, m/turn, Q24 */
    int32_t yielding;    /* the share of it that they do, Q15 */
    int32_t held;        /* of the way's creep across, in a turn, m/turn, Q24 */
    int32_t centripetal; /* 2π/(Δt² g), 1/(m turn), Q8 */
    jp_q24 braking;      /* 1/efficiency */
};

/** What was driven, and how far the pose moves if bias or scale was another one; private. */
struct jp_skid_past {
    int32_t way;    /* m, Q16 */
    int32_t turn;   /* of either sign, turn, Q16 */
    int32_t turned; /* by the gyro since the start, turn, Q24 */
    int32_t steps;  /* in motion, Q8; forgotten slowly */
    int32_t bias_x; /* m in so many steps, Q8 */
    int32_t bias_y;
    int32_t scale_x; /* m in so many turns, Q16 */
    int32_t scale_y;
};

/** Where the robot is and how it moves, at the last step; turn_rate at the last tick. */
struct jp_skid_odometry {
    int64_t x;                /**< m, Q32.32 */
    int64_t y;                /**< m, Q32.32 */
    jp_phase heading;         /**< left turn positive */
    jp_q24 speed;             /**< along the ground, m/s, mean of the step */
    jp_turns_per_s turn_rate; /**< without bias, in the plane of the ground */
    jp_q24 steering_ratio;    /**< ρ as learned */
    jp_turns_per_s bias_rate; /**< of the gyro, as learned */
    /** Private. */
    struct {
        enum jp_skid_odometry_part next;
        uint32_t ticks;     /* since the last step */
        jp_phase yaw_angle; /* of the gyro, since the last step */
        jp_phase pitch_angle;
        int32_t accel_sum; /* g, Q24 */
        bool is_moving;
        uint32_t stand_steps;
        uint32_t stand_steps_min;
        int32_t phase_per_rate;
        int32_t mean_share;              /* 1/step_ticks, Q31 */
        int32_t speed_per_way;           /* 1/Δt, Q16 */
        uint32_t encoder[JP_SKID_SIDES]; /* at the last step */
        uint32_t stand[JP_SKID_SIDES];   /* counts that the wheels have stayed at */
        struct jp_skid_step step;
        struct jp_skid_gyro gyro;
        struct jp_skid_tilt tilt;
        struct jp_skid_slip slip;
        struct jp_skid_past past;
    } internal;
};

/** Most that the scale of a gyro is off. */
#define JP_GYRO_SCALE_MAX ((int32_t)1 << 28) /* 1/4 in Q30 */

/** Most that its deviation may be. */
#define JP_GYRO_SCALE_DEVIATION_MAX (JP_Q24(0.1) * 64) /* Q30 */

/** What is known of the scale of a gyro, which lasts: to be kept over power-off. */
struct jp_gyro_scale {
    int32_t error;     /**< it shows 1 + error of a turn, Q30; ±JP_GYRO_SCALE_MAX */
    int32_t deviation; /**< standard deviation, Q30; 0: nothing is known; up to JP_GYRO_SCALE_DEVIATION_MAX */
};

/** What is known, with standard deviations; of the pose since the start. */
struct jp_skid_estimate {
    jp_turns_per_s gyro_bias;
    jp_turns_per_s gyro_bias_deviation;
    jp_q24 steering_ratio; /**< ρ */
    jp_q24 steering_ratio_deviation;
    jp_q24 slip; /**< share of the way of the treads in the last step that the robot did not go */
    jp_q24 slip_deviation;
    jp_q24 grade_ahead; /**< sine of the slope, up is positive */
    jp_q24 grade_left;
    jp_q24 heading_deviation; /**< rad */
    int64_t xx;               /**< covariance of the position, m², Q32.32 */
    int64_t xy;
    int64_t yy;
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. Not
 *  for ISRs. */
enum jp_status jp_skid_odometry_check(const struct jp_skid_odometry_config *config, const char **field);

/** Starts at (0, 0) with heading 0. It learns the bias best at rest, so a stand of a second or two should follow.
 *  Cannot fail. A dozen 64-bit divisions; not for the tick. */
void jp_skid_odometry_start(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                            const struct jp_sensors *sensors);

/** After the start, before the first tick: its gyro's scale as another drive has found it. With nothing known it is as
 *  the configuration says. Cannot fail. As jp_skid_odometry_start(). */
void jp_skid_odometry_know_scale(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                                 const struct jp_gyro_scale *scale);

/** The same as it is known now: never better than the file's knowledge of the wheels allows, for their error is that of
 *  all drives. Two square roots and a 64-bit division; from any context. Cannot fail. */
void jp_skid_odometry_scale(const struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                            struct jp_gyro_scale *scale);

/** One tick. Steps are limited to ±0.5 m and ±½ turn, readings of the accelerometer to ±2 g. Cannot fail; constant
 *  time, at most one 32-bit division: every tick adds up, and the last of a step and the next five take a part of it
 *  each.
 * For the control ISR. */
void jp_skid_odometry_update(struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                             const struct jp_sensors *sensors);

/** Where the robot is now: as the last step has left it, and on since then as it moved in that step. Constant time; for
 *  the control ISR, after jp_skid_odometry_update(). */
void jp_skid_odometry_now(const struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                          struct jp_point *position, jp_angle *heading);

/** How far the robot slides aside on the slope as it knows it. Constant time; for the control ISR. */
void jp_skid_odometry_slide(const struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                            struct jp_path_slide *slide);

/** What it knows now. Six square roots and a 64-bit division; not for the tick, and no tick may come between. Cannot
 *  fail. */
void jp_skid_odometry_estimate(const struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config,
                               struct jp_skid_estimate *estimate);

#ifdef __cplusplus
}
#endif

#endif
