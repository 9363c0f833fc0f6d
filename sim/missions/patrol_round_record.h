/** What is kept of hours of patrol: journeys, what the battery held, and where the robot was. */
#ifndef JOULEPATH_SIM_MISSIONS_PATROL_ROUND_RECORD_H
#define JOULEPATH_SIM_MISSIONS_PATROL_ROUND_RECORD_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "hal/app/ecu_patrol_round.h"
#include "sim/bus/patrol_body.h"

/** Journeys that are kept; of more the first ones. */
#define PATROL_JOURNEYS_MAX 4096

enum patrol_journey_end {
    PATROL_JOURNEY_ARRIVED,
    PATROL_JOURNEY_TURNED_HOME, /**< what was left no longer paid for it and for the way home */
    PATROL_JOURNEY_LEFT_OUT,    /**< the place could not be got to */
    PATROL_JOURNEY_NO_WAY,      /**< home neither: it waits */
    PATROL_JOURNEY_CUT,         /**< the round ended */
    PATROL_JOURNEY_ENDS
};

extern const char *const patrol_journey_ends[PATROL_JOURNEY_ENDS];

/** From a place to another; as many as there are stops is the charger. */
struct patrol_journey {
    unsigned from;
    unsigned to;
    enum patrol_journey_end end;
    double begin_s;
    double time_s;
    double length_m;
    double foretold_j; /**< by its first plan; 0: there was none */
    double deviation_j;
    double taken_j; /**< out of the battery */
    double left_j;  /**< in the battery at its end */
};

/** What the robot says of its round. */
struct patrol_round_told {
    enum jp_round_told state;
    enum jp_round_reason reason;
    unsigned stop;
    unsigned visits;
    unsigned charges;
    unsigned skipped;
    double held_j;       /**< in its battery, as it counts */
    double least_left_j; /**< with which it came home; of no meaning before */
    double left_j;       /**< of the journey, by the forecast; 0: it has no plan */
    double deviation_j;
};

struct patrol_round_record {
    FILE *log;
    unsigned stops;
    struct patrol_journey journeys[PATROL_JOURNEYS_MAX];
    unsigned journey_count; /**< that ended, or are under way */
    struct patrol_round_told told;
    double time_s; /**< since the round began */
    double length_m;
    double energy_j;        /**< that left the battery */
    double account_error_j; /**< largest of what the robot counts, from what the battery holds */
    unsigned below_reserve;
    double energy_before_j; /* that had left it before */
    bool is_under_way;      /* on a journey */
    unsigned place;         /* where it was last */
    struct planar_pose pose;
    double next_line_s;
    double away_s; /* from the charger */
};

/** Writes the head of the log. */
void patrol_round_record_init(struct patrol_round_record *record, FILE *log, unsigned stops,
                              const struct patrol_body *body);

/** After a tick. `reserve_j` shall be left where it comes home. */
void patrol_round_record_tick(struct patrol_round_record *record, const struct patrol_round_told *told,
                              const struct patrol_body *body, double reserve_j);

/** The drive is over. */
void patrol_round_record_end(struct patrol_round_record *record, const struct patrol_body *body);

#endif
