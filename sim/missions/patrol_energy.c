#include "sim/missions/patrol_energy.h"

#include <math.h>

#include "sim/base/digital.h"
#include "sim/four_wheel/four_wheel_file.h"
#include "sim/four_wheel/patrol_robots.h"

#define PIECE_TICKS 20

/* The sensor of the current, A. */
#define CURRENT_STEP 0.005

void patrol_energy_init(struct patrol_energy *energy, const struct four_wheel_file *robot)
{
    const struct jp_four_wheel_trip_config trip = {four_wheel_config(robot), FOUR_WHEEL_RATE_HZ, PIECE_TICKS};
    const char *field;

    const struct patrol_robot_entry *entry = patrol_robot_built_in(robot->name);

    *energy = (struct patrol_energy){.built_in = NULL};
    if (entry != NULL) {
        energy->built_in = entry->energy;
        jp_four_wheel_learner_start(&energy->learner, entry->learning, entry->energy);
    }
    (void)jp_four_wheel_trip_init(&energy->trip, &trip, &field);
    (void)jp_bus_meter_start(&energy->meter, FOUR_WHEEL_RATE_HZ);
}

static double joules(const struct patrol_energy *energy, int64_t q16)
{
    return ldexp((double)q16, energy->built_in->unit_exponent - 16);
}

static double metered(const struct patrol_energy *energy)
{
    return ldexp((double)energy->meter.energy, -32);
}

static struct jp_four_wheel_drive planned_on(const struct jp_four_wheel_energy_model *model,
                                             const struct jp_patrol_config *config, const struct jp_patrol_plan *plan)
{
    struct jp_four_wheel_drive drive = {0};
    float duration = 0;

    (void)jp_patrol_plan_energy(config, model, plan, &drive, &duration);
    return drive;
}

void patrol_energy_begin(struct patrol_energy *energy, size_t index, const struct jp_patrol_config *config,
                         const struct jp_patrol_plan *plan, double time)
{
    if (energy->built_in == NULL) {
        return;
    }
    const float all = jp_patrol_pace_factor(&energy->pace, 1);
    const struct jp_patrol_pace *const pace = &energy->paces[index];
    const double share = (double)jp_patrol_pace_deviation(pace->legs > 1 ? pace : &energy->pace);

    energy->planned = planned_on(&energy->learner.model, config, plan);
    energy->leg = (struct patrol_leg){.planned = joules(energy, planned_on(energy->built_in, config, plan).energy)};
    energy->leg.forecast = joules(energy, energy->planned.energy) * (double)jp_patrol_pace_factor(pace, all);
    energy->leg.deviation = share * energy->leg.forecast;
    energy->driven = (struct jp_four_wheel_drive){0};
    energy->at_start = metered(energy);
    energy->time_start = time;
}

void patrol_energy_tick(struct patrol_energy *energy, const struct four_wheel_plant *plant)
{
    const double volts = plant->bus_voltage;
    const double amperes = (plant->ledger.battery - energy->last_battery) * FOUR_WHEEL_RATE_HZ / volts;
    struct jp_four_wheel_piece piece;

    energy->last_battery = plant->ledger.battery;
    jp_bus_meter_update(&energy->meter, digital_fixed(volts, JP_Q16_ONE),
                        digital_fixed(rint(amperes / CURRENT_STEP) * CURRENT_STEP, JP_Q16_ONE));
    if (jp_four_wheel_trip_tick(&energy->trip, &plant->measured, 0, 0, &piece) && energy->built_in != NULL) {
        (void)jp_four_wheel_energy_add(&energy->learner.model, &energy->driven, &piece);
    }
}

void patrol_energy_end(struct patrol_energy *energy, double time)
{
    struct jp_four_wheel_piece piece;

    energy->leg.driven = metered(energy) - energy->at_start;
    energy->leg.seconds = time - energy->time_start;
    if (jp_four_wheel_trip_end(&energy->trip, &piece) && energy->built_in != NULL) {
        (void)jp_four_wheel_energy_add(&energy->learner.model, &energy->driven, &piece);
    }
}

void patrol_energy_learn(struct patrol_energy *energy, size_t index)
{
    if (energy->built_in == NULL) {
        return;
    }
    struct jp_patrol_pace *const pace = &energy->paces[index];
    const float all = jp_patrol_pace_factor(&energy->pace, 1);
    const jp_energy taken = (jp_energy)ldexp(energy->leg.driven, 32);
    jp_q16 before[JP_FOUR_WHEEL_FACTORS];
    jp_q16 after[JP_FOUR_WHEEL_FACTORS];
    enum jp_learned learned;

    jp_four_wheel_learner_factors(&energy->learner, before);
    (void)jp_four_wheel_learner_update(&energy->learner, &energy->driven,
                                       jp_energy_to_q16(taken, energy->built_in->unit_exponent), &learned);
    jp_four_wheel_learner_factors(&energy->learner, after);
    const float planned =
        (float)joules(energy, energy->planned.energy) * jp_patrol_plan_ratio(&energy->planned, before, after);

    jp_patrol_pace_learn(pace, all, planned, (float)energy->leg.driven);
    jp_patrol_pace_learn(&energy->pace, 1, planned, (float)energy->leg.driven);
}
