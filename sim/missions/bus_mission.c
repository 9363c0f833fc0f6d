#include "sim/missions/bus_mission.h"

#include <math.h>

#include "hal/linux/periodic.h"
#include "sim/base/error.h"
#include "sim/base/fingerprint.h"
#include "sim/base/progress.h"
#include "sim/base/strict_math.h"
#include "sim/missions/mission_log.h"

#define DEGREES     (180 / M_PI)
#define Q12_ONE     4096.0
#define Q16_ONE     65536.0
#define Q24_ONE     16777216.0
#define ENERGY_ONE  4294967296.0
#define ANGLE16_ONE 65536.0
#define NANOSECONDS 1000000000U

/** A route takes at most this long, s. */
#define MISSION_TIME_MAX 3600.0

/** A mission in progress. */
struct run {
    struct bus_mission *result;
    const struct scenario *scenario;
    struct mission_view view;
    struct bus_mission_timing timing;
    struct jp_periodic timer;
    bool under_way;      /**< the first segment has begun */
    uint64_t start_tick; /**< of it */
    uint64_t leg_tick;   /**< first of the leg */
    double leg_plant;    /**< the plant's motor energy at its start, J */
    int64_t start_spent; /**< by the ECU's meters at the start */
    int64_t start_drawn;
    size_t leg;
    struct bezier_point reference; /**< where the reference is, m */
};

static struct plant_truth truth_of(const struct run *run)
{
    struct plant_truth truth;

    plant_node_look(&run->result->drive.plant, &truth);
    return truth;
}

static struct bezier_point position_of(const struct plant_truth *truth)
{
    return (struct bezier_point){truth->x, truth->y};
}

static bool is_balancer(const struct run *run)
{
    return run->scenario->kind == SCENARIO_BALANCER;
}

static uint64_t tick_of(const struct run *run)
{
    return plant_node_tick(&run->result->drive.plant);
}

static double rate_of(const struct run *run)
{
    return plant_node_rate(&run->result->drive.plant);
}

static double seconds(const struct run *run, uint64_t ticks)
{
    return (double)ticks / rate_of(run);
}

/** Of the scenario's kind, J; a balancer's without its electronics. */
static double plant_energy(const struct run *run)
{
    const struct plant_node *node = &run->result->drive.plant;

    return is_balancer(run) ? mission_plant_energy(run->scenario, &node->world.plant) : node->drawn_j;
}

/* The fingerprint. */

static void note_fingerprint(struct run *run)
{
    const struct ecu_view *view = &run->result->drive.view;

    plant_node_fingerprint(&run->result->drive.plant, &run->result->fingerprint);
    fingerprint_add(&run->result->fingerprint, &view->spent.energy, sizeof view->spent.energy);
    fingerprint_add(&run->result->fingerprint, &view->drawn.energy, sizeof view->drawn.energy);
}

/* The log. */

static void follow_reference(struct run *run)
{
    const struct jp_can_reference_t *reference = &run->result->drive.view.reference;
    const double heading = reference->heading / ANGLE16_ONE * 2 * M_PI;
    const double rolled = reference->speed / Q12_ONE / rate_of(run);

    run->reference.x += rolled * strict_cos(heading);
    run->reference.y += rolled * strict_sin(heading);
}

static double drawn(const struct run *run)
{
    return (double)(run->result->drive.view.drawn.energy - run->start_drawn) / ENERGY_ONE;
}

/** Of the scenario's kind, J since the start. */
static double measured(const struct run *run)
{
    return run->scenario->energy == ENERGY_BATTERY
               ? drawn(run)
               : (double)(run->result->drive.view.spent.energy - run->start_spent) / ENERGY_ONE;
}

static void log_row(const struct run *run)
{
    const struct ecu_view *view = &run->result->drive.view;
    const struct plant_truth truth = truth_of(run);

    mission_view_row(&run->view, run->scenario,
                     &(struct mission_row){
                         .time = seconds(run, tick_of(run) - run->start_tick),
                         .position = position_of(&truth),
                         .reference = run->reference,
                         .heading = truth.heading,
                         .speed = truth.speed,
                         .turn_rate = truth.turn_rate,
                         .reference_speed = view->reference.speed / Q12_ONE,
                         .reference_turn_rate = view->reference.yaw_rate / Q12_ONE * 2 * M_PI,
                         .pitch_deg = truth.pitch * DEGREES,
                         .voltage_left = view->motors.voltage_left / 128.0,
                         .voltage_right = view->motors.voltage_right / 128.0,
                         .current_left = truth.current_left,
                         .current_right = truth.current_right,
                         .energy = measured(run),
                         .leg = run->leg,
                     });
}

