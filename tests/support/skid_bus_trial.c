#include "tests/support/skid_bus_trial.h"

#include <math.h>
#include <stdlib.h>

#include "sim/base/fingerprint.h"
#include "sim/bus/local_ecu.h"

#define Q16_ONE 65536.0
#define Q24_ONE 16777216.0

/** Of the whole, s. */
#define FAULTS_FROM   0.5
#define FAULTS_UNTIL  15.0
#define SPAN_MAX      3.0 /* of a fault that is no outage */
#define SILENCE_MIN   0.6
#define GAP           0.5 /* between outages */
#define LIMIT_SECONDS 120.0
#define STAND_SECONDS 2.0 /* at the end */

#define ATTEMPTS_MAX 5U

/** What passes between the last frame of a command and the controller's reaction, s: the time-out, and two commands. */
#define REACTION_SECONDS 0.7
/** What a fault may take until it stands besides braking, and what noise may move it then. */
#define SETTLE_SECONDS 0.5
#define STANDS_WITHIN  0.02 /* m */
#define ASTRAY_METRES  0.5

struct run {
    struct skid_bus_trial *trial;
    struct bus_drive *drive;
    struct jp_ecu *ecu;
    struct can_fault_link faulty;
    struct random random;
    double rate;
    bool may_move;           /**< at the last tick */
    uint64_t told_tick;      /**< the last tick in which it might move */
    struct planar_pose told; /**< where it was then */
    bool has_stood;          /**< since then */
    struct planar_pose stood;
    double allowed;  /**< way from `told`, m */
    double settle_s; /**< by when it must stand */
    uint64_t rest;   /**< ticks since the mission has ended */
    unsigned attempts;
};

const char *skid_bus_end_name(enum skid_bus_end end)
{
    static const char *const names[SKID_BUS_ENDS] = {
        [SKID_BUS_DONE] = "done",
        [SKID_BUS_NAMED] = "stands with a named fault",
        [SKID_BUS_ALARM] = "false alarm",
        [SKID_BUS_UNNAMED] = "unnamed",
        [SKID_BUS_MOVED] = "moved without a command",
        [SKID_BUS_ASTRAY] = "ended elsewhere",
        [SKID_BUS_TIPPED] = "tipped over",
        [SKID_BUS_NO_ECU] = "ECU does not answer",
    };

    return names[end];
}

/* The draw. */

static double speed_of(const struct skid_bus_trial *trial)
{
    return trial->robot->limits->speed / Q24_ONE;
}

static void draw_targets(struct skid_bus_trial *trial, struct random *random)
{
    double x = 0;
    double y = 0;
    double heading = 0;

    trial->target_count = 1 + (size_t)random_uniform(random, 0, SKID_BUS_TARGETS_MAX);
    for (size_t i = 0; i < trial->target_count; i++) {
        const double distance = speed_of(trial) * random_uniform(random, 3, 8);

        heading += random_uniform(random, -M_PI / 2, M_PI / 2);
        x += distance * cos(heading);
        y += distance * sin(heading);
        trial->targets[i] = (struct jp_point){.x = (jp_q16)lround(x * Q16_ONE), .y = (jp_q16)lround(y * Q16_ONE)};
    }
}

static bool is_failure(enum bus_fault_kind kind)
{
    return kind == BUS_FAULT_SENSOR || kind == BUS_FAULT_STALL || kind == BUS_FAULT_AIR;
}

static uint64_t draw_end(const struct skid_bus_fault *fault, double rate, struct random *random)
{
    if (is_failure(fault->kind)) {
        return UINT64_MAX;
    }
    if (bus_fault_is_outage(fault->kind)) {
        return fault->from + (uint64_t)random_uniform(random, 1, rate * SKID_BUS_OUTAGE_MAX / 1000 + 1);
    }
    return fault->from +
           (uint64_t)(rate * random_uniform(random, fault->kind == BUS_FAULT_SILENCE ? SILENCE_MIN : 0, SPAN_MAX)) + 1;
}

