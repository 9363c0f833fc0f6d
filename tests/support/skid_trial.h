/** Robots and grounds that a learner of skid_learner.h has not seen: 20 motions to learn from, then a plan from where
 * the robot is, of 10 motions or until the robot drives on: a leg that ends in a turn on the spot is not over. */
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

/** A leg that goes on while the robot turns on the spot. */
struct skid_trial_leg {
    struct jp_skid_drive expected;
    double took; /**< J */
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

/** Adds what pieces take by a model. */
static inline void skid_trial_expect(struct skid_trial_run *run, const struct jp_skid_energy_model *model,
                                     const struct skid_piece *pieces, size_t count, struct jp_skid_drive *expected)
{
    for (size_t i = 0; i < count; i++) {
        const struct jp_skid_piece piece = skid_core_piece(&pieces[i]);
        run->trial->is_sound = jp_skid_energy_add(model, expected, &piece) == JP_OK && run->trial->is_sound;
    }
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

/** Goes on with a leg until the robot drives on, then learns from it. */
static inline void skid_trial_learn(struct skid_trial_run *run, struct random *random, struct skid_trial_leg *going_on)
{
    const struct skid_leg leg = skid_random_leg(&run->kind->model, random);
    struct skid_piece pieces[SKID_LEG_PIECES_MAX];
    const size_t count = skid_route_add(&run->route, &leg, pieces);
    enum jp_learned learned;

    skid_trial_expect(run, &run->learner.model, pieces, count, &going_on->expected);
    going_on->took += skid_trial_drive(run, pieces, count);
    if (leg.speed != 0) {
        const jp_q16 measured = skid_trial_units(run->kind, going_on->took);
        run->trial->is_sound =
            jp_skid_learner_update(&run->learner, &going_on->expected, measured, &learned) == JP_OK &&
            run->trial->is_sound;
        *going_on = (struct skid_trial_leg){.took = 0};
    }
}

/** What a learner says beforehand of legs. */
struct skid_trial_forecast {
    const struct jp_skid_learner *learner;
    struct jp_forecast_sum sum;
    struct jp_skid_drive going_on;
};

/** Adds pieces to it, as skid_trial_learn() does. */
static inline void skid_trial_foretell(struct skid_trial_run *run, struct skid_trial_forecast *forecast,
                                       const struct skid_piece *pieces, size_t count, bool ends)
{
    skid_trial_expect(run, &forecast->learner->model, pieces, count, &forecast->going_on);
    if (ends) {
        run->trial->is_sound = jp_skid_forecast_add(forecast->learner, &forecast->sum, &forecast->going_on) == JP_OK &&
                               run->trial->is_sound;
        forecast->going_on = (struct jp_skid_drive){.energy = 0};
    }
}

static inline struct skid_forecast skid_trial_judge(struct skid_trial_run *run,
                                                    const struct skid_trial_forecast *foretold, double driven)
{
    const double unit = ldexp(1.0 / JP_Q16_ONE, run->kind->energy->unit_exponent);
    struct jp_forecast forecast = {0, 1};

    run->trial->is_sound =
        jp_skid_forecast_total(foretold->learner, &foretold->sum, &forecast) == JP_OK && run->trial->is_sound;

    const double missed = forecast.energy * unit - driven;

    return (struct skid_forecast){missed / driven, missed / (forecast.deviation * unit)};
}

static inline void skid_trial_plan(struct skid_trial_run *run, struct random *random)
{
    struct jp_skid_learner untaught;
    struct skid_trial_forecast before = {.learner = &untaught};
    struct skid_trial_forecast after = {.learner = &run->learner};
    double driven = 0;
    bool ends = false;

    jp_skid_learner_start(&untaught, run->kind->learning, run->kind->energy);
    run->route.pose = skid_drive_go_on(&run->drive);
    for (int number = 0; number < SKID_TRIAL_LEGS || !ends; number++) {
        const struct skid_leg leg = skid_random_leg(&run->kind->model, random);
        struct skid_piece pieces[SKID_LEG_PIECES_MAX];
        const size_t count = skid_route_add(&run->route, &leg, pieces);
        ends = leg.speed != 0;
        skid_trial_foretell(run, &before, pieces, count, ends);
        skid_trial_foretell(run, &after, pieces, count, ends);
        driven += skid_trial_drive(run, pieces, count);
    }
    run->trial->untaught = skid_trial_judge(run, &before, driven);
    run->trial->taught = skid_trial_judge(run, &after, driven);
}

/** A robot at rest, like the kind but for what `model` says, on ground that is drawn; nothing is learned. The run must
 *  stay where it is. */
static inline void skid_trial_start_as(struct skid_trial_run *run, const struct skid_kind *kind,
                                       const struct skid_steer_model *model, uint64_t seed, struct random *random,
                                       struct skid_trial *trial)
{
    *run = (struct skid_trial_run){.kind = kind, .trial = trial};
    run->hills = skid_random_hills_within(random, kind->model.limits.slope_deg);
    run->ground = skid_ground_hills(&run->hills);

    const struct planar_pose pose = {0, 0, random_uniform(random, -M_PI, M_PI)};

    skid_drive_start(&run->drive, model, &run->ground, &pose, seed);
    skid_route_start(&run->route, &kind->model, &run->ground, &pose);
    jp_skid_learner_start(&run->learner, kind->learning, kind->energy);
}

/** Robot or ground become others where it is, at rest; what it has learned stays. */
static inline void skid_trial_go_on_as(struct skid_trial_run *run, const struct skid_steer_model *model, uint64_t seed)
{
    const struct planar_pose pose = skid_plant_pose(&run->drive.world.plant);

    run->trial->is_sound = run->trial->is_sound && !run->drive.world.plant.tipped;
    skid_drive_start(&run->drive, model, &run->ground, &pose, seed);
    skid_route_start(&run->route, &run->kind->model, &run->ground, &pose);
}

/** Draws a robot and its ground. */
static inline void skid_trial_start(struct skid_trial_run *run, const struct skid_kind *kind, uint64_t seed,
                                    struct random *random, struct skid_trial *trial)
{
    random_init(random, seed);
    *trial = (struct skid_trial){.is_sound = true};
    trial->variation = skid_random_variation(random);

    const struct skid_steer_model varied = skid_varied(&kind->model, &trial->variation);

    skid_trial_start_as(run, kind, &varied, seed, random, trial);
}

/** Learns from so many motions as a trial does. */
static inline void skid_trial_lessons(struct skid_trial_run *run, struct random *random)
{
    struct skid_trial_leg leg = {.took = 0};

    for (int lesson = 0; lesson < SKID_TRIAL_LESSONS; lesson++) {
        skid_trial_learn(run, random, &leg);
    }
}

/** Foretells and drives a plan; what has become of the trial. */
static inline void skid_trial_finish(struct skid_trial_run *run, struct random *random)
{
    skid_trial_plan(run, random);
    jp_skid_learner_factors(&run->learner, run->trial->factor);
    run->trial->changes = run->learner.changes;
    run->trial->is_sound = run->trial->is_sound && !run->drive.world.plant.tipped;
}

/** The trial of a seed. */
static inline void skid_trial_make(const struct skid_kind *kind, uint64_t seed, struct skid_trial *trial)
{
    struct skid_trial_run run;
    struct random random;

    skid_trial_start(&run, kind, seed, &random, trial);
    skid_trial_lessons(&run, &random);
    skid_trial_finish(&run, &random);
}

#endif