/* Legs. */

static void begin_leg(struct run *run)
{
    run->leg_tick = tick_of(run);
    run->leg_plant = plant_energy(run);
}

/** The first segment begins in the tick that announces it; the plant has stepped on since. */
static void begin(struct run *run)
{
    const struct plant_truth truth = truth_of(run);

    run->under_way = true;
    run->start_spent = run->result->drive.view.spent.energy;
    run->start_drawn = run->result->drive.view.drawn.energy;
    run->reference = position_of(&truth);
    begin_leg(run);
    run->leg_tick--;
    run->start_tick = run->leg_tick;
}

static void note_plan(struct run *run)
{
    const struct ecu_view *view = &run->result->drive.view;
    const size_t index = (size_t)view->segment_forecast.segment - 1;

    if (view->segment_forecast.segment == 0 || index >= run->result->mission.leg_count) {
        return;
    }

    struct mission_leg *leg = &run->result->mission.legs[index];

    leg->planned = true;
    leg->planned_energy = view->segment_forecast.energy / Q16_ONE;
    leg->speed = view->segment_motion.speed / Q24_ONE;
    leg->turn_rate = view->segment_motion.turn_rate / Q24_ONE;
    leg->turn = view->segment_shape.turn / Q24_ONE;
    leg->arc = leg->turn_rate * (view->segment_shape.duration / Q16_ONE);
}

/** It ended with the tick before: the plant has stepped once since. */
static void close_leg(struct run *run, struct mission_leg *leg)
{
    const struct plant_truth truth = truth_of(run);

    leg->duration = seconds(run, tick_of(run) - 1 - run->leg_tick);
    leg->plant_energy = plant_energy(run) - run->leg_plant +
                        (is_balancer(run) ? run->scenario->robot.electronics.power_w * leg->duration : 0);
    leg->end = position_of(&truth);
    leg->end_error = strict_hypot(truth.x - leg->target.x, truth.y - leg->target.y);
    leg->end_speed = truth.speed;
    begin_leg(run);
    run->leg_tick--;
}

static void end_leg(struct run *run)
{
    const struct jp_can_segment_result_t *segment = &run->result->drive.view.segment_result;
    struct mission *mission = &run->result->mission;

    if (run->leg >= mission->leg_count || segment->segment != run->leg + 1) {
        return;
    }

    struct mission_leg *leg = &mission->legs[run->leg];

    leg->battery_energy = segment_joules(segment->drawn);
    leg->measured_energy =
        run->scenario->energy == ENERGY_BATTERY ? leg->battery_energy : segment_joules(segment->spent);
    close_leg(run, leg);
    run->leg++;
}

/** No message tells of the braking alone: it is what the meters count beyond the legs. */
static void end_braking(struct run *run)
{
    struct mission *mission = &run->result->mission;
    struct mission_leg *braking = &mission->braking;

    braking->measured_energy = measured(run);
    braking->battery_energy = drawn(run);
    for (size_t i = 0; i < mission->leg_count; i++) {
        braking->measured_energy -= mission->legs[i].measured_energy;
        braking->battery_energy -= mission->legs[i].battery_energy;
    }
    close_leg(run, braking);
    braking->passed = braking->end_error;
}

static void keep_books(struct run *run)
{
    struct ecu_view *view = &run->result->drive.view;
    const uint64_t row_ticks = (uint64_t)(rate_of(run) / MISSION_LOG_RATE);

    if (view->segment_begins && !run->under_way) {
        begin(run);
    }
    if (view->segment_planned) {
        note_plan(run);
    }
    if (view->segment_ended) {
        end_leg(run);
    }
    view->segment_begins = view->segment_planned = view->segment_ended = false;
    note_fingerprint(run);
    if (!run->under_way) {
        return;
    }

    const struct plant_truth truth = truth_of(run);

    mission_note_passing(&run->result->mission, run->leg, position_of(&truth));
    follow_reference(run);
    if (mission_view_wants_rows(&run->view) && (tick_of(run) - run->start_tick) % row_ticks == 0) {
        log_row(run);
    }
    if (run->view.watch != NULL) {
        run->view.watch(run->view.context, position_of(&truth), truth.heading);
    }
}