/** Outages keep their distance from each other and from other faults, which may be outages of a kind. */
static bool collides(const struct skid_bus_trial *trial, const struct skid_bus_fault *fault, uint64_t gap)
{
    for (size_t i = 0; i < trial->fault_count; i++) {
        const struct skid_bus_fault *other = &trial->faults[i];
        const bool matters = (bus_fault_is_outage(fault->kind) && !is_failure(other->kind)) ||
                             (bus_fault_is_outage(other->kind) && !is_failure(fault->kind));

        if (matters && fault->from < other->until + gap && other->from < fault->until + gap) {
            return true;
        }
    }
    return false;
}

static struct world_fault draw_sensor(const struct skid_bus_fault *fault, struct random *random)
{
    const enum world_channel channel = (enum world_channel)random_uniform(random, 0, WORLD_HAL_READ + 1);
    const double share = random_uniform(random, -1, 1);

    return (struct world_fault){.channel = channel,
                                .kind = (enum world_fault_kind)(random_uniform(random, 0, 1) < 0.5   ? WORLD_FROZEN
                                                                : random_uniform(random, 0, 1) < 0.5 ? WORLD_JUMPED
                                                                                                     : WORLD_STUCK),
                                .value = (int32_t)(INT32_MAX * share * share * share),
                                .from = fault->from};
}

static const enum bus_fault_kind kinds[] = {
    BUS_FAULT_LOSS,     BUS_FAULT_REPEAT,  BUS_FAULT_DELAY,     BUS_FAULT_FLIP,    BUS_FAULT_SWAP,
    BUS_FAULT_BLACKOUT, BUS_FAULT_BUS_OFF, BUS_FAULT_ECU_RESET, BUS_FAULT_SILENCE, BUS_FAULT_STRANGE,
    BUS_FAULT_SENSOR,   BUS_FAULT_STALL,   BUS_FAULT_AIR,
};

static void draw_fault(struct skid_bus_trial *trial, struct random *random)
{
    const double rate = trial->model->control.rate_hz;
    struct skid_bus_fault *fault = &trial->faults[trial->fault_count];

    do {
        fault->kind = kinds[(size_t)random_uniform(random, 0, sizeof kinds / sizeof kinds[0])];
        fault->from = (uint64_t)(rate * random_uniform(random, FAULTS_FROM, FAULTS_UNTIL));
        fault->until = draw_end(fault, rate, random);
    } while (collides(trial, fault, (uint64_t)(rate * GAP)));
    fault->share = random_uniform(random, 0, BUS_FAULT_SHARE_MAX);
    fault->side = random_uniform(random, 0, 1) < 0.5 ? SKID_LEFT : SKID_RIGHT;
    fault->sensor = draw_sensor(fault, random);
    trial->fault_count++;
}

void skid_bus_trial_draw(struct skid_bus_trial *trial, uint64_t seed, const struct skid_robot_entry *robot,
                         const struct skid_steer_model *model)
{
    struct random random;

    *trial = (struct skid_bus_trial){.seed = seed, .robot = robot, .model = model};
    random_init(&random, seed);
    draw_targets(trial, &random);

    /* Half of the trials have a single fault. */
    const size_t count =
        random_uniform(&random, 0, 1) < 0.5 ? 1 : 2 + (size_t)random_uniform(&random, 0, SKID_BUS_FAULTS_MAX - 1);

    while (trial->fault_count < count) {
        draw_fault(trial, &random);
    }
}

/* The faults. */

static void prepare_fault(struct run *run, const struct skid_bus_fault *fault)
{
    bus_fault_add(&run->faulty, fault->kind, fault->share, fault->from, fault->until);
    if (fault->kind == BUS_FAULT_SENSOR) {
        (void)world_faults_add(&run->drive->plant.faults, &fault->sensor);
    }
}

