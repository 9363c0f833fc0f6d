/**
 * Home in time: how probably what is left in the battery brings a robot home along the way that would be planned over
 * the map, and a navigator that turns back before it does not.
 *
 *   jp_home_work()  from the background loop in place of jp_navigator_work(), of which it is a slice and more
 *
 *             go               way home known           arrived                home
 *   idle ─────────▶ preparing ────────────────▶ out ─────────────▶ at goal ─────────────▶ returning ─▶ home
 *                                                └── less probable than `confidence`, no way ─▲
 *
 * A field of the costs from every pose home (pose_field.h) grows in slices from home. Along it a course is laid from
 * where the robot is, and surveyed as the navigator surveys what it drives: so the forecast of the way home is one of
 * the robot's own learner, over the ground that it leads over, turns included. It is made anew all the time; in between
 * it is as much less or more as the field says. Then
 *
 *   P(home) = P(left − way >= 0),    left from the battery, way from the learner, each with its deviation
 *
 * by jp_forecast_suffices(). Of each drive that arrives home learns by which factor it took more than the forecast of
 * its first course: planning, waits at stands, ways round what the map did not show; and how far drives differ in that.
 * Drives out lead over ground that the robot has not seen, those home along what it drove: each kind has a factor of
 * its own (jp_home_learned). The way home is so much dearer, and so much less sure. What disturbs a drive adds up along
 * it, one thing independent of the other, so that the variance grows with the way, and its share of the way falls. Most
 * drives take about as much as the mean and a few far more, round what is in the way: the deviation is that above the
 * mean, and a trip that has not begun is taken to meet the same on its way out and home. The robot goes on as long as
 * that is at least `confidence` where it is, however far the goal may be, so that what it learns on its way counts. At
 * home it needs nothing, and after its first metre it must turn round: it leaves only if what is left also suffices
 * for ten steps and home again from there, where it looks away from home: towards its goal, or in the direction that is
 * nearest to that and has a way. A change of the map that blocks the way home makes the field grow anew; until it has,
 * the way home is the last one and what was spent since.
 *
 * Integers only: the same bits on every core. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_HOME_H
#define JOULEPATH_HOME_H

#include <joulepath/navigator.h>
#include <joulepath/pose_field.h>

#ifdef __cplusplus
extern "C" {
#endif

struct jp_home_config {
    struct jp_navigator *navigator; /**< prepared; nobody else hands it goals or calls its jp_navigator_work() */
    int16_t x;                      /**< home, cells of its map, where the robot can stand */
    int16_t y;
    jp_q31 confidence; /**< the robot turns back below it; ½…0.9999, or 0: never */
    /** What is left in the battery, J in the unit of the vehicle's model, with its deviation, as
     * jp_battery_forecast_left() tells. False: it is not known.
     */
    bool (*left)(void *context, struct jp_forecast *left);
    /** What the battery has given at its terminals since any moment, J in the same unit, wrapping: jp_meter.battery.
     * What a drive took is told by it, as what is left changes with what becomes known of the battery, too. */
    jp_q16 (*given)(void *context);
    void *context;              /**< handed to both */
    struct jp_course_leg *legs; /**< the caller's memory for the way home */
    uint16_t legs_max;          /**< at least 1 */
    uint16_t slice;             /**< poses of the field of one call; at least 1 */
    void *block;                /**< jp_home_size() bytes aligned to 8 */
    size_t size;                /**< of it */
};

enum jp_home_state {
    JP_HOME_IDLE,      /**< no goal */
    JP_HOME_PREPARING, /**< looks for the way home before it leaves */
    JP_HOME_OUT,       /**< on the way to the goal */
    JP_HOME_AT_GOAL,   /**< has arrived there */
    JP_HOME_RETURNING, /**< on the way home */
    JP_HOME_HOME,      /**< has arrived there */
    JP_HOME_FAILED     /**< the goal is blocked, the motors are off, or no way leads home: see the status */
};

/** At this moment. */
struct jp_home_answer {
    struct jp_forecast left; /**< in the battery, */
    struct jp_forecast way;  /**< and what the way home takes: J in the unit of the vehicle's model */
    jp_q31 probability;      /**< that it suffices, 0.0001…0.9999 */
};

/** Drives of one question at most. */
#define JP_HOME_DRIVES_MAX 16U

/** What drives of a kind take against their forecasts, beginning and end of a drive included, which are as ten steps.
 */
struct jp_home_factor {
    jp_q16 mean;      /**< ½…2 */
    jp_q16 deviation; /**< of what is known of the mean; above 0, up to 0.1 */
    jp_q16 noise; /**< deviation above the mean of a drive that takes as much as ten steps; of one that takes n² times
                     as much it is an n-th of that; 1/64…2 */
};

/** Worth storing. */
struct jp_home_learned {
    struct jp_home_factor out;  /**< of drives to goals */
    struct jp_home_factor back; /**< of drives home */
};

/** Private: from its begin to the goal, or home. */
struct jp_home_drive {
    struct jp_forecast forecast; /**< of its first course */
    jp_q16 given;                /**< by the battery before it began */
    bool has_forecast;
};

/** Private. */
enum jp_home_phase { JP_HOME_GROWS, JP_HOME_JOINS, JP_HOME_SURVEYS };

/** Private: where a way home begins. The robot is ten steps out, or at its goal, before it leaves. */
enum jp_home_start { JP_HOME_FROM_ROBOT, JP_HOME_FROM_GOAL, JP_HOME_FROM_OUTSIDE };

/** Private: a way home that was surveyed. */
struct jp_home_way {
    struct jp_forecast energy;
    jp_cost cost; /**< by the field */
    jp_q16 given; /**< by the battery then */
    bool is_known;
};