/* Time. */

static void start_clock(struct run *run)
{
    if (run->timing.pace != BUS_MISSION_LOCKSTEP) {
        jp_periodic_start(&run->timer, NANOSECONDS / (uint32_t)rate_of(run));
    }
}

static bool tick(struct run *run)
{
    struct bus_drive *drive = &run->result->drive;

    if (run->timing.pace == BUS_MISSION_REAL_TIME) {
        (void)jp_periodic_wait(&run->timer);
        bus_drive_real_time(drive);
        return true;
    }
    if (run->timing.pace == BUS_MISSION_PACED) {
        (void)jp_periodic_wait(&run->timer);
    }
    if (bus_drive_lockstep(drive)) {
        return true;
    }
    error_line("no ECU answered for %u s%s", drive->patience,
               drive->link.port.state(drive->link.port.context) == JP_CAN_DOWN
                   ? ", and the bus is down; bring it back and start jp-ecu on it, in lockstep like this program"
                   : "; start jp-ecu on the same bus, in lockstep like this program");
    return false;
}

static void note_clock(struct run *run)
{
    if (run->timing.pace != BUS_MISSION_LOCKSTEP) {
        run->result->missed_periods = run->timer.missed;
        run->result->worst_lateness_us = (double)run->timer.worst_lateness_us;
    }
}

/* The whole. */

enum mission_strategy bus_mission_strategy(const struct scenario *scenario)
{
    return scenario->kind == SCENARIO_BALANCER ? MISSION_CRUISE : MISSION_ROUNDED;
}

static void prepare(struct run *run, const struct jp_can_link *link)
{
    static const struct skid_ground level = {NULL, NULL};
    static const struct planar_pose origin = {0, 0, 0};
    struct bus_mission *result = run->result;

    *result = (struct bus_mission){.fingerprint = FINGERPRINT_START,
                                   .mission = {.strategy = bus_mission_strategy(run->scenario)}};
    if (is_balancer(run)) {
        bus_drive_init(&result->drive, &run->scenario->robot, run->scenario->seed, link);
    } else {
        bus_drive_init_skid(&result->drive, &run->scenario->skid, &level, &origin, run->scenario->seed, link);
    }
    result->drive.patience = run->timing.patience;
    result->mission.leg_count = run->scenario->waypoint_count - 1;
    for (size_t i = 0; i < result->mission.leg_count; i++) {
        mission_set_target(&result->mission.legs[i], run->scenario->waypoints[i + 1]);
    }
    result->mission.braking.target = run->scenario->waypoints[result->mission.leg_count];
}

static bool hand_over_route(struct run *run)
{
    struct jp_point route[JP_ROUTE_LENGTH_MAX];
    const size_t count = run->result->mission.leg_count;

    if (count > JP_ROUTE_LENGTH_MAX) {
        error_line("%s: waypoints: %zu after the start, a route on the bus holds at most %u; drive it in parts",
                   run->scenario->name, count, JP_ROUTE_LENGTH_MAX);
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        route[i].x = (jp_q16)lround(run->scenario->waypoints[i + 1].x * Q16_ONE);
        route[i].y = (jp_q16)lround(run->scenario->waypoints[i + 1].y * Q16_ONE);
    }
    if (jp_operator_route(&run->result->drive.commander, route, count) != JP_OK) {
        error_line("%s: waypoints: one is beyond ±512 m, which the bus does not carry; move it", run->scenario->name);
        return false;
    }
    return true;
}

static size_t percent_done(const struct run *run)
{
    const double elapsed = seconds(run, tick_of(run) - run->leg_tick);
    const double left = run->result->drive.view.reference.segment_time_left / 64.0;

    return (size_t)(100 * ((double)run->leg + elapsed / (elapsed + left + 0.001)) /
                    (double)run->result->mission.leg_count);
}

/** Of two controllers each tells of its own route, so that nothing certain would be heard. */
static bool is_alone(const struct run *run)
{
    if (run->result->drive.view.errors.conflicts == 0U) {
        return true;
    }
    error_line("leg %zu: another controller sends with the ECU's ids; take it off the bus and restart jp-ecu",
               run->leg + 1);
    return false;
}