static bool is_active(const struct run *run, enum bus_fault_kind kind)
{
    for (size_t i = 0; i < run->trial->fault_count; i++) {
        const struct skid_bus_fault *fault = &run->trial->faults[i];

        if (fault->kind == kind && run->drive->tick >= fault->from && run->drive->tick < fault->until) {
            return true;
        }
    }
    return false;
}

/** With twice what the motor can do. */
static void jam(struct skid_plant *plant, int side)
{
    plant->jam[side] =
        2 * plant->model.motor.torque_constant * plant->model.motor.gear_ratio * plant->model.motor.current_limit_a;
}

static void lift(struct skid_plant *plant, int side)
{
    for (int i = 0; i < plant->contact_count; i++) {
        plant->contacts[i].lifted = plant->contacts[i].lifted || plant->contacts[i].side == side;
    }
}

static bool has_been_lifted(const struct run *run)
{
    for (size_t i = 0; i < run->trial->fault_count; i++) {
        if (run->trial->faults[i].kind == BUS_FAULT_AIR && run->drive->tick > run->trial->faults[i].from) {
            return true;
        }
    }
    return false;
}

/** Both sides in the air would be a robot that was lifted. */
static void break_the_body(struct run *run)
{
    bool is_lifted = has_been_lifted(run);

    for (size_t i = 0; i < run->trial->fault_count; i++) {
        const struct skid_bus_fault *fault = &run->trial->faults[i];
        const bool is_due = run->drive->tick == fault->from;

        if (fault->kind == BUS_FAULT_STALL && is_due) {
            jam(&run->drive->plant.skid.plant, fault->side);
        }
        if (fault->kind == BUS_FAULT_AIR && is_due && !is_lifted) {
            lift(&run->drive->plant.skid.plant, fault->side);
            is_lifted = true;
        }
    }
}

static void set_conditions(struct run *run)
{
    run->drive->conditions = (struct bus_drive_conditions){
        .ecu_reset = is_active(run, BUS_FAULT_ECU_RESET),
        .ecu_bus_off = is_active(run, BUS_FAULT_BUS_OFF),
        .operator_silent = is_active(run, BUS_FAULT_SILENCE),
    };
    break_the_body(run);
}

/* The watch. */

static bool has(const struct skid_bus_trial *trial, bool (*is)(enum bus_fault_kind kind), uint64_t before)
{
    for (size_t i = 0; i < trial->fault_count; i++) {
        if (is(trial->faults[i].kind) && trial->faults[i].from < before) {
            return true;
        }
    }
    return false;
}

static bool is_jam(enum bus_fault_kind kind)
{
    return kind == BUS_FAULT_STALL;
}

static bool is_air(enum bus_fault_kind kind)
{
    return kind == BUS_FAULT_AIR;
}

static bool is_sensor(enum bus_fault_kind kind)
{
    return kind == BUS_FAULT_SENSOR;
}

/** It can take more samples in a row than are ridden out: a bus that fails. */
static bool is_disturbance(enum bus_fault_kind kind)
{
    return kind == BUS_FAULT_LOSS || kind == BUS_FAULT_DELAY || kind == BUS_FAULT_FLIP || kind == BUS_FAULT_SWAP ||
           kind == BUS_FAULT_STRANGE;
}

static double distance(const struct planar_pose *a, const struct planar_pose *b)
{
    return hypot(a->x - b->x, a->y - b->y);
}

static bool is_in_fault(const struct run *run)
{
    return jp_ecu_state_now(run->ecu) == JP_ECU_FAULT;
}

/** It is on its way to where it was sent. */
static bool may_move(const struct run *run)
{
    return run->drive->commander.phase == JP_OPERATOR_DRIVING && !run->drive->conditions.operator_silent &&
           !is_in_fault(run);
}

/** That it has or is told to have. */
static double speed_now(const struct run *run, const struct skid_plant *plant)
{
    struct jp_ecu_motion motion;

    run->ecu->internal.robot.kind->motion(run->ecu->internal.robot.self, &motion);
    return fmax(fabs(plant->state.forward), fabs(motion.reference_speed / Q24_ONE));
}

