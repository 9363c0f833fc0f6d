#include "tests/support/trial.h"

#include <joulepath/trajectory_energy.h>
#include <joulepath/trajectory_rule.h>
#include <math.h>

#include "sim/missions/segment_route.h"

#define DEGREES   (180 / M_PI)
#define TURN_Q24  16777216.0
#define TIME_MAX  600.0
#define PUSH_WAIT 15.0

/** A trial in progress. */
struct run {
    struct trial *trial;
    struct rig rig;
    struct jp_trajectory_leg legs[TRIAL_TARGETS_MAX];
    struct jp_trajectory trajectory;
    struct segment_route segments;
    struct random random;
    double rate;
    uint64_t start;      /**< tick of the release */
    uint64_t next_push;  /**< tick */
    uint64_t normal_at;  /**< tick from which driving is normal */
    uint64_t stands_for; /**< ticks since the route ended */
};

static uint64_t ticks_of(const struct run *run, double seconds)
{
    return (uint64_t)lround(seconds * run->rate);
}

static void draw_targets(struct trial *trial, struct random *random)
{
    double x = 0;
    double y = 0;

    trial->target_count = 3 + (size_t)random_uniform(random, 0, TRIAL_TARGETS_MAX - 2);
    for (size_t i = 0; i < trial->target_count; i++) {
        double distance = random_uniform(random, 2, 12);
        double direction = random_uniform(random, -M_PI, M_PI);

        x += distance * cos(direction);
        y += distance * sin(direction);
        trial->targets[i] = (struct jp_point){.x = (jp_q16)lround(x * JP_Q16_ONE), .y = (jp_q16)lround(y * JP_Q16_ONE)};
    }
}

static double sign(struct random *random)
{
    return random_uniform(random, -1, 1) < 0 ? -1 : 1;
}

static void recover(struct run *run, double after)
{
    run->normal_at = run->rig.world.tick + ticks_of(run, after + TRIAL_RECOVERY);
}

static void push(struct run *run)
{
    struct world *world = &run->rig.world;

    if (world->tick < run->next_push) {
        return;
    }

    double seconds = random_uniform(&run->random, 0.02, 0.1);

    world_push(world, sign(&run->random) * TRIAL_PUSH_NS / seconds, 0, ticks_of(run, seconds));
    recover(run, seconds);
    run->next_push = world->tick + ticks_of(run, seconds + random_uniform(&run->random, 0, PUSH_WAIT));
    run->trial->pushes++;
}

static void note_peak(double *peak, double value)
{
    *peak = fmax(*peak, fabs(value));
}

static void note_saturation(struct run *run, bool normal)
{
    struct trial *trial = run->trial;

    trial->saturated_ticks++;
    if (normal && trial->normal_saturated_ticks++ == 0) {
        trial->first_saturated_s = (double)(run->rig.world.tick - run->start) / run->rate;
    }
}

static void keep_books(struct run *run)
{
    struct trial *trial = run->trial;
    const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(&run->rig.robot);
    bool normal = run->rig.world.tick > run->normal_at;
    double pitch = telemetry->motion.pitch / TURN_Q24 * 360;

    trial->ticks++;
    if (telemetry->voltages.saturated) {
        note_saturation(run, normal);
    }
    if (normal) {
        trial->normal_ticks++;
        note_peak(&trial->peak_voltage, telemetry->voltages.left / (double)JP_Q16_ONE);
        note_peak(&trial->peak_voltage, telemetry->voltages.right / (double)JP_Q16_ONE);
        note_peak(&trial->peak_pitch_deg, pitch);
    } else {
        note_peak(&trial->peak_pitch_pushed_deg, pitch);
    }
}

/** True while the robot has something left to do. */
static bool goes_on(struct run *run)
{
    struct trial *trial = run->trial;
    enum jp_robot_state state = jp_robot_state_now(&run->rig.robot);

    if (state != JP_ROBOT_BALANCING && state != JP_ROBOT_DRIVING) {
        trial->end = TRIAL_FELL;
        return false;
    }
    if (trial->ticks >= ticks_of(run, TIME_MAX)) {
        trial->end = TRIAL_LATE;
        return false;
    }
    if (state == JP_ROBOT_DRIVING || jp_robot_last_tick(&run->rig.robot)->segments_ended < trial->target_count) {
        return true;
    }
    return run->stands_for++ < ticks_of(run, TRIAL_RECOVERY);
}

static double distance_to_last_target(const struct run *run)
{
    const struct jp_point *target = &run->trial->targets[run->trial->target_count - 1];

    return hypot(run->rig.world.plant.x - target->x / (double)JP_Q16_ONE,
                 run->rig.world.plant.y - target->y / (double)JP_Q16_ONE);
}

static enum jp_status follow_by_rule(struct run *run, const struct jp_energy_model *model)
{
    struct trial *trial = run->trial;
    struct jp_robot *robot = &run->rig.robot;
    const struct jp_trajectory_task task = {
        .config = &jp_robot_configuration(robot)->trajectory,
        .cruise = jp_cruise_speed(model),
        .motion = {.pitch = jp_robot_last_tick(robot)->motion.pitch},
        .targets = trial->targets,
        .count = (uint16_t)trial->target_count,
        .to_stand = true,
    };
    const enum jp_status status = jp_trajectory_by_rule(&task, run->legs, &run->trajectory);

    return status == JP_OK ? jp_robot_drive_trajectory(robot, &run->trajectory) : status;
}

static enum jp_status follow(struct run *run, const struct jp_energy_model *model)
{
    struct trial *trial = run->trial;

    if (trial->strategy == TRIAL_CRUISE) {
        return follow_by_rule(run, model);
    }
    run->segments = (struct segment_route){
        .robot = &run->rig.robot, .model = model, .targets = trial->targets, .count = (uint16_t)trial->target_count};
    return JP_OK;
}

static void drive(struct run *run, const struct jp_energy_model *model)
{
    struct trial *trial = run->trial;

    run->start = run->rig.world.tick;
    run->next_push = run->start + ticks_of(run, random_uniform(&run->random, 0, PUSH_WAIT));
    recover(run, 0);
    if (follow(run, model) != JP_OK) {
        trial->end = TRIAL_FELL;
        return;
    }
    while (goes_on(run)) {
        push(run);
        if (segment_route_work(&run->segments) != JP_OK) {
            trial->end = TRIAL_UNPLANNED;
            return;
        }
        rig_tick(&run->rig);
        keep_books(run);
    }
}

bool trial_run(struct trial *trial, enum trial_strategy strategy, const struct robot_entry *entry,
               const struct robot_file *file, uint64_t seed)
{
    struct run run = {.trial = trial, .rate = file->control.rate_hz};

    *trial = (struct trial){.seed = seed, .strategy = strategy, .end = TRIAL_DONE, .first_saturated_s = -1};
    random_init(&run.random, seed);
    draw_targets(trial, &run.random);
    trial->tilt_deg = TRIAL_TILT_DEG * sign(&run.random);
    if (!rig_init(&run.rig, entry, file, seed)) {
        return false;
    }
    rig_release(&run.rig, trial->tilt_deg / DEGREES);
    drive(&run, entry->energy);
    jp_robot_telemetry(&run.rig.robot, &trial->last);
    trial->end_error = distance_to_last_target(&run);
    return true;
}
