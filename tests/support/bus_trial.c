#include "tests/support/bus_trial.h"

#include <math.h>
#include <stdlib.h>

#include "sim/base/fingerprint.h"
#include "sim/bus/local_ecu.h"

#define DEGREES (180 / M_PI)
#define Q16_ONE 65536.0

/** Faults begin between standing up and the end of the drive, ticks. */
#define FAULTS_FROM  150.0
#define FAULTS_UNTIL 9000.0

#define SPAN_MAX    3000.0 /* of a fault that is no outage, ticks */
#define SILENCE_MIN 600.0  /* longer than the operator's timeout, ticks */
#define FREEZE_MAX  200.0  /* ticks */

#define LIMIT_TICKS    120000U
#define STAND_TICKS    2000U /* at the end */
#define ATTEMPTS_MAX   5U
#define STANDS_BELOW   0.1  /* m/s */
#define STANDS_WITHIN  0.25 /* m: a push or a corrupt command may make it step */
#define FALLEN_DEGREES 40.0 /* the tilt limit of courier24 */
#define ASTRAY_METRES  0.5

/** A trial in progress. */
struct run {
    struct bus_trial *trial;
    struct bus_drive *drive;
    struct can_fault_link faulty;
    struct random random;
    double rate;
    uint64_t commanded; /**< the last tick with a Drive command */
    double commanded_x; /**< where the robot was then, m */
    double commanded_y;
    double stood_x; /**< when it had to stand, m */
    double stood_y;
    uint64_t stood; /**< ticks since the route was done */
};

const char *bus_trial_end_name(enum bus_trial_end end)
{
    static const char *const names[BUS_TRIAL_ENDS] = {
        [BUS_TRIAL_DONE] = "done",
        [BUS_TRIAL_FELL] = "fell",
        [BUS_TRIAL_MOVED] = "moved without a command",
        [BUS_TRIAL_ASTRAY] = "ended elsewhere",
        [BUS_TRIAL_LATE] = "not done in time",
        [BUS_TRIAL_NO_ECU] = "ECU does not answer",
    };

    return names[end];
}

/* The draw. */

static void draw_targets(struct bus_trial *trial, struct random *random)
{
    double x = 0;
    double y = 0;
    double heading = 0;

    trial->target_count = 1 + (size_t)random_uniform(random, 0, BUS_TRIAL_TARGETS_MAX);
    for (size_t i = 0; i < trial->target_count; i++) {
        const double distance = random_uniform(random, 1.5, 4);

        heading += random_uniform(random, -M_PI / 2, M_PI / 2);
        x += distance * cos(heading);
        y += distance * sin(heading);
        trial->targets[i] = (struct jp_point){.x = (jp_q16)lround(x * Q16_ONE), .y = (jp_q16)lround(y * Q16_ONE)};
    }
}

static double draw_span(enum bus_fault_kind kind, struct random *random)
{
    if (bus_fault_is_outage(kind)) {
        return floor(random_uniform(random, 1, BUS_TRIAL_OUTAGE_MAX + 1));
    }
    if (kind == BUS_FAULT_FREEZE) {
        return random_uniform(random, 1, FREEZE_MAX);
    }
    return random_uniform(random, kind == BUS_FAULT_SILENCE ? SILENCE_MIN : 1, SPAN_MAX);
}

/** Outages keep their distance from each other and from other faults, which may be outages of a kind. */
static bool collides(const struct bus_trial *trial, const struct bus_trial_fault *fault)
{
    for (size_t i = 0; i < trial->fault_count; i++) {
        const struct bus_trial_fault *other = &trial->faults[i];
        const bool matters = bus_fault_is_outage(fault->kind) || bus_fault_is_outage(other->kind);

        if (matters && fault->from < other->until + BUS_TRIAL_OUTAGE_GAP &&
            other->from < fault->until + BUS_TRIAL_OUTAGE_GAP) {
            return true;
        }
    }
    return false;
}

static const enum bus_fault_kind kinds[] = {
    BUS_FAULT_LOSS,        BUS_FAULT_REPEAT,   BUS_FAULT_DELAY,   BUS_FAULT_FLIP,
    BUS_FAULT_SWAP,        BUS_FAULT_BLACKOUT, BUS_FAULT_BUS_OFF, BUS_FAULT_ECU_RESET,
    BUS_FAULT_PLANT_PAUSE, BUS_FAULT_FREEZE,   BUS_FAULT_SILENCE, BUS_FAULT_STRANGE,
};

static void draw_fault(struct bus_trial *trial, struct random *random)
{
    struct bus_trial_fault *fault = &trial->faults[trial->fault_count];

    do {
        const double from = random_uniform(random, FAULTS_FROM, FAULTS_UNTIL);

        fault->kind = kinds[(size_t)random_uniform(random, 0, sizeof kinds / sizeof kinds[0])];
        fault->from = (uint64_t)from;
        fault->until = fault->from + (uint64_t)draw_span(fault->kind, random);
    } while (collides(trial, fault));
    fault->share = random_uniform(random, 0, BUS_FAULT_SHARE_MAX);
    fault->channel = (enum world_channel)random_uniform(random, WORLD_ENCODER_LEFT, WORLD_BUS_VOLTAGE + 1);
    trial->fault_count++;
}

