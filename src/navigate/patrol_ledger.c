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
    *ledger = (struct jp_patrol_ledger){.begun = 0};
    jp_four_wheel_learner_start(&ledger->learner, learning, built_in);
}

/** Without what is in the way. */
static enum jp_status plan_alone(const struct jp_patrol_ledger *ledger, const struct jp_patrol_config *config,
                                 const struct jp_patrol_plan *plan, float *modelled, float *duration)
{
    struct jp_four_wheel_drive drive = {.energy = 0};
    enum jp_status status;

    *duration = 0.0f;
    status = jp_patrol_plan_energy(config, &ledger->learner.model, plan, &drive, duration);
    *modelled = modelled_joules(ledger, drive.energy);
    return status;
}

static struct jp_patrol_leg_forecast among_others(const struct jp_patrol_ledger *ledger, float modelled, float duration)
{
    const float energy = modelled * jp_patrol_pace_factor(&ledger->pace, 1.0f);

    return (struct jp_patrol_leg_forecast){
        .energy = energy, .deviation = energy * jp_patrol_pace_deviation(&ledger->pace), .duration = duration};
}

enum jp_status jp_patrol_ledger_foretell(const struct jp_patrol_ledger *ledger, const struct jp_patrol_config *config,
                                         const struct jp_patrol_plan *plan, struct jp_patrol_leg_forecast *forecast)
{
    float modelled;
    float duration;
    enum jp_status status;

    if (ledger == NULL || forecast == NULL) {
        return JP_ERR_ARGUMENT;
    }
    status = plan_alone(ledger, config, plan, &modelled, &duration);
    if (status == JP_OK) {
        *forecast = among_others(ledger, modelled, duration);
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
    status = plan_alone(ledger, config, plan, &ledger->internal.modelled, &duration);
    if (status == JP_OK) {
        ledger->forecast = among_others(ledger, ledger->internal.modelled, duration);
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
    const float taken = joules(ledger->internal.taken);

    jp_patrol_pace_learn(&ledger->pace, 1.0f, ledger->internal.modelled, taken);
    if (jp_four_wheel_learner_update(&ledger->learner, &ledger->internal.driven,
                                     jp_energy_to_q16(ledger->internal.taken, exponent),
                                     &ledger->result.learned) == JP_OK) {
        ledger->learned_from = jp_one_more32(ledger->learned_from);
    } else {
        ledger->left_out = jp_one_more32(ledger->left_out);
    }
}

void jp_patrol_ledger_end(struct jp_patrol_ledger *ledger)
{
    if (!ledger->internal.is_under_way) {
        return;
    }
    ledger->internal.is_under_way = false;
    ledger->result = (struct jp_patrol_leg_result){.forecast = ledger->forecast, .energy = ledger->internal.taken};
    ledger->ended++;
    if (ledger->internal.taken > 0 && ledger->internal.modelled > 0.0f) {
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
