/** A robot as the navigator drives it (vehicle.h), which does and tells anything. */
#ifndef JOULEPATH_TESTS_PROOF_ANY_VEHICLE_H
#define JOULEPATH_TESTS_PROOF_ANY_VEHICLE_H

#include <joulepath/vehicle.h>

#include "tests/proof/any.h"

static enum jp_status vehicle_does(void)
{
    return any_bool() ? JP_OK : any_bool() ? JP_ERR_STATE : JP_ERR_INFEASIBLE;
}

static void vehicle_is_looked_at(void *context, struct jp_vehicle_view *view)
{
    (void)context;
    ANY(*view);
    view->phase = (enum jp_vehicle_phase)any_between(JP_VEHICLE_OFF, JP_VEHICLE_MOVING);
}

static enum jp_status vehicle_works(void *context)
{
    (void)context;
    return vehicle_does();
}

static enum jp_status vehicle_turns(void *context, jp_angle heading, const struct jp_ground *ground)
{
    (void)context;
    (void)heading;
    (void)ground;
    return vehicle_does();
}

static enum jp_status vehicle_follows(void *context, const struct jp_vehicle_run *run)
{
    (void)context;
    (void)run;
    return vehicle_does();
}

static void vehicle_stops(void *context)
{
    (void)context;
}

static enum jp_status vehicle_is_surveyed(void *context, const struct jp_vehicle_run *run, bool anew)
{
    (void)context;
    (void)run;
    (void)anew;
    return vehicle_does();
}

static enum jp_status vehicle_tells_leg(void *context, struct jp_leg_extent *extent)
{
    (void)context;
    ANY(*extent);
    return vehicle_does();
}

static void vehicle_forecasts(void *context, jp_q16 *duration, struct jp_forecast *energy)
{
    (void)context;
    *duration = any_int();
    ANY(*energy);
}

static const struct jp_vehicle any_vehicle = {.look = vehicle_is_looked_at,
                                              .work = vehicle_works,
                                              .turn = vehicle_turns,
                                              .follow = vehicle_follows,
                                              .stop = vehicle_stops,
                                              .survey = vehicle_is_surveyed,
                                              .survey_leg = vehicle_tells_leg,
                                              .forecast = vehicle_forecasts};

#endif
