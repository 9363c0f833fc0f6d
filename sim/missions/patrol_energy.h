/** What the patrol robot says that a leg will take, what it meters, and what it learns from it. */
#ifndef JOULEPATH_SIM_MISSIONS_PATROL_ENERGY_H
#define JOULEPATH_SIM_MISSIONS_PATROL_ENERGY_H

#include <joulepath/bus_meter.h>
#include <joulepath/four_wheel_learner.h>
#include <joulepath/four_wheel_trip.h>
#include <joulepath/patrol_forecast.h>

#include "sim/four_wheel/four_wheel_plant.h"

/** Legs of a round that are told apart. */
#define PATROL_ROUND_MAX 15

/** A leg that was driven, J. */
struct patrol_leg {
    double planned;   /**< by the built-in model, alone on the path */
    double forecast;  /**< with what was learned */
    double deviation; /**< of the forecast */
    double driven;    /**< by the meter */
    double seconds;
};

struct patrol_energy {
    const struct jp_four_wheel_energy_model *built_in; /**< null: this robot's is not identified */
    struct jp_four_wheel_learner learner;
    struct jp_patrol_pace pace;                        /**< of all legs */
    struct jp_patrol_pace paces[1 + PATROL_ROUND_MAX]; /**< of each leg of the round */
    struct jp_four_wheel_trip trip;
    struct jp_bus_meter meter;
    struct jp_four_wheel_drive driven;  /**< of the present leg */
    struct jp_four_wheel_drive planned; /**< by the model as learned */
    double at_start;                    /**< of the meter */
    double last_battery;                /**< of the plant's ledger, J */
    double time_start;
    struct patrol_leg leg;
};

void patrol_energy_init(struct patrol_energy *energy, const struct four_wheel_file *robot);

/** A leg begins, number `index` of its round. */
void patrol_energy_begin(struct patrol_energy *energy, size_t index, const struct jp_patrol_config *config,
                         const struct jp_patrol_plan *plan, double time);

/** A tick of the plant. */
void patrol_energy_tick(struct patrol_energy *energy, const struct four_wheel_plant *plant);

/** The leg has come to its end: what it took. */
void patrol_energy_end(struct patrol_energy *energy, double time);

/** The robot learns from the leg that has come to its end. */
void patrol_energy_learn(struct patrol_energy *energy, size_t index);

#endif
