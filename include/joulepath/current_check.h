/**
 * Checks the current sensors: compares what each one measures with the current that voltage and speed cause.
 *
 *   expected  i = (u − kb ω)/Rm            measured  = offset + gain · expected
 *
 * Offset and gain of each motor are estimated by recursive least squares with forgetting, from samples at any steady
 * rate of 10 a second or more; 100 are better. The state is means and second moments, so it stays bounded however long
 * the robot stands: while the expected current hardly varies, only the offset is estimated; the gain keeps its last
 * estimate with a growing uncertainty, and nothing new is stated of it. Samples that no longer lie on one line with the
 * earlier ones show a sudden change: all before it is forgotten. When a sensor changes in the same moment as the
 * current, the finding can be another one for a while.
 *
 * What it can and cannot tell:
 *   - It finds an offset, also while the robot stands.
 *   - It finds the gain of one sensor against that of the other.
 *   - A gain that is off alike in both motors may be warm or cold windings (Rm rises by 0.39 % a kelvin, which is a
 *     gain of 1/1.1 at 26 K) as well as a reference voltage that both sensors share. Voltage, speed and current do not
 *     tell these apart: that takes a known friction or inertia, which the robot only learns. Up to `resistance` the
 *     windings are taken to be the cause, and their energy is measured correctly.
 *   - A wrong bus voltage scales u: it shows as gain and offset that follow the speed, or not at all.
 *   - Estimated speed lags behind an acceleration, which makes the gain of a sound sensor a little less than 1:
 *     0.978 on courier24. `gain` should be well above that.
 */
#ifndef JOULEPATH_CURRENT_CHECK_H
#define JOULEPATH_CURRENT_CHECK_H

#include <stdbool.h>

#include <joulepath/monitor.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Bits of what was found. */
enum jp_current_finding {
    JP_CURRENT_OFFSET_LEFT = 1 << 0,  /**< the left sensor's offset is beyond `offset` */
    JP_CURRENT_OFFSET_RIGHT = 1 << 1, /**< the right sensor's is */
    JP_CURRENT_GAIN_LEFT = 1 << 2,    /**< the left sensor's gain is beyond 1 ± `gain`, and not as the right one's */
    JP_CURRENT_GAIN_RIGHT = 1 << 3,   /**< the right sensor's is; both bits: beyond 1 ± `resistance` alike */
    JP_CURRENT_RESISTANCE = 1 << 4,   /**< both gains are off alike: motor resistance, or the gain of both sensors */
    JP_CURRENT_CHANGING = 1 << 5 /**< a finding begins or ends, or the samples do not lie on one line, as when a sensor
                                      changed: it may become any of the first four */
};

/** Findings that make a measured current unreliable: all but JP_CURRENT_RESISTANCE. */
#define JP_CURRENT_DOUBT 0x2FU

/** A finding must hold for the whole estimate ± so many standard deviations. */
#define JP_CURRENT_DEVIATIONS 4

/** Standard deviation of a gain that has not been estimated since the start or the last sudden change, or not for a
 * long time; the gain is then taken to be 1, or its last estimate. */
#define JP_CURRENT_DEVIATION_MAX JP_Q16(0.25)

/** Samples with a larger current, A, measured or expected, are left out. */
#define JP_CURRENT_CHECK_MAX JP_Q16(60)

struct jp_current_check_config {
    jp_q16 offset;     /**< larger offsets are findings, A; 0.005…10 */
    jp_q16 gain;       /**< larger relative deviations of one gain from 1 are findings; 0.01…0.5 */
    jp_q16 resistance; /**< larger relative deviations of both gains are findings against the sensors; gain…0.5 */
    jp_q16 excitation; /**< least standard deviation of the expected current for a gain to be estimated, A; 0.02…10 */
    uint16_t memory;   /**< samples after which one counts 1/e; 128…4 096 */
};

/** Currents of one moment, with the voltages and rates that caused them. */
struct jp_motor_sample {
    struct jp_voltages voltages; /**< that drove the motors until then */
    jp_turns_per_s wheel_rate;   /**< mean of the wheels, relative to the body, turn/s */
    jp_turns_per_s yaw_rate;     /**< turn/s */
    jp_q16 current_left;         /**< measured, A */
    jp_q16 current_right;        /**< measured, A */
};

/** One sensor, as estimated. */
struct jp_current_estimate {
    jp_q16 offset;           /**< A: measured at no current, to be subtracted */
    jp_q16 offset_deviation; /**< standard deviation, A; INT32_MAX: not since the start, when offset is 0, or
                                  the last sudden change */
    jp_q16 gain;             /**< ±4 */
    jp_q16 gain_deviation;   /**< standard deviation */
};

/** Weighted moments of one motor's samples. Private. */
struct jp_current_moments {
    uint16_t count;
    int32_t mean_expected; /* Q24, A */
    int32_t mean_measured;
    int64_t expected; /* Q48, A²: second central moments */
    int64_t product;
    int64_t measured;
};

/** The cause of gains that deviate. Private. */
enum jp_current_blame { JP_CURRENT_NOBODY, JP_CURRENT_MOTORS, JP_CURRENT_SENSOR };

/** A finding that must hold for a while before it is reported. Private. */
struct jp_current_statement {
    uint16_t samples;
    bool holds;
};

struct jp_current_motor {
    struct jp_current_estimate estimate;
    struct jp_current_moments moments;
    struct jp_current_statement offset;
    struct jp_current_statement gain;
    jp_q16 last_expected;
    jp_q16 last_measured;
    uint16_t samples; /* at most the memory */
    int64_t noise;    /* Q32, A²: variance of what differs from sample to sample */
    int32_t parted;   /* Q24, A: short-term mean of measured − estimated */
    bool changed;
    bool bent; /* the samples do not lie on one line */
};

/** Private but for `estimate` of both motors. */
struct jp_current_check {
    const struct jp_current_check_config *config;
    const struct jp_monitor_config *motors;
    struct jp_current_motor left;
    struct jp_current_motor right;
    enum jp_current_blame blame;
    uint16_t blame_samples;
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. */
enum jp_status jp_current_check_check(const struct jp_current_check_config *config, const char **field);

/** Starts with nothing known. Both configurations must have passed their checks; their pointers are kept. Of `motors`
 * only Rm, kb and W/(2R) are used. Constant time. */
void jp_current_check_start(struct jp_current_check *check, const struct jp_current_check_config *config,
                            const struct jp_monitor_config *motors);

/**
 * Takes a sample, such as jp_robot_motors() gives. Returns jp_current_finding bits; 0: nothing is found against the
 * sensors. A finding begins or ends only after memory/4 samples that support it, and never while the samples say
 * nothing. Eight 64-bit divisions and six square roots, at most 4 600 instructions on a Cortex-M4 and 17 000 on a
 * Cortex-M0. Not for ISRs.
 */
uint8_t jp_current_check_update(struct jp_current_check *check, const struct jp_motor_sample *sample);

#ifdef __cplusplus
}
#endif

#endif
