/**
 * Hours of patrol: goes round between places, stays at each for a while, and is back at its charger while the energy in
 * its battery lasts.
 *
 *            surveyed            energy suffices          arrived
 *   SURVEYING ─────▶ CHARGING ─────────────────▶ LEAVING ─────────▶ DWELLING
 *       ▲               ▲                          │  ▲                │
 *       └── set out ────┤                          │  └─── suffices ───┤
 *                       └──── HOMING ◀─────────────┴──── does not ─────┘
 *                             │    ▲
 *                no way now   ▼    │ after a while
 *                             WAITING
 *
 * Before it leaves for a place p the robot takes what it foretells of the way there, of its stay, and of the way from p
 * to the charger, E ± σ, and goes home instead unless what the battery holds is at least
 *
 *   reserve + E + deviations σ + X
 *
 * where the deviations of the parts are added, as legs may err alike: 1.645 deviations are 95 %. X is for who stands in
 * the way, which is no matter of deviations: most journeys meet nobody, and one waits for a minute. It is the most that
 * one of the last JP_ROUND_JOURNEYS took beyond its forecast, whether it came to its end or not; the next one takes
 * more with 1/(JP_ROUND_JOURNEYS + 1), 5 %, whatever their distribution is. Before there have been so many it is a wait
 * of JP_ROUND_WAIT at least. So at each place the way home was foretold to be paid for. On its way the robot turns home
 * when what is left of the leg and the way home from its end would no longer be; a stay that the way took too much for
 * ends early. What each way takes is surveyed on the map before it sets out, and again at each charge, by then with
 * what was learned.
 *
 * People may stand in its way. A place that it does not get to is left out; when it gets nowhere any more it waits for
 * JP_ROUND_WAIT seconds, forgets what its scans have marked, and tries to get home, again and again.
 *
 * Single-precision floating point: part of libjoulepath_float. One context; not for ISRs.
 */
#ifndef JOULEPATH_PATROL_ROUND_H
#define JOULEPATH_PATROL_ROUND_H

#include <joulepath/patrol_pilot.h>

#ifdef __cplusplus
extern "C" {
#endif

#define JP_PATROL_STOPS_MAX 15U

/** Who stands in the way is waited for, s. */
#define JP_ROUND_WAIT 30.0f

/** Last journeys to a place or home of which is known what they took beyond their forecast. */
#define JP_ROUND_JOURNEYS 20U

struct jp_patrol_stop {
    struct jp_plane_pose pose;
    float dwell; /**< s; 0…86 400 */
};

struct jp_patrol_round_config {
    struct jp_patrol_stop stops[JP_PATROL_STOPS_MAX];
    uint16_t stop_count; /**< 1…JP_PATROL_STOPS_MAX */
    struct jp_plane_pose charger;
    float full;           /**< energy of the battery from which on it leaves the charger, J; above 0 */
    float reserve;        /**< that shall be left at the charger, J; 0 or more */
    float deviations;     /**< 1.645: 95 %; 0…10 */
    float standing_power; /**< of the robot that stays, W; 0 or more */
};

enum jp_patrol_round_state {
    JP_ROUND_SURVEYING, /**< at the charger */
    JP_ROUND_CHARGING,
    JP_ROUND_LEAVING,  /**< to a place */
    JP_ROUND_DWELLING, /**< there */
    JP_ROUND_HOMING,   /**< to the charger */
    JP_ROUND_WAITING,  /**< there is no way now, to the charger either: JP_ROUND_NO_WAY; or to set out for it first */
    JP_ROUND_FAILED    /**< see the reason */
};

enum jp_patrol_round_reason {
    JP_ROUND_NO_REASON,
    JP_ROUND_NO_WAY,    /**< between two of the places, or from where it is: `stop` says which it was to reach */
    JP_ROUND_NO_ENERGY, /**< a full battery does not suffice for `stop` and back */
    JP_ROUND_DRIVES_OFF /**< the drives were switched off under way */
};

/** The members but `internal` may be read. */
struct jp_patrol_round {
    enum jp_patrol_round_state state;
    enum jp_patrol_round_reason reason;
    uint16_t stop;    /**< that it goes to or stays at; stop_count: the charger */
    uint32_t visits;  /**< of places, saturating */
    uint32_t charges; /**< times that it came home, saturating */
    uint32_t skipped; /**< places that it gave up and went on to the next, saturating */
    float least_left; /**< least energy with which it came home, J */
    struct {
        struct jp_patrol_round_config config;
        struct jp_patrol_pilot *pilot;
        struct jp_patrol_leg_forecast out[JP_PATROL_STOPS_MAX];    /* from the charger */
        struct jp_patrol_leg_forecast onward[JP_PATROL_STOPS_MAX]; /* from the stop before */
        struct jp_patrol_leg_forecast home[JP_PATROL_STOPS_MAX];
        float pace;         /* factor when the last of them was surveyed */
        uint16_t surveyed;  /* ways */
        bool is_asked;      /* for the next one */
        bool is_at_charger; /* else at the stop before */
        float stayed;       /* at a place, or waiting, s */
        float set_out_with; /* energy in the battery when the journey began, J; tries to get home are one journey */
        float foretold;     /* of the journey by its first plan, J */
        bool is_foretold;
        float excesses[JP_ROUND_JOURNEYS]; /* of the last journeys beyond that, J; 0 or more */
        uint32_t journeys;                 /* saturating */
        uint16_t failures;                 /* places in a row that were given up */
    } internal;
};

/** JP_ERR_CONFIG: *field names the first field out of range. JP_ERR_ARGUMENT: a pointer is null. Work: the stops. */
enum jp_status jp_patrol_round_check(const struct jp_patrol_round_config *config, const char **field);

/** Prepares a round of a robot whose pilot has a map; where it is not at its charger, it goes there first, by state
 *  JP_ROUND_WAITING without a reason. Failures as jp_patrol_round_check(). The pilot must stay, and is used by nobody
 *  else meanwhile. */
enum jp_status jp_patrol_round_init(struct jp_patrol_round *round, const struct jp_patrol_round_config *config,
                                    struct jp_patrol_pilot *pilot, const char **field);

/** After each jp_patrol_pilot_work(), `seconds` after the last call: `available`, J, is what the battery holds now.
 *  Constant time but for jp_patrol_pilot_go() and _survey(). */
enum jp_patrol_round_state jp_patrol_round_work(struct jp_patrol_round *round, float available, float seconds);

#ifdef __cplusplus
}
#endif

#endif