void bus_trial_draw(struct bus_trial *trial, uint64_t seed)
{
    struct random random;

    *trial = (struct bus_trial){.seed = seed};
    random_init(&random, seed);
    draw_targets(trial, &random);

    /* Half of the trials have a single fault. */
    const size_t count =
        random_uniform(&random, 0, 1) < 0.5 ? 1 : 2 + (size_t)random_uniform(&random, 0, BUS_TRIAL_FAULTS_MAX - 1);

    while (trial->fault_count < count) {
        draw_fault(trial, &random);
    }
}

/* The faults. */

static void prepare_fault(struct run *run, const struct bus_trial_fault *fault)
{
    bus_fault_add(&run->faulty, fault->kind, fault->share, fault->from, fault->until);
    if (fault->kind == BUS_FAULT_FREEZE) {
        (void)world_add_fault(&run->drive->plant.world, &(struct world_fault){.channel = fault->channel,
                                                                              .kind = WORLD_FROZEN,
                                                                              .from = fault->from,
                                                                              .until = fault->until});
    }
}

static bool is_active(const struct run *run, enum bus_fault_kind kind)
{
    for (size_t i = 0; i < run->trial->fault_count; i++) {
        const struct bus_trial_fault *fault = &run->trial->faults[i];

        if (fault->kind == kind && run->drive->tick >= fault->from && run->drive->tick < fault->until) {
            return true;
        }
    }
    return false;
}

static void set_conditions(struct run *run)
{
    run->drive->conditions = (struct bus_drive_conditions){
        .ecu_reset = is_active(run, BUS_FAULT_ECU_RESET),
        .ecu_bus_off = is_active(run, BUS_FAULT_BUS_OFF),
        .plant_paused = is_active(run, BUS_FAULT_PLANT_PAUSE),
        .operator_silent = is_active(run, BUS_FAULT_SILENCE),
    };
}

/* The watch. */

static void note_command(struct run *run)
{
    const struct bus_drive *drive = run->drive;

    if (drive->commander.phase == JP_OPERATOR_DRIVING && !drive->conditions.operator_silent) {
        run->commanded = drive->tick;
        run->commanded_x = drive->plant.world.plant.x;
        run->commanded_y = drive->plant.world.plant.y;
    }
}

static bool moves(const struct run *run)
{
    const struct world *world = &run->drive->plant.world;

    return fabs(world->plant.state.wheel_rate * world->robot.wheel.radius_m) > STANDS_BELOW;
}

static void note_stop(struct run *run, double since)
{
    const struct plant *plant = &run->drive->plant.world.plant;
    struct bus_trial *trial = run->trial;

    if (moves(run)) {
        trial->stop_seconds = fmax(trial->stop_seconds, since);
        trial->stop_metres = fmax(trial->stop_metres, hypot(plant->x - run->commanded_x, plant->y - run->commanded_y));
    }
    run->stood_x = plant->x;
    run->stood_y = plant->y;
}

/** False when it goes away from where it should stand by now. */
static bool watch_motion(struct run *run)
{
    const struct plant *plant = &run->drive->plant.world.plant;
    const double since = (double)(run->drive->tick - run->commanded) / run->rate;

    if (since <= BUS_TRIAL_STOP_MAX) {
        note_stop(run, since);
        return true;
    }
    return hypot(plant->x - run->stood_x, plant->y - run->stood_y) < STANDS_WITHIN;
}

static bool watch_balance(struct run *run)
{
    const struct plant *plant = &run->drive->plant.world.plant;
    const double pitch = fabs(plant->state.pitch) * DEGREES;

    run->trial->peak_pitch_deg = fmax(run->trial->peak_pitch_deg, pitch);
    return !plant->fallen && pitch < FALLEN_DEGREES;
}

static void note_fingerprint(struct run *run)
{
    const struct plant *plant = &run->drive->plant.world.plant;

    fingerprint_add(&run->trial->fingerprint, &plant->state, sizeof plant->state);
    fingerprint_add(&run->trial->fingerprint, &plant->ledger, sizeof plant->ledger);
}

/** When the drive was broken off the operator sends the robot again, once nothing is wrong any more. */
static void send_again(struct run *run)
{
    struct bus_trial *trial = run->trial;
    bool well = true;

    for (size_t i = 0; i < trial->fault_count; i++) {
        well = well && run->drive->tick > trial->faults[i].until + BUS_TRIAL_OUTAGE_GAP;
    }
    if (run->drive->commander.phase == JP_OPERATOR_FAILED && well && trial->attempts < ATTEMPTS_MAX) {
        (void)jp_operator_route(&run->drive->commander, trial->targets, trial->target_count);
        trial->attempts++;
    }
}

