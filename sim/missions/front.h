/**
 * The front of a route: how much energy each time to drive it takes. The library foretells it over the cruise, and
 * chosen points of it are driven in closed loop by the strategy of cruise and transients.
 */
#ifndef JOULEPATH_SIM_MISSIONS_FRONT_H
#define JOULEPATH_SIM_MISSIONS_FRONT_H

#include <jansson.h>

#include "sim/missions/scenario.h"

/** Cruises from half the speed of least energy a metre up to the robot's limit. */
#define FRONT_FORECASTS 61

/** Least energy, shares of its time, and the two requests. */
#define FRONT_DRIVES_MAX 16

enum front_request { FRONT_LEAST_ENERGY, FRONT_SHARE, FRONT_WITHIN_SECONDS, FRONT_WITHIN_JOULES };

struct front_forecast {
    double cruise; /**< m/s */
    double seconds;
    double joules;
};

struct front_drive {
    enum front_request request;
    double limit; /**< s or J; 0: none */
    struct front_forecast forecast;
    double seconds;   /**< as driven */
    double joules;    /**< of the plant's ledger */
    double end_speed; /**< m/s */
    double miss;      /**< m, how far from the worst waypoint it passed */
};

struct front {
    size_t forecast_count;
    struct front_forecast forecasts[FRONT_FORECASTS]; /**< by their cruise; those that can be planned */
    size_t drive_count;
    struct front_drive drives[FRONT_DRIVES_MAX];
};

/** Plans and drives. The requests are the scenario's; for one that it lacks 0.8 of the time of least energy, or 1.1 of
 *  that energy. False after one line on stderr. */
bool front_make(struct front *front, const struct scenario *scenario);

/** What was asked for, for people and as the key of the results. */
const char *front_request_name(enum front_request request);

/** Prints the drives. */
void front_print(const struct front *front);

/** What tools/measure/time_front.py reads. */
json_t *front_json(const struct scenario *scenario, const struct front *front);

#endif
