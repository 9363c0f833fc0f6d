// eva: -eva-slevel-function main:20
/** Any tables that pass, any drives on any grounds and energies, with grounds or without, for ever. */
#include <joulepath/skid_grounds.h>

#include "tests/proof/any.h"

static struct jp_skid_learning learning;
static struct jp_factor_learning of_grounds;
static struct jp_skid_energy_model built_in;
static struct jp_skid_learner robot;
static struct jp_skid_grounds grounds;

static void learn(struct jp_skid_grounds *known)
{
    struct jp_skid_ground_drive drive;
    enum jp_learned learned;

    ANY(drive);
    (void)jp_skid_grounds_update(known, &robot, &drive, any_int(), &learned);
}

static void forecast(const struct jp_skid_grounds *known)
{
    struct jp_skid_ground_drive drive;
    struct jp_skid_ground_sum sum = {0};
    struct jp_forecast expected;

    ANY_TIMES
    {
        ANY(drive);
        if (jp_skid_grounds_forecast_add(&robot, &sum, &drive) != JP_OK) {
            return;
        }
    }
    (void)jp_skid_grounds_forecast_total(known, &robot, &sum, &expected);
}

static void add(void)
{
    struct jp_skid_drive drive;
    struct jp_skid_drive sum;

    ANY(drive);
    ANY(sum);
    jp_skid_drive_add(&sum, &drive, any_long(1, INT64_MAX));
}

int main(void)
{
    struct jp_skid_grounds *known;
    const char *field;

    ANY(learning);
    ANY(of_grounds);
    ANY(built_in);
    if (jp_skid_learning_check(&learning, &field) != JP_OK || jp_skid_energy_check(&built_in, &field) != JP_OK ||
        jp_factor_learning_check(&of_grounds, &field) != JP_OK) {
        return 0;
    }
    jp_skid_learner_start(&robot, &learning, &built_in);
    jp_skid_grounds_start(&grounds, &of_grounds, &robot);
    known = any_bool() ? &grounds : NULL;
    ANY_TIMES
    {
        learn(known);
        forecast(known);
        add();
        jp_skid_grounds_follow(&grounds, &robot);
        (void)jp_skid_grounds_model(known, &robot, (uint8_t)any_unsigned(JP_GROUND_CLASSES - 1U));
    }
    ARRIVED();
    return 0;
}