static bool pass_tick(struct run *run)
{
    if (!tick(run) || !is_alone(run)) {
        return false;
    }
    keep_books(run);
    return true;
}

/** The operator is done, and hears no more whether the robot has fallen. */
static bool is_upright(const struct run *run)
{
    const uint8_t state = run->result->drive.view.status.state;
    const bool has_fallen = state == JP_CAN_ECU_STATUS_STATE_FALLEN_CHOICE;

    if (!has_fallen && state != JP_CAN_ECU_STATUS_STATE_FAULT_CHOICE) {
        return true;
    }
    error_line("after the last leg: %s", jp_operator_failure_text(has_fallen ? JP_FAILURE_FALLEN : JP_FAILURE_FAULT));
    return false;
}

/** Until the robot has been at rest for a while. */
static bool brake(struct run *run)
{
    const uint64_t ticks_needed = (uint64_t)(MISSION_REST_SECONDS * rate_of(run));
    uint64_t ticks_of_rest = 0;

    while (ticks_of_rest < ticks_needed) {
        if (!pass_tick(run) || !is_upright(run)) {
            return false;
        }
        ticks_of_rest =
            mission_is_at_rest(run->scenario, &run->result->drive.plant.world.plant) ? ticks_of_rest + 1 : 0;
        if (seconds(run, tick_of(run) - run->leg_tick) > MISSION_BRAKING_SECONDS_MAX) {
            error_line("after the last leg: the robot does not come to a stand within %g s; correct control.weights of "
                       "the robot file, or leave out end = \"stand\"",
                       MISSION_BRAKING_SECONDS_MAX);
            return false;
        }
    }
    end_braking(run);
    return true;
}

static bool drive_route(struct run *run)
{
    const struct jp_operator *commander = &run->result->drive.commander;

    while (commander->phase != JP_OPERATOR_DONE || run->leg < run->result->mission.leg_count) {
        if (!pass_tick(run)) {
            return false;
        }
        if (commander->phase == JP_OPERATOR_FAILED) {
            error_line("leg %zu: %s", run->leg + 1, jp_operator_failure_text(commander->failure));
            return false;
        }
        if (seconds(run, run->result->drive.tick) > MISSION_TIME_MAX) {
            error_line("leg %zu: not done after %.0f s; look at the frames with candump", run->leg + 1,
                       MISSION_TIME_MAX);
            return false;
        }
        if (run->view.progress != NULL && run->under_way && run->leg < run->result->mission.leg_count) {
            progress_show(run->view.progress, percent_done(run), 100);
        }
    }
    /* A robot that its sides steer has ended its last leg where it stands. */
    return !is_balancer(run) || !run->scenario->to_stand || brake(run);
}

bool bus_mission_run(struct bus_mission *result, const struct scenario *scenario, const struct jp_can_link *link,
                     struct bus_mission_timing timing, const struct mission_view *view)
{
    struct run run = {.result = result, .scenario = scenario, .timing = timing};

    if (view != NULL) {
        run.view = *view;
    }
    prepare(&run, link);
    if (!hand_over_route(&run)) {
        return false;
    }
    if (run.view.log != NULL) {
        mission_log_header(run.view.log);
    }
    start_clock(&run);

    const double begin_wall = mission_wall_clock();
    const bool done = drive_route(&run);

    result->mission.wall_seconds = mission_wall_clock() - begin_wall;
    result->mission.ticks = run.leg_tick - run.start_tick;
    result->mission.saturated_ticks = result->drive.view.motors.saturated_ticks;
    note_clock(&run);
    if (run.view.progress != NULL) {
        progress_end();
    }
    if (done) {
        mission_sum_up(&result->mission);
    }
    return done;
}

bool bus_mission_host(struct bus_mission *result, const struct scenario *scenario, const struct jp_can_link *link,
                      struct bus_mission_timing timing, double duration, bool (*stop)(void))
{
    struct run run = {.result = result, .scenario = scenario, .timing = timing};
    bool running = true;

    prepare(&run, link);
    start_clock(&run);
    while (running && !stop() && (duration <= 0 || seconds(&run, result->drive.tick) < duration)) {
        running = tick(&run);
        note_fingerprint(&run);
    }
    note_clock(&run);
    return running;
}