/** How far it may go now, and for how long, if nobody tells it to go on. */
static void state_the_stop(struct run *run, const struct skid_plant *plant)
{
    const struct jp_skid_robot_config *config = run->trial->robot->config;
    const double speed = fmax(speed_now(run, plant), is_in_fault(run) ? 0 : speed_of(run->trial));
    const double reaction =
        is_in_fault(run) ? 0.1 : REACTION_SECONDS + SKID_BUS_OUTAGE_MAX / 1000.0 + (JP_SKID_WAKE_TICKS + 2) / run->rate;
    const double braking = jp_skid_robot_stopping_distance(config, (jp_q24)lround(fmin(speed, 7) * Q24_ONE)) / Q24_ONE;
    const double swing = has(run->trial, is_air, run->drive->tick + 1) ? plant->model.body.width_m : 0;

    run->allowed = reaction * speed + braking + swing + STANDS_WITHIN;
    run->settle_s = reaction + speed / (config->limits.acceleration / Q24_ONE) * 9 / 8 + SETTLE_SECONDS;
}

static bool watch_motion(struct run *run)
{
    const struct skid_plant *plant = &run->drive->plant.skid.plant;
    const struct planar_pose pose = skid_plant_pose(plant);
    const bool moves = may_move(run);
    const double since = (double)(run->drive->tick - run->told_tick) / run->rate;

    /* A fault after a silence begins another stop, from where it is found. */
    if (moves || (run->may_move && !moves)) {
        run->told = pose;
        run->told_tick = run->drive->tick;
        run->has_stood = false;
        state_the_stop(run, plant);
    }
    run->may_move = moves;
    if (moves) {
        return true;
    }
    if (!run->has_stood) {
        run->trial->stop = fmax(run->trial->stop, distance(&pose, &run->told) / run->allowed);
        run->has_stood = since > run->settle_s;
        run->stood = pose;
        return distance(&pose, &run->told) <= run->allowed;
    }
    return distance(&pose, &run->stood) <= STANDS_WITHIN;
}

/** When the drive was broken off the operator sends the robot again, once nothing is wrong any more. */
static void send_again(struct run *run)
{
    struct skid_bus_trial *trial = run->trial;
    bool well = true;

    for (size_t i = 0; i < trial->fault_count; i++) {
        const struct skid_bus_fault *fault = &trial->faults[i];

        well = well && (is_failure(fault->kind) || run->drive->tick > fault->until + (uint64_t)(GAP * run->rate));
    }
    if (run->drive->commander.phase == JP_OPERATOR_FAILED && well && !is_in_fault(run) &&
        run->attempts < ATTEMPTS_MAX) {
        (void)jp_operator_route(&run->drive->commander, trial->targets, trial->target_count);
        run->attempts++;
    }
}

static double end_error(const struct run *run)
{
    const struct jp_point *target = &run->trial->targets[run->trial->target_count - 1];
    const struct planar_pose pose = skid_plant_pose(&run->drive->plant.skid.plant);

    return hypot(pose.x - target->x / Q16_ONE, pose.y - target->y / Q16_ONE);
}

static uint16_t faults_of(const struct run *run)
{
    struct jp_ecu_progress progress;

    run->ecu->internal.robot.kind->progress(run->ecu->internal.robot.self, &progress);
    return progress.faults;
}

/** Of a mission that has come to rest. */
static enum skid_bus_end judge(struct run *run)
{
    if (is_in_fault(run)) {
        const bool failed =
            has(run->trial, is_failure, run->drive->tick) || has(run->trial, is_disturbance, run->drive->tick);

        return faults_of(run) == 0U ? SKID_BUS_UNNAMED : failed ? SKID_BUS_NAMED : SKID_BUS_ALARM;
    }
    if (end_error(run) <= ASTRAY_METRES) {
        return SKID_BUS_DONE;
    }
    return run->drive->commander.phase == JP_OPERATOR_DONE ? SKID_BUS_ASTRAY : SKID_BUS_UNNAMED;
}