/** Private. */
struct jp_home_internal {
    struct jp_pose_field field;
    struct jp_navigator survey; /**< that drives nothing: the course home and what it takes */
    enum jp_home_phase phase;
    struct jp_home_way way;   /**< the last one from where the robot was */
    struct jp_home_way price; /**< the last one that was long enough to tell what others take */
    jp_cost cost;             /**< from where the course that is surveyed begins, */
    jp_angle heading;         /**< and the robot's heading there */
    struct jp_home_drive drive;
    struct jp_goal goal;
    enum jp_home_start start;   /**< of the course that is surveyed */
    struct jp_forecast outside; /**< the way home from ten steps out; nothing where none is known */
    bool is_goal_known;         /**< what the way home from the goal takes, or that none is known */
    bool is_outside_known;      /**< the same from ten steps out */
    uint8_t outside_tries;      /**< directions that were tried from where the robot is */
    bool is_stuck;              /**< no course leads along the field from where the robot is */
};

/** The members but `internal` may be read. */
struct jp_home {
    struct jp_home_config config;
    enum jp_home_state state;
    /** Why it has failed. JP_ERR_STATE: the motors are off. JP_ERR_NO_PLAN: from where it is no way leads home. JP_OK:
     * see the navigator. Others: why the goal, or home, is refused, as jp_navigator_go(). */
    enum jp_status status;
    bool has_turned_back;           /**< since it was told where to go, maybe before it left */
    uint32_t ways;                  /**< home that were surveyed, saturating */
    struct jp_home_learned learned; /**< the caller may write what was stored after jp_home_init() */
    struct jp_home_internal internal;
};

/** Bytes of `block` for a map; 0 when its configuration is out of range. Constant time. */
size_t jp_home_size(const struct jp_terrain_config *config);

/** Prepares a home for a navigator that stands, and begins to look for the way there. JP_ERR_CONFIG: *field names the
 *  first member that is null or out of range. JP_ERR_ARGUMENT: a pointer is null. Failures of the block as
 *  jp_pose_field_init(). JP_ERR_OUTSIDE: home is off the map. JP_ERR_BLOCKED: the robot cannot be there. Work:
 * that of jp_pose_field_start(). */
enum jp_status jp_home_init(struct jp_home *home, const struct jp_home_config *config, const char **field);

/** Takes other costs for the field, as a tariff makes them of the same lattice; the field grows anew. */
void jp_home_set_lattice(struct jp_home *home, const struct jp_lattice *lattice);

/** Goes to a goal once the way home is known. JP_ERR_STATE: the motors are off. JP_ERR_ARGUMENT: a pointer is null.
 * Other failures as jp_navigator_go() come later: JP_HOME_FAILED. */
enum jp_status jp_home_go(struct jp_home *home, const struct jp_goal *goal);

/** Brakes to a stand and forgets the goal. */
void jp_home_stop(struct jp_home *home);

/** Goes home, from wherever it is. Failures as jp_navigator_go(). */
enum jp_status jp_home_return(struct jp_home *home);

/** A slice of background work: jp_navigator_work(), and of the way home some poses of the field, a line of the course
 *  or a leg of the survey. */
enum jp_home_state jp_home_work(struct jp_home *home);

/** Whether what is left brings the robot home from where it is. JP_ERR_NO_PLAN: no way home is known yet.
 *  JP_ERR_EMPTY: the battery does not say what is left. JP_ERR_ARGUMENT: a pointer is null. Work: that of
 *  jp_forecast_suffices(). */
enum jp_status jp_home_ask(const struct jp_home *home, struct jp_home_answer *answer);

/** From where the robot is no way leads home, as far as is known. */
bool jp_home_is_cut_off(const struct jp_home *home);

/** What a way of this cost takes, of those of the same lattice: as the last one that was surveyed, which before the
 * robot leaves is the one home from its goal, with what home has learned of drives, half of which lead out; a single
 * one leads home. JP_ERR_ARGUMENT: a pointer is null, or there are more than JP_HOME_DRIVES_MAX drives or none.
 * JP_ERR_NO_PLAN: none was surveyed yet. Work: seven divisions and five square roots. */
enum jp_status jp_home_expect(const struct jp_home *home, jp_cost cost, unsigned drives, struct jp_forecast *way);

/** The largest cost of a way for which what is left suffices at a confidence, ½…0.9999; 0: none does. Failures as
 *  jp_home_expect(); JP_ERR_ARGUMENT also: the confidence is out of range. Work: 24 times that of jp_home_expect() and
 *  jp_forecast_suffices(). */
enum jp_status jp_home_farthest(const struct jp_home *home, const struct jp_forecast *left, jp_q31 confidence,
                                unsigned drives, jp_cost *cost);

/** A new robot's. */
extern const struct jp_home_learned jp_home_learned_new;

/** Learns from a drive that took so much, J above 0, where so much was forecast, and ten steps take so much. A forecast
 *  that was not sure teaches little. JP_ERR_ARGUMENT: a pointer is null, an energy not above 0, or a deviation
 *  negative. Work: seven divisions and two square roots. */
enum jp_status jp_home_factor_learn(struct jp_home_factor *factor, jp_q16 taken, const struct jp_forecast *forecast,
                                    jp_q16 steps);

/** What a drive takes by that factor. Work: two square roots. */
struct jp_forecast jp_home_factor_way(const struct jp_home_factor *factor, const struct jp_forecast *forecast,
                                      jp_q16 steps);

#ifdef __cplusplus
}
#endif

#endif
