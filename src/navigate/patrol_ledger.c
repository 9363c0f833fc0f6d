#include <joulepath/patrol_ledger.h>

#include <joulepath/count.h>

#include "src/base/plane.h"

static float joules(jp_energy energy)
{
    return jp_plane_of_q32(energy);
}

/** In J, of a sum in the model's unit. */
static float modelled_joules(const struct jp_patrol_ledger *ledger, int64_t energy)
{
    return joules(jp_energy_from_q16(jp_saturate32(energy), ledger->learner.built_in->unit_exponent));
}

void jp_patrol_ledger_start(struct jp_patrol_ledger *ledger, const struct jp_factor_learning *learning,
                            const struct jp_four_wheel_energy_model *built_in)
{
    *ledger = (struct jp_patrol_ledger){.robot = 1.0f};
    jp_four_wheel_learner_start(&ledger->learner, learning, built_in);
}

/** Without what is in the way. */
static enum jp_status plan_alone(const struct jp_patrol_ledger *ledger, const struct jp_patrol_config *config,
                                 const struct jp_patrol_plan *plan, struct jp_four_wheel_drive *planned,
                                 float *duration)
{
    *planned = (struct jp_four_wheel_drive){.energy = 0};
    *duration = 0.0f;
    return jp_patrol_plan_energy(config, &ledger->learner.model, plan, planned, duration);
}

static struct jp_patrol_leg_forecast among_others(const struct jp_patrol_ledger *ledger,
                                                  const struct jp_four_wheel_drive *planned, float duration)
{
    const float energy = modelled_joules(ledger, planned->energy) * jp_patrol_pace_factor(&ledger->pace, 1.0f);

    return (struct jp_patrol_leg_forecast){
        .energy = energy, .deviation = energy * jp_patrol_pace_deviation(&ledger->pace), .duration = duration};
}

enum jp_status jp_patrol_ledger_foretell(const struct jp_patrol_ledger *ledger, const struct jp_patrol_config *config,
                                         const struct jp_patrol_plan *plan, struct jp_patrol_leg_forecast *forecast)
{
    struct jp_four_wheel_drive planned;
    float duration;
    enum jp_status status;

    if (ledger == NULL || forecast == NULL) {
        return JP_ERR_ARGUMENT;
    }
    status = plan_alone(ledger, config, plan, &planned, &duration);
    if (status == JP_OK) {
        *forecast = among_others(ledger, &planned, duration);
    }
    return status;
}

enum jp_status jp_patrol_ledger_begin(struct jp_patrol_ledger *ledger, const struct jp_patrol_config *config,
                                      const struct jp_patrol_plan *plan)
{
    float duration;
    enum jp_status status;

    if (ledger == NULL) {
        return JP_ERR_ARGUMENT;
    }
    jp_patrol_ledger_forget(ledger);
    status = plan_alone(ledger, config, plan, &ledger->internal.planned, &duration);
    if (status == JP_OK) {
        ledger->forecast = among_others(ledger, &ledger->internal.planned, duration);
        ledger->internal.driven = (struct jp_four_wheel_drive){.energy = 0};
        ledger->internal.taken = 0;
        ledger->internal.is_under_way = true;
        ledger->begun++;
    }
    return status;
}

void jp_patrol_ledger_add(struct jp_patrol_ledger *ledger, const struct jp_four_wheel_stretch *stretch)
{
    if (ledger->internal.is_under_way && ledger->internal.has_shown) {
        ledger->internal.taken += stretch->energy - ledger->internal.shown;
        (void)jp_four_wheel_energy_add(&ledger->learner.model, &ledger->internal.driven, &stretch->piece);
    }
    ledger->internal.shown = stretch->energy;
    ledger->internal.has_shown = true;
}

static void learn(struct jp_patrol_ledger *ledger)
{
    const int32_t exponent = ledger->learner.built_in->unit_exponent;
    const float modelled = modelled_joules(ledger, ledger->internal.planned.energy);
    jp_q16 before[JP_FOUR_WHEEL_FACTORS];
    jp_q16 after[JP_FOUR_WHEEL_FACTORS];

    jp_four_wheel_learner_factors(&ledger->learner, before);
    if (jp_four_wheel_learner_update(&ledger->learner, &ledger->internal.driven,
                                     jp_energy_to_q16(ledger->internal.taken, exponent),
                                     &ledger->result.learned) == JP_OK) {
        ledger->learned_from = jp_one_more32(ledger->learned_from);
    } else {
        ledger->left_out = jp_one_more32(ledger->left_out);
    }
    jp_four_wheel_learner_factors(&ledger->learner, after);
    const float ratio = jp_patrol_plan_ratio(&ledger->internal.planned, before, after);

    ledger->robot *= ratio;
    jp_patrol_pace_learn(&ledger->pace, 1.0f, modelled * ratio, joules(ledger->internal.taken));
}

void jp_patrol_ledger_end(struct jp_patrol_ledger *ledger)
{
    if (!ledger->internal.is_under_way) {
        return;
    }
    ledger->internal.is_under_way = false;
    ledger->result = (struct jp_patrol_leg_result){.forecast = ledger->forecast, .energy = ledger->internal.taken};
    ledger->ended++;
    if (ledger->internal.taken > 0 && ledger->internal.planned.energy > 0) {
        learn(ledger);
    } else {
        ledger->left_out = jp_one_more32(ledger->left_out);
    }
}

void jp_patrol_ledger_forget(struct jp_patrol_ledger *ledger)
{
    if (ledger->internal.is_under_way) {
        ledger->internal.is_under_way = false;
        ledger->left_out = jp_one_more32(ledger->left_out);
    }
}