static bool goes_on(struct run *run)
{
    struct bus_trial *trial = run->trial;

    if (!watch_balance(run)) {
        trial->end = BUS_TRIAL_FELL;
        return false;
    }
    if (!watch_motion(run)) {
        trial->end = BUS_TRIAL_MOVED;
        return false;
    }
    if (run->drive->tick >= LIMIT_TICKS) {
        trial->end = BUS_TRIAL_LATE;
        return false;
    }
    run->stood = run->drive->commander.phase == JP_OPERATOR_DONE ? run->stood + 1 : 0;
    return run->stood < STAND_TICKS || run->drive->tick < (uint32_t)FAULTS_UNTIL;
}

static bool step(struct run *run)
{
    set_conditions(run);
    can_fault_link_set_tick(&run->faulty, run->drive->tick);
    if (is_active(run, BUS_FAULT_STRANGE)) {
        bus_fault_send_strange(&run->faulty, &run->drive->plant, &run->random);
    }
    note_command(run);
    if (!bus_drive_lockstep(run->drive)) {
        run->trial->end = BUS_TRIAL_NO_ECU;
        return false;
    }
    note_fingerprint(run);
    send_again(run);
    return goes_on(run);
}

static double end_error(const struct run *run)
{
    const struct jp_point *target = &run->trial->targets[run->trial->target_count - 1];
    const struct plant *plant = &run->drive->plant.world.plant;

    return hypot(plant->x - target->x / Q16_ONE, plant->y - target->y / Q16_ONE);
}

void bus_trial_run_on(struct bus_trial *trial, const struct robot_file *file, const struct jp_can_link *link)
{
    struct bus_drive *drive = malloc(sizeof *drive);
    struct run *run = calloc(1, sizeof *run);

    if (drive == NULL || run == NULL) {
        abort();
    }
    *run = (struct run){.trial = trial, .drive = drive, .rate = file->control.rate_hz};
    random_init(&run->random, ~trial->seed);
    can_fault_link_init(&run->faulty, link, trial->seed);

    const struct jp_can_link faulty = can_fault_link(&run->faulty);

    bus_drive_init(drive, file, trial->seed, &faulty);
    for (size_t i = 0; i < trial->fault_count; i++) {
        prepare_fault(run, &trial->faults[i]);
    }
    trial->end = BUS_TRIAL_DONE;
    trial->fingerprint = FINGERPRINT_START;
    trial->attempts = 1;
    (void)jp_operator_route(&drive->commander, trial->targets, trial->target_count);
    while (step(run)) {
    }
    trial->ticks = drive->tick;
    trial->robot_faults = drive->view.errors.faults;
    trial->end_error = end_error(run);
    if (trial->end == BUS_TRIAL_DONE && trial->end_error > ASTRAY_METRES) {
        trial->end = BUS_TRIAL_ASTRAY;
    }
    free(run);
    free(drive);
}

/* In one process. */

static bool run_local(struct bus_trial *trial, const struct robot_entry *entry, const struct robot_file *file,
                      struct local_ecu *ecu)
{
    struct jp_can_link link;

    if (!local_ecu_start(ecu, entry, entry->energy, &link)) {
        return false;
    }
    bus_trial_run_on(trial, file, &link);
    return true;
}

/** What is left of the trial when only its frozen sensors remain. */
static struct bus_trial only_sensors(const struct bus_trial *trial)
{
    struct bus_trial rest = *trial;

    rest.fault_count = 0;
    for (size_t i = 0; i < trial->fault_count; i++) {
        if (trial->faults[i].kind == BUS_FAULT_FREEZE) {
            rest.faults[rest.fault_count++] = trial->faults[i];
        }
    }
    return rest;
}

/** The robot switched off because it noticed a sensor that was really frozen. */
static bool noticed_frozen_sensor(const struct bus_trial *trial)
{
    const unsigned noticed = JP_FAULT_IMU_FROZEN | JP_FAULT_ENCODER_LEFT | JP_FAULT_ENCODER_RIGHT;
    bool frozen = false;

    for (size_t i = 0; i < trial->fault_count; i++) {
        frozen = frozen || (trial->faults[i].kind == BUS_FAULT_FREEZE && trial->faults[i].from < trial->ticks);
    }
    return frozen && trial->end == BUS_TRIAL_FELL && (trial->robot_faults & noticed) != 0U;
}

bool bus_trial_run(struct bus_trial *trial, const struct robot_entry *entry, const struct robot_file *file)
{
    struct local_ecu *local = malloc(sizeof *local);
    bool ran;

    if (local == NULL) {
        abort();
    }
    ran = run_local(trial, entry, file, local);
    trial->excused = noticed_frozen_sensor(trial);
    if (ran && trial->end != BUS_TRIAL_DONE && !trial->excused) {
        struct bus_trial rest = only_sensors(trial);

        ran = run_local(&rest, entry, file, local);
        trial->excused = rest.end == trial->end;
    }
    free(local);
    return ran;
}
