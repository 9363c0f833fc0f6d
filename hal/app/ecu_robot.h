/**
 * What the application of a controller asks of a robot, whatever its kind: ecu_balancer.h, ecu_skid.h and ecu_patrol.h
 * have some. An image holds the code of the kinds that it prepares.
 */
#ifndef JOULEPATH_HAL_APP_ECU_ROBOT_H
#define JOULEPATH_HAL_APP_ECU_ROBOT_H

#include <joulepath/e2e.h>
#include <joulepath/evidence.h>
#include <joulepath/learner.h>
#include <joulepath/meter.h>
#include <joulepath/monitor.h>
#include <joulepath/point.h>

#include "hal/app/retained.h"
#include "hal/can/can.h"
#include "hal/hal.h"
#include "hal/storage/parameters.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Values of State in EcuStatus. The motors run in standing and driving. */
enum jp_ecu_state { JP_ECU_IDLE, JP_ECU_STANDING, JP_ECU_DRIVING, JP_ECU_FALLEN, JP_ECU_FAULT };

/** Why the motors stay off although Stand was commanded: values of StandRefusal in joulepath.dbc. */
enum jp_refusal {
    JP_REFUSAL_NONE,
    JP_REFUSAL_NOT_UPRIGHT, /**< leans beyond the tilt limit, or no plausible sample came yet */
    JP_REFUSAL_FALLEN,      /**< Off first */
    JP_REFUSAL_FAULT,       /**< Off first */
    JP_REFUSAL_CONFLICT,    /**< another controller is on the bus */
    JP_REFUSAL_STEEP        /**< the ground is too steep, or no plausible sample came yet */
};

/** Pose, Motion, Reference and Motors. */
struct jp_ecu_motion {
    struct jp_point position;
    jp_phase heading;
    jp_q24 speed;              /**< m/s */
    jp_turns_per_s turn_rate;  /**< turn/s */
    jp_q24 pitch;              /**< of the body, turn; forward is positive */
    jp_turns_per_s pitch_rate; /**< turn/s */
    jp_q24 reference_speed;    /**< m/s */
    jp_turns_per_s reference_turn_rate;
    jp_phase reference_heading;
    uint32_t segment_ticks_left;
    struct jp_voltages voltages;
    uint32_t saturated_ticks;
};

/** How far it is. */
struct jp_ecu_progress {
    uint16_t faults;         /**< enum jp_fault bits */
    uint16_t segment;        /**< segments begun since the robot last stood */
    uint16_t segments_ended; /**< since then */
    enum jp_status plan;     /**< of the last route */
};

/** A segment as planned. */
struct jp_ecu_segment {
    uint16_t number;    /**< since the robot last stood */
    jp_q24 speed;       /**< m/s */
    jp_q24 turn;        /**< from its begin to its end, rad */
    jp_q16 duration;    /**< s */
    jp_energy forecast; /**< as EnergySpent counts */
};

/** What a segment took. */
struct jp_ecu_result {
    uint16_t segment; /**< its number since the robot last stood */
    jp_energy spent;
    jp_energy drawn;
};

/** A result on its way from the background, which puts it there, to the tick, which takes it. All zero at first. */
struct jp_ecu_result_box {
    struct jp_ecu_result result;
    bool is_full;
};

/** Whether the tick has yet to take the last one; then none may be put. */
static inline bool jp_ecu_result_waits(const struct jp_ecu_result_box *box)
{
    return __atomic_load_n(&box->is_full, __ATOMIC_ACQUIRE);
}

static inline void jp_ecu_result_put(struct jp_ecu_result_box *box, const struct jp_ecu_result *result)
{
    box->result = *result;
    __atomic_store_n(&box->is_full, true, __ATOMIC_RELEASE);
}

/** False: there is none. */
static inline bool jp_ecu_result_take(struct jp_ecu_result_box *box, struct jp_ecu_result *result)
{
    if (!jp_ecu_result_waits(box)) {
        return false;
    }
    *result = box->result;
    __atomic_store_n(&box->is_full, false, __ATOMIC_RELEASE);
    return true;
}

/** What was learned, but for what kinds have each of their own. */
struct jp_ecu_lessons {
    uint32_t version;
    uint32_t learned_from; /**< segments since the start */
    uint32_t left_out;     /**< segments */
    uint32_t changes;
    uint32_t outliers;
    enum jp_cause cause;
    enum jp_evidence evidence;
    enum jp_stored stored;
};

/** What feeds the robot, as it measures it. */
struct jp_ecu_supply {
    jp_energy drawn; /**< out of the battery since init */
    jp_q16 voltage;  /**< of the bus, V */
    jp_q16 cruise;   /**< power at the highest speed that it plans, as its model has it, W */
};

