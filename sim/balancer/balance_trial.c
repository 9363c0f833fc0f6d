#include "sim/balancer/balance_trial.h"

#include <math.h>

#include "sim/base/error.h"

#define DEGREE 0.017453292519943295

/** Of every trial, and of the part of a stand that is measured. */
#define SECONDS 20.0

/** What is sought lies within this share of it. */
#define SHARE 0.02

/** A stand: so upright, and so slow. */
#define UPRIGHT (1.0 * DEGREE)
#define SLOW    0.05 /* m/s */

/** A push that would give the whole robot this speed is more than any takes, m/s. */
#define PUSH_SPEED_MAX 10.0

struct trial {
    struct rig rig;
    const struct robot_entry *entry;
    const struct robot_file *file;
    uint64_t seed;
};

static void run(struct rig *rig, double seconds)
{
    const uint64_t ticks = (uint64_t)(seconds * rig->world.robot.control.rate_hz);

    for (uint64_t i = 0; i < ticks; i++) {
        rig_tick(rig);
    }
}

static bool stands(const struct rig *rig, const struct robot_file *file)
{
    const struct plant_state *state = &rig->world.plant.state;

    return jp_robot_last_tick(&rig->robot)->state == JP_ROBOT_BALANCING && fabs(state->pitch) < UPRIGHT &&
           fabs(state->wheel_rate * file->wheel.radius_m) < SLOW;
}

/** Whether it comes back to a stand. */
typedef bool (*attempt)(struct trial *trial, double size);

static bool comes_back_from_lean(struct trial *trial, double degrees)
{
    rig_release(&trial->rig, degrees * DEGREE);
    run(&trial->rig, SECONDS);
    return stands(&trial->rig, trial->file);
}

static bool comes_back_from_push(struct trial *trial, double impulse)
{
    const uint64_t ticks = (uint64_t)ceil(BALANCE_PUSH_SECONDS * trial->file->control.rate_hz);

    rig_release(&trial->rig, 0);
    run(&trial->rig, SECONDS);
    if (!stands(&trial->rig, trial->file)) {
        return false;
    }
    world_push(&trial->rig.world, impulse * trial->file->control.rate_hz / (double)ticks, 0, ticks);
    run(&trial->rig, SECONDS);
    return stands(&trial->rig, trial->file);
}

/** Both ways. False: the configuration is refused. */
static bool both_ways(struct trial *trial, attempt comes_back, double size, bool *comes)
{
    *comes = true;
    for (int sign = -1; sign <= 1 && *comes; sign += 2) {
        if (!rig_init(&trial->rig, trial->entry, trial->file, trial->seed)) {
            return false;
        }
        *comes = comes_back(trial, sign * size);
    }
    return true;
}

/** The largest size up to `most`, by halving. */
static bool largest(struct trial *trial, attempt comes_back, double most, double *size)
{
    double low = 0;
    double high = most;
    bool comes;

    if (!both_ways(trial, comes_back, most, &comes)) {
        return false;
    }
    if (comes) {
        low = most;
    }
    while (high - low > SHARE * high && high > SHARE * most / 10) {
        const double middle = (low + high) / 2;

        if (!both_ways(trial, comes_back, middle, &comes)) {
            return false;
        }
        *(comes ? &low : &high) = middle;
    }
    *size = low;
    return true;
}

bool balance_trial_limits(const struct robot_entry *entry, const struct robot_file *file, uint64_t seed,
                          struct balance_limits *limits)
{
    struct trial trial = {.entry = entry, .file = file, .seed = seed};
    const double mass = file->body.mass_kg + 2 * file->wheel.mass_kg;

    return largest(&trial, comes_back_from_lean, BALANCE_LEAN_MAX, &limits->lean_deg) &&
           largest(&trial, comes_back_from_push, mass * PUSH_SPEED_MAX, &limits->push_n_s);
}

static double volts(jp_q16 voltage)
{
    return (double)voltage / JP_Q16_ONE;
}

static void measure(struct rig *rig, struct balance_stand *stand)
{
    const struct plant *plant = &rig->world.plant;
    const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(&rig->robot);
    const uint64_t ticks = (uint64_t)(SECONDS * rig->world.robot.control.rate_hz);
    const double begun = plant->ledger.electrical;
    double leans = 0;
    double squares = 0;
    const double place = plant->x;
    double back = 0;
    double forward = 0;

    for (uint64_t i = 0; i < ticks; i++) {
        rig_tick(rig);
        leans += plant->state.pitch * plant->state.pitch;
        const double left = volts(telemetry->voltages.left);
        const double right = volts(telemetry->voltages.right);
        squares += (left * left + right * right) / 2;
        back = fmax(back, place - plant->x);
        forward = fmax(forward, plant->x - place);
    }
    *stand = (struct balance_stand){.lean_rms_deg = sqrt(leans / (double)ticks) / DEGREE,
                                    .voltage_rms_v = sqrt(squares / (double)ticks),
                                    .power_w = (plant->ledger.electrical - begun) / SECONDS,
                                    .wander_m = back + forward};
}

bool balance_trial_stand(const struct robot_entry *entry, const struct robot_file *file, uint64_t seed,
                         struct balance_stand *stand)
{
    struct rig rig;

    if (!rig_init(&rig, entry, file, seed)) {
        return false;
    }
    rig_release(&rig, 0);
    run(&rig, SECONDS);
    measure(&rig, stand);
    if (!stands(&rig, file)) {
        error_line("%s: the robot does not stand", entry->name);
        return false;
    }
    return true;
}