static bool goes_on(struct run *run)
{
    struct skid_bus_trial *trial = run->trial;
    const bool has_ended = run->drive->commander.phase == JP_OPERATOR_DONE || is_in_fault(run);

    if (run->drive->plant.skid.plant.tipped) {
        trial->end = SKID_BUS_TIPPED;
        return false;
    }
    if (!watch_motion(run)) {
        trial->end = SKID_BUS_MOVED;
        return false;
    }
    run->rest = has_ended ? run->rest + 1 : 0;
    if (run->rest > (uint64_t)(STAND_SECONDS * run->rate) &&
        (is_in_fault(run) || run->drive->tick > (uint64_t)(FAULTS_UNTIL * run->rate))) {
        trial->end = judge(run);
        return false;
    }
    if (run->drive->tick > (uint64_t)(LIMIT_SECONDS * run->rate)) {
        trial->end = judge(run);
        return false;
    }
    return true;
}

static bool step(struct run *run)
{
    set_conditions(run);
    can_fault_link_set_tick(&run->faulty, run->drive->tick);
    if (is_active(run, BUS_FAULT_STRANGE)) {
        bus_fault_send_strange(&run->faulty, &run->drive->plant, &run->random);
    }
    if (!bus_drive_lockstep(run->drive)) {
        run->trial->end = SKID_BUS_NO_ECU;
        return false;
    }
    plant_node_fingerprint(&run->drive->plant, &run->trial->fingerprint);
    send_again(run);
    return goes_on(run);
}

static void drive_it(struct run *run, const struct jp_can_link *link)
{
    static const struct skid_ground level = {NULL, NULL};
    static const struct planar_pose origin = {0, 0, 0};
    struct skid_bus_trial *trial = run->trial;

    can_fault_link_init(&run->faulty, link, trial->seed);

    const struct jp_can_link faulty = can_fault_link(&run->faulty);

    bus_drive_init_skid(run->drive, trial->model, &level, &origin, trial->seed, &faulty);
    for (size_t i = 0; i < trial->fault_count; i++) {
        prepare_fault(run, &trial->faults[i]);
    }
    trial->fingerprint = FINGERPRINT_START;
    run->attempts = 1;
    run->told = origin;
    state_the_stop(run, &run->drive->plant.skid.plant);
    (void)jp_operator_route(&run->drive->commander, trial->targets, trial->target_count);
    while (step(run)) {
    }
    trial->ticks = run->drive->tick;
    trial->robot_faults = faults_of(run);
    trial->end_error = end_error(run);
}

/** What a controller that sees only these sensors cannot know, or what physics does before it can act. */
static bool could_not_know(const struct skid_bus_trial *trial)
{
    const bool misled = has(trial, is_sensor, trial->ticks);

    switch (trial->end) {
    case SKID_BUS_TIPPED:
        return has(trial, is_jam, trial->ticks) || has(trial, is_air, trial->ticks);
    case SKID_BUS_ASTRAY:
        return misled || has(trial, is_air, trial->ticks);
    default:
        return false;
    }
}

bool skid_bus_trial_run(struct skid_bus_trial *trial)
{
    struct local_ecu *ecu = malloc(sizeof *ecu);
    struct bus_drive *drive = malloc(sizeof *drive);
    struct run *run = calloc(1, sizeof *run);
    struct jp_can_link link;

    if (ecu == NULL || drive == NULL || run == NULL) {
        abort();
    }
    const bool started = local_ecu_start_skid(ecu, trial->robot, &link);

    if (started) {
        *run = (struct run){
            .trial = trial, .drive = drive, .ecu = &ecu->node.lockstep.ecu, .rate = trial->model->control.rate_hz};
        random_init(&run->random, ~trial->seed);
        drive_it(run, &link);
        trial->thrown = could_not_know(trial);
    }
    free(run);
    free(drive);
    free(ecu);
    return started;
}