/** The bus, for a kind whose sensors and drives are not those of struct jp_hal. */
struct jp_ecu_bus {
    void *context;
    /** Hands set-points to the drives, which hold them for a while: JP_ERR_HARDWARE: they have got none for too long.
     */
    enum jp_status (*command)(void *context, const struct jp_can_frame *frames, unsigned count);
};

/** Frames of a kind's own that tell of its state, each JP_ECU_OWN_MS. */
#define JP_ECU_OWN_FRAMES 2U
#define JP_ECU_OWN_MS     100U

/** Frames of a kind's own that tell what was learned, at most. */
#define JP_ECU_LEARNED_FRAMES 2U

/** `self` of the robot is handed to each function. */
struct jp_ecu_kind {
    enum jp_retained_kind snapshots;
    uint8_t parameters; /**< of its energy model */

    /** Before the first tick: goes on from a snapshot. False: the motors did not run, or it cannot be this robot's. The
     *  counts are those of its encoders. */
    bool (*resume)(void *self, const union jp_retained_snapshot *snapshot, uint32_t *encoder_left,
                   uint32_t *encoder_right);

    /* Of a kind whose sensors and drives are not those of struct jp_hal; else null. */

    /** At the start. */
    void (*attach)(void *self, const struct jp_ecu_bus *bus);
    /** Takes a frame of its sensors, in the receive interrupt; *is_sample: a sample is complete. */
    enum jp_e2e_result (*accept)(void *self, const struct jp_can_frame *frame, bool *is_sample);
    /** There has been a sample. */
    bool (*has_started)(const void *self);
    /** Ticks without a sample since then, saturating. */
    uint16_t (*lost_samples)(const void *self);
    /** Of JP_ECU_OWN_FRAMES; false: there is nothing to tell. In the tick. */
    bool (*tell_own)(const void *self, uint8_t index, struct jp_can_frame *frame);

    /* Of the tick. Constant time. */

    void (*tick)(void *self, const struct jp_hal *hal, enum jp_status *written);
    /** The last plausible one, or NULL. */
    const struct jp_sensors *(*good_frame)(const void *self);
    void (*snapshot)(const void *self, union jp_retained_snapshot *snapshot);
    void (*motion)(const void *self, struct jp_ecu_motion *motion);
    void (*progress)(const void *self, struct jp_ecu_progress *progress);
    /** Since init: as its energy model counts, and out of the battery. */
    void (*energies)(const void *self, jp_energy *spent, jp_energy *drawn);
    /** True once for each segment that ended. */
    bool (*take_result)(void *self, struct jp_ecu_result *result);
    /** Of the energy model that it plans with; in the unit of that, which the robot's built-in tables tell: so no digit
     *  is lost. */
    int32_t (*parameter)(const void *self, uint8_t index);

    /* Of the background. */

    enum jp_ecu_state (*state)(const void *self);
    /** Motors on at the next tick, or why not; it is idle. */
    enum jp_refusal (*enable)(void *self);
    void (*disable)(void *self);
    /** A route begins, or the way to a goal on a map: it plans with what it knows from now on. */
    void (*set_out)(void *self, bool to_goal);
    enum jp_status (*follow)(void *self, const struct jp_point *targets, uint16_t count);
    /** Forgets the route and brakes to a stand. */
    void (*stop)(void *self);
    /** A slice of the work of driving routes. */
    void (*work)(void *self);
    /** After each slice of work, whoever did it: what the tick is to tell of. */
    void (*note)(void *self);
    /** No route is left to drive. */
    bool (*is_resting)(const void *self);
    /** Segments begun since the robot last stood; 0: it stands. */
    uint16_t (*segments_begun)(const void *self);
    /** Segments planned of the route that it drives, and the last of them; so many had begun before that was planned.
     */
    uint16_t (*segments_planned)(const void *self);
    void (*segment)(const void *self, uint16_t begun, struct jp_ecu_segment *segment);
    /** What it has learned, to be stored; NULL: it does not learn. */
    const struct jp_learned_state *(*learned_state)(const void *self);
    void (*lessons)(const void *self, struct jp_ecu_lessons *lessons);
    /** False: no plausible sample came. NULL: it does not tell. */
    bool (*supply)(const void *self, struct jp_ecu_supply *supply);
    /** What it plans from now on gets by with so many volts less than it was designed for. Null where the one above is.
     */
    void (*lack)(void *self, jp_q16 lacking);
    /** The frames of its kind; returns their number. */
    uint8_t (*tell_learned)(const void *self, struct jp_can_frame frames[JP_ECU_LEARNED_FRAMES]);
};

/** A robot that is prepared. */
struct jp_ecu_robot {
    const struct jp_ecu_kind *kind;
    void *self;
    uint32_t tick_rate;
    const struct jp_monitor_config *monitor; /**< NULL with sensors of its own */
};

#ifdef __cplusplus
}
#endif

#endif
