/** Robots and grounds that a learner of skid_learner.h has not seen: 20 legs to learn from, then a plan of 10. */
#ifndef JOULEPATH_TESTS_SUPPORT_SKID_TRIAL_H
#define JOULEPATH_TESTS_SUPPORT_SKID_TRIAL_H

#include <joulepath/meter.h>
#include <joulepath/skid_learner.h>

#include "sim/skid_steer/skid_drive.h"
#include "sim/skid_steer/skid_hills.h"

#define SKID_TRIAL_LESSONS 20
#define SKID_TRIAL_LEGS    10

/** 97.5 % of a normal distribution are below so many standard deviations. */
#define SKID_TRIAL_INTERVAL 1.959964

/** A kind of robot. */
struct skid_kind {
    struct skid_steer_model model;
    const struct jp_skid_energy_model *energy;
    const struct jp_skid_learning *learning;
};

/** Forecast of a plan against what it took. */
struct skid_forecast {
    double error; /**< over the energy driven, with its sign */
    double error_deviations;
};

struct skid_trial {
    struct skid_forecast untaught;
    struct skid_forecast taught;
    struct skid_variation variation; /**< what the robot is */
    jp_q16 factor[JP_SKID_FACTORS];  /**< what was learned */
    double astray;                   /**< farthest from the route, m */
    uint32_t changes;
    bool is_sound; /**< it did not tip, and the core refused nothing */
};

/** One run. */
struct skid_trial_run {
    const struct skid_kind *kind;
    struct skid_hills hills;
    struct skid_ground ground;
    struct skid_drive drive;
    struct skid_route route;
    struct jp_skid_learner learner;
    struct skid_trial *trial;
};

static inline jp_q16 skid_trial_units(const struct skid_kind *kind, double joules)
{
    return jp_energy_to_q16((jp_energy)llround(joules * 4294967296.0), kind->energy->unit_exponent);
}

/** Of pieces on a model. */
static inline struct jp_skid_drive skid_trial_expected(struct skid_trial_run *run,
                                                       const struct jp_skid_energy_model *model,
                                                       const struct skid_piece *pieces, size_t count)
{
    struct jp_skid_drive expected = {0};

    for (size_t i = 0; i < count; i++) {
        const struct jp_skid_piece piece = skid_core_piece(&pieces[i]);
        run->trial->is_sound = jp_skid_energy_add(model, &expected, &piece) == JP_OK && run->trial->is_sound;
    }
    return expected;
}

/** J that the pieces took. */
static inline double skid_trial_drive(struct skid_trial_run *run, const struct skid_piece *pieces, size_t count)
{
    const double before = skid_drive_energy(&run->drive);

    for (size_t i = 0; i < count; i++) {
        skid_drive_piece(&run->drive, &pieces[i]);
        run->trial->astray = fmax(run->trial->astray, skid_drive_distance(&run->drive));
    }
    return skid_drive_energy(&run->drive) - before;
}

static inline void skid_trial_learn(struct skid_trial_run *run, struct random *random)
{
    const struct skid_leg leg = skid_random_leg(&run->kind->model, random);
    struct skid_piece pieces[SKID_LEG_PIECES_MAX];
    const size_t count = skid_route_add(&run->route, &leg, pieces);
    const struct jp_skid_drive expected = skid_trial_expected(run, &run->learner.model, pieces, count);
    const jp_q16 measured = skid_trial_units(run->kind, skid_trial_drive(run, pieces, count));
    enum jp_learned learned;

    run->trial->is_sound =
        jp_skid_learner_update(&run->learner, &expected, measured, &learned) == JP_OK && run->trial->is_sound;
}

/** Adds pieces to the forecast of a learner. */
static inline void skid_trial_foretell(struct skid_trial_run *run, const struct jp_skid_learner *learner,
                                       struct jp_forecast_sum *sum, const struct skid_piece *pieces, size_t count)
{
    const struct jp_skid_drive expected = skid_trial_expected(run, &learner->model, pieces, count);

    run->trial->is_sound = jp_skid_forecast_add(learner, sum, &expected) == JP_OK && run->trial->is_sound;
}

static inline struct skid_forecast skid_trial_judge(struct skid_trial_run *run, const struct jp_skid_learner *learner,
                                                    const struct jp_forecast_sum *sum, double driven)
{
    const double unit = ldexp(1.0 / JP_Q16_ONE, run->kind->energy->unit_exponent);
    struct jp_forecast forecast = {0, 1};

    run->trial->is_sound = jp_skid_forecast_total(learner, sum, &forecast) == JP_OK && run->trial->is_sound;

    const double missed = forecast.energy * unit - driven;

    return (struct skid_forecast){missed / driven, missed / (forecast.deviation * unit)};
}

static inline void skid_trial_plan(struct skid_trial_run *run, struct random *random)
{
    struct jp_skid_learner untaught;
    struct jp_forecast_sum before = {0, {0}, 0};
    struct jp_forecast_sum after = {0, {0}, 0};
    double driven = 0;

    jp_skid_learner_start(&untaught, run->kind->learning, run->kind->energy);
    for (int number = 0; number < SKID_TRIAL_LEGS; number++) {
        const struct skid_leg leg = skid_random_leg(&run->kind->model, random);
        struct skid_piece pieces[SKID_LEG_PIECES_MAX];
        const size_t count = skid_route_add(&run->route, &leg, pieces);
        skid_trial_foretell(run, &untaught, &before, pieces, count);
        skid_trial_foretell(run, &run->learner, &after, pieces, count);
        driven += skid_trial_drive(run, pieces, count);
    }
    run->trial->untaught = skid_trial_judge(run, &untaught, &before, driven);
    run->trial->taught = skid_trial_judge(run, &run->learner, &after, driven);
}

/** Draws a robot and its ground; nothing is learned. The run must stay where it is. */
static inline void skid_trial_start(struct skid_trial_run *run, const struct skid_kind *kind, uint64_t seed,
                                    struct random *random, struct skid_trial *trial)
{
    random_init(random, seed);
    *trial = (struct skid_trial){.is_sound = true};
    *run = (struct skid_trial_run){.kind = kind, .trial = trial};
    trial->variation = skid_random_variation(random);
    run->hills = skid_random_hills_within(random, kind->model.limits.slope_deg);
    run->ground = skid_ground_hills(&run->hills);

    const struct skid_steer_model varied = skid_varied(&kind->model, &trial->variation);
    const struct planar_pose pose = {0, 0, random_uniform(random, -M_PI, M_PI)};

    skid_drive_start(&run->drive, &varied, &run->ground, &pose, seed);
    skid_route_start(&run->route, &kind->model, &run->ground, &pose);
    jp_skid_learner_start(&run->learner, kind->learning, kind->energy);
}

/** The trial of a seed. */
static inline void skid_trial_make(const struct skid_kind *kind, uint64_t seed, struct skid_trial *trial)
{
    struct skid_trial_run run;
    struct random random;

    skid_trial_start(&run, kind, seed, &random, trial);
    for (int lesson = 0; lesson < SKID_TRIAL_LESSONS; lesson++) {
        skid_trial_learn(&run, &random);
    }
    skid_trial_plan(&run, &random);
    jp_skid_learner_factors(&run.learner, trial->factor);
    trial->changes = run.learner.changes;
    trial->is_sound = trial->is_sound && !run.drive.world.plant.tipped;
}

#endif
