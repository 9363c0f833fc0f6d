#include "sim/missions/mission.h"

#include <joulepath/pilot.h>
#include <joulepath/tables.h>
#include <math.h>
#include <stdarg.h>
#include <time.h>

#include "sim/balancer/energy_unit.h"
#include "sim/balancer/fault_names.h"
#include "sim/base/error.h"
#include "sim/base/progress.h"
#include "sim/base/strict_math.h"
#include "sim/missions/cruise_plan.h"
#include "sim/missions/mission_log.h"
#include "sim/missions/script.h"
#include "sim/missions/segment_route.h"

#define Q24_ONE  16777216.0
#define Q16_ONE  65536.0
#define JOULE    4294967296.0
#define TURN_Q24 (2 * M_PI / Q24_ONE)
#define DEGREES  (180 / M_PI)

/** A robot at rest is so slow: m/s, rad/s. */
#define REST_SPEED     0.01
#define REST_TURN_RATE 0.02

#define NO_MEMORY "no memory for so long a route; leave waypoints out"

/** A mission in progress. */
struct drive {
    struct mission *mission;
    const struct scenario *scenario;
    struct rig rig;
    const struct jp_energy_model *model;
    struct jp_point targets[BEZIER_WAYPOINTS_MAX];
    struct jp_pilot pilot;
    struct cruise_plan cruise;     /**< within a budget, or the passages of the pilot, which plans without one */
    struct segment_route segments; /**< of the greedy plan */
    struct script script;
    size_t step;       /**< next step of the script */
    size_t ended;      /**< steps ended */
    size_t leg;        /**< being driven */
    uint64_t leg_tick; /**< its first tick */
    struct jp_telemetry leg_start;
    double leg_plant;              /**< the plant's motor energy at its start, J */
    struct bezier_point reference; /**< where the reference is, m */
    jp_phase reference_wheel;
    jp_phase reference_yaw;
    uint64_t start_tick;
    struct mission_view view;
};

bool mission_cannot(struct mission *mission, const char *format, ...)
{
    va_list arguments;

    va_start(arguments, format);
    (void)vsnprintf(mission->impossible, MISSION_REASON_SIZE, format, arguments);
    va_end(arguments);
    return false;
}

static struct jp_telemetry telemetry_of(const struct drive *drive)
{
    struct jp_telemetry telemetry;

    jp_robot_telemetry(&drive->rig.robot, &telemetry);
    return telemetry;
}

static double seconds(const struct drive *drive, uint64_t ticks)
{
    return (double)ticks * world_tick_seconds(&drive->rig.world);
}

/* The reference's path, integrated from its angles. */

static double phase_turns(jp_phase now, jp_phase before)
{
    return (double)(int64_t)(now - before) / 72057594037927936.0;
}

static void follow_reference(struct drive *drive)
{
    const struct jp_telemetry telemetry = telemetry_of(drive);
    double rolled = phase_turns(telemetry.reference_wheel, drive->reference_wheel) * 2 * M_PI *
                    drive->scenario->robot.wheel.radius_m;
    jp_phase middle = drive->reference_yaw + (jp_phase)((int64_t)(telemetry.reference_yaw - drive->reference_yaw) / 2);
    double heading = phase_turns(middle, 0) * 2 * M_PI;

    drive->reference.x += rolled * strict_cos(heading);
    drive->reference.y += rolled * strict_sin(heading);
    drive->reference_wheel = telemetry.reference_wheel;
    drive->reference_yaw = telemetry.reference_yaw;
}

/* The log. */

static double battery_energy(const struct drive *drive, const struct jp_telemetry *telemetry)
{
    return (double)(telemetry->energy_battery - drive->leg_start.energy_battery) / JOULE;
}

/** Energy of the leg so far, of the scenario's kind, J. */
static double measured(const struct drive *drive, const struct jp_telemetry *telemetry)
{
    return drive->scenario->energy == ENERGY_BATTERY
               ? battery_energy(drive, telemetry)
               : (double)(telemetry->energy_model - drive->leg_start.energy_model) / JOULE;
}

static void log_row(const struct drive *drive)
{
    const struct jp_telemetry telemetry = telemetry_of(drive);
    const struct plant *plant = &drive->rig.world.plant;
    const struct plant_input *input = &drive->rig.world.input;
    double radius = drive->scenario->robot.wheel.radius_m;
    double energy = measured(drive, &telemetry);

    for (size_t i = 0; i < drive->leg; i++) {
        energy += drive->mission->legs[i].measured_energy;
    }
    mission_view_row(&drive->view, drive->scenario,
                     &(struct mission_row){
                         .time = seconds(drive, drive->rig.world.tick - drive->start_tick),
                         .position = {plant->x, plant->y},
                         .reference = drive->reference,
                         .heading = plant->state.yaw,
                         .speed = plant->state.wheel_rate * radius,
                         .turn_rate = plant->state.yaw_rate,
                         .reference_speed = telemetry.reference_wheel_rate * TURN_Q24 * radius,
                         .reference_turn_rate = telemetry.reference_yaw_rate * TURN_Q24,
                         .pitch_deg = plant->state.pitch * DEGREES,
                         .voltage_left = (double)telemetry.voltages.left / Q16_ONE,
                         .voltage_right = (double)telemetry.voltages.right / Q16_ONE,
                         .current_left = plant_current_left(plant, input),
                         .current_right = plant_current_right(plant, input),
                         .energy = energy,
                         .leg = drive->leg,
                     });
}

/* Legs. */

void mission_set_target(struct mission_leg *leg, struct bezier_point target)
{
    leg->target = target;
    leg->passed = INFINITY;
}

void mission_note_passing(struct mission *mission, size_t leg, struct bezier_point position)
{
    for (size_t i = leg > 0 ? leg - 1 : 0; i <= leg && leg < mission->leg_count; i++) {
        struct mission_leg *passed = &mission->legs[i];

        passed->passed =
            fmin(passed->passed, strict_hypot(position.x - passed->target.x, position.y - passed->target.y));
    }
}

double mission_plant_energy(const struct scenario *scenario, const struct plant *plant)
{
    return scenario->energy == ENERGY_BATTERY ? plant->ledger.electrical : plant->ledger.motor;
}

static void begin_leg(struct drive *drive)
{
    drive->leg_tick = drive->rig.world.tick;
    drive->leg_start = telemetry_of(drive);
    drive->leg_plant = mission_plant_energy(drive->scenario, &drive->rig.world.plant);
}

static void note_plan(const struct drive *drive, struct mission_leg *leg, const struct jp_segment *segment)
{
    leg->planned = true;
    leg->planned_energy = energy_unit_joules(drive->model, segment->energy);
    leg->speed = segment->command.motion.speed / Q24_ONE;
    leg->turn_rate = segment->command.motion.turn_rate / Q24_ONE;
    leg->arc = segment->arc / Q24_ONE;
    leg->turn = segment->command.turn / Q24_ONE;
}

/** Called in the tick that ended the leg, before its physics: telemetry and plant show the same instant. */
static void close_leg(const struct drive *drive, struct mission_leg *leg)
{
    const struct plant *plant = &drive->rig.world.plant;
    const struct jp_telemetry telemetry = telemetry_of(drive);

    leg->duration = seconds(drive, drive->rig.world.tick - drive->leg_tick);
    leg->measured_energy = measured(drive, &telemetry);
    leg->battery_energy = battery_energy(drive, &telemetry);
    leg->plant_energy = mission_plant_energy(drive->scenario, plant) - drive->leg_plant +
                        drive->scenario->robot.electronics.power_w * leg->duration;
    leg->end = (struct bezier_point){plant->x, plant->y};
    leg->end_error = strict_hypot(plant->x - leg->target.x, plant->y - leg->target.y);
    leg->end_speed = plant->state.wheel_rate * drive->scenario->robot.wheel.radius_m;
}

static void end_leg(struct drive *drive)
{
    close_leg(drive, &drive->mission->legs[drive->leg]);
    drive->leg++;
    begin_leg(drive);
}

/* Strategies. */

/** What the energy model says of a script with one step a leg. */
static void predict_script(struct drive *drive)
{
    struct jp_motion before = {0, 0};

    for (size_t i = 0; i < drive->script.count; i++) {
        struct jp_segment segment = {.command = drive->script.steps[i].command};

        if (jp_energy_predict(drive->model, &before, &segment.command, &segment.energy) == JP_OK) {
            note_plan(drive, &drive->mission->legs[i], &segment);
        }
        before = segment.command.motion;
    }
}

static bool prepare_straight(struct drive *drive, const struct mission *like)
{
    const double yaw_bandwidth = jp_robot_configuration(&drive->rig.robot)->reference.yaw_bandwidth / Q16_ONE;
    double durations[BEZIER_WAYPOINTS_MAX];

    if (like->impossible[0] != '\0') {
        return mission_cannot(
            drive->mission, "there are no times to take: the strategy that it is compared with cannot drive the route");
    }
    for (size_t i = 0; i < like->leg_count; i++) {
        durations[i] = like->legs[i].duration;
    }
    if (!script_straight(&drive->script, drive->scenario->waypoints, drive->scenario->waypoint_count, durations,
                         yaw_bandwidth > 0 ? 2 / yaw_bandwidth : 0)) {
        return mission_cannot(drive->mission, NO_MEMORY);
    }
    script_keep_limit(&drive->script, jp_robot_configuration(&drive->rig.robot)->limits.speed);
    predict_script(drive);
    return true;
}

static bool prepare_bezier(struct drive *drive, enum bezier_scope scope)
{
    struct bezier_path path;

    if (!bezier_optimise(&path, &drive->scenario->robot, drive->scenario->energy, drive->scenario->waypoints,
                         drive->scenario->waypoint_count, scope)) {
        return mission_cannot(drive->mission, "the optimiser of its curves fails; move the waypoints apart");
    }
    if (!script_bezier(&drive->script, &path)) {
        return mission_cannot(drive->mission, NO_MEMORY);
    }
    script_keep_limit(&drive->script, jp_robot_configuration(&drive->rig.robot)->limits.speed);
    return true;
}

static bool cannot_be_planned(const struct drive *drive, size_t leg, enum jp_status status)
{
    return mission_cannot(
        drive->mission, "waypoints[%zu]: cannot be planned (status %d); move it, or widen the limits of the robot file",
        leg + 1, (int)status);
}

static bool prepare_pilot(struct drive *drive, const struct robot_entry *entry)
{
    const bool battery = drive->scenario->energy == ENERGY_BATTERY;
    const struct jp_learning *learning = battery ? entry->learning_battery : entry->learning;
    const struct jp_pilot_config config = {.model = drive->model,
                                           .learning = drive->scenario->model == SCENARIO_PUBLISHED ? NULL : learning,
                                           .meter = battery ? JP_PILOT_BATTERY : JP_PILOT_MOTORS};
    const char *field = "";

    if (jp_pilot_init(&drive->pilot, &config, &drive->rig.robot, &field) != JP_OK) {
        error_line("%s: %s is out of range; run make learning ROBOT=%s", entry->name, field, entry->name);
        return false;
    }
    return true;
}

static bool has_budget(const struct drive *drive)
{
    return drive->scenario->within_seconds > 0 || drive->scenario->within_joules > 0;
}

static bool is_piloted(const struct drive *drive)
{
    const enum mission_strategy strategy = drive->mission->strategy;

    return (strategy == MISSION_CRUISE && !has_budget(drive)) || strategy == MISSION_OPTIMISED_CRUISE;
}

/** So that as much is enough. */
static double tenths_up(double figure)
{
    return ceil(10 * figure) / 10;
}

static bool prepare_within(struct drive *drive)
{
    const struct scenario *scenario = drive->scenario;
    const struct jp_budget_plan *forecast = &drive->cruise.forecast;
    const enum jp_status status =
        cruise_plan_within(&drive->cruise, scenario, jp_robot_configuration(&drive->rig.robot), drive->model);
    const double energy = energy_unit_joules(drive->model, forecast->energy);

    if (status == JP_ERR_INFEASIBLE && forecast->energy < INT32_MAX) {
        return scenario->within_seconds > 0
                   ? mission_cannot(drive->mission, "within_seconds = %g: the robot needs %.1f s; raise it",
                                    scenario->within_seconds, tenths_up(forecast->seconds / Q16_ONE))
                   : mission_cannot(drive->mission, "within_joules = %g: the robot needs %.1f J; raise it",
                                    scenario->within_joules, tenths_up(energy));
    }
    if (status != JP_OK) {
        return cannot_be_planned(drive, 0, status);
    }
    drive->mission->forecast = (struct mission_forecast){true, energy, 0};
    return true;
}

static bool prepare_optimised(struct drive *drive, const struct robot_entry *entry)
{
    const enum jp_status status =
        cruise_plan_optimise(&drive->cruise, drive->scenario, jp_robot_configuration(&drive->rig.robot), drive->model);

    if (has_budget(drive)) {
        return mission_cannot(drive->mission, "it keeps no budget; leave within_seconds and within_joules out");
    }
    if (status != JP_OK) {
        return mission_cannot(drive->mission,
                              "no headings and speeds are found for its waypoints (status %d); move them apart",
                              (int)status);
    }
    return prepare_pilot(drive, entry);
}

static bool prepare_segments(struct drive *drive, const struct robot_entry *entry)
{
    const char *field = "";

    if (jp_segment_limits_check(&entry->config->limits, drive->model, &field) != JP_OK) {
        error_line("%s: %s is out of range; run make gains ROBOT=%s", entry->name, field, entry->name);
        return false;
    }
    drive->segments = (struct segment_route){.robot = &drive->rig.robot,
                                             .model = drive->model,
                                             .targets = drive->targets,
                                             .count = (uint16_t)drive->mission->leg_count};
    return true;
}

static bool prepare(struct drive *drive, const struct robot_entry *entry, const struct mission *driven)
{
    switch (drive->mission->strategy) {
    case MISSION_STRAIGHT:
        return prepare_straight(drive, &driven[MISSION_OPTIMAL]);
    case MISSION_BEZIER:
        return prepare_bezier(drive, BEZIER_SEGMENT);
    case MISSION_CRUISE:
        return has_budget(drive) ? prepare_within(drive) : prepare_pilot(drive, entry);
    case MISSION_STRAIGHT_CRUISE:
        return prepare_straight(drive, &driven[MISSION_CRUISE]);
    case MISSION_BEZIER_ROUTE:
        return prepare_bezier(drive, BEZIER_ROUTE);
    case MISSION_OPTIMISED_CRUISE:
        return prepare_optimised(drive, entry);
    case MISSION_OPTIMAL:
    default:
        return prepare_segments(drive, entry);
    }
}

/** Hands the next step of the script over as soon as the robot takes one; false when it refuses the step. */
static bool feed(struct drive *drive)
{
    enum jp_status status;

    if (drive->step >= drive->script.count) {
        return true;
    }
    status = jp_robot_drive(&drive->rig.robot, &drive->script.steps[drive->step].command);
    if (status == JP_OK) {
        drive->step++;
    }
    if (status == JP_ERR_ARGUMENT) {
        return mission_cannot(drive->mission,
                              "leg %zu: the path bends or hurries more than the robot takes; move the waypoints apart",
                              drive->leg + 1);
    }
    return true;
}

/** The leg that the robot is in after `ended` segments. */
static size_t current_leg(const struct drive *drive, size_t ended)
{
    if (drive->script.count == 0) {
        return ended;
    }
    return ended < drive->script.count ? drive->script.steps[ended].leg : drive->mission->leg_count;
}

/** A slice of the pilot's work. */
static bool work_of_pilot(struct drive *drive)
{
    const enum jp_status status = jp_pilot_work(&drive->pilot);

    return status == JP_OK || cannot_be_planned(drive, drive->pilot.targets_surveyed, status);
}

/** The greedy plan's next segment, if it has one that is due. */
static bool work_of_segments(struct drive *drive)
{
    const uint16_t planned = drive->segments.planned;
    const enum jp_status status = segment_route_work(&drive->segments);

    if (status != JP_OK) {
        return cannot_be_planned(drive, planned, status);
    }
    if (drive->segments.planned > planned) {
        note_plan(drive, &drive->mission->legs[planned], &drive->segments.segment);
    }
    return true;
}

/** Plans and hands over what the robot shall do next; false when a waypoint cannot be planned. */
static bool command(struct drive *drive)
{
    return (is_piloted(drive) ? work_of_pilot(drive) : work_of_segments(drive)) && feed(drive);
}

static bool still_stands(const struct drive *drive)
{
    const struct jp_telemetry telemetry = telemetry_of(drive);

    if (telemetry.state == JP_ROBOT_FALLEN) {
        return mission_cannot(drive->mission, "leg %zu: the robot fell; correct the control group of the robot file",
                              drive->leg + 1);
    }
    if (telemetry.state == JP_ROBOT_FAULT) {
        char faults[FAULTS_NAME_SIZE];

        faults_name(telemetry.faults, faults);
        return mission_cannot(
            drive->mission,
            "leg %zu: the robot stopped with the fault: %s; correct its sensors or lower limits in the robot "
            "file",
            drive->leg + 1, faults);
    }
    return true;
}

static void keep_books(struct drive *drive)
{
    uint64_t tick = drive->rig.world.tick;
    uint64_t row_ticks = (uint64_t)(drive->scenario->robot.control.rate_hz / MISSION_LOG_RATE);

    if (tick == drive->start_tick) {
        begin_leg(drive);
    }
    if (current_leg(drive, telemetry_of(drive).segments_ended) > drive->leg) {
        end_leg(drive);
    }
    mission_note_passing(drive->mission, drive->leg,
                         (struct bezier_point){drive->rig.world.plant.x, drive->rig.world.plant.y});
    follow_reference(drive);
    if (mission_view_wants_rows(&drive->view) && (tick - drive->start_tick) % row_ticks == 0) {
        log_row(drive);
    }
    if (drive->view.watch != NULL) {
        const struct plant *plant = &drive->rig.world.plant;

        drive->view.watch(drive->view.context, (struct bezier_point){plant->x, plant->y}, plant->state.yaw);
    }
}

static size_t percent_done(const struct drive *drive)
{
    double elapsed = (double)(drive->rig.world.tick - drive->leg_tick);
    double left = (double)telemetry_of(drive).segment_ticks_left;

    if (drive->script.count > 0) {
        return 100 * drive->step / drive->script.count;
    }
    return (size_t)(100 * ((double)drive->leg + elapsed / (elapsed + left + 1)) / (double)drive->mission->leg_count);
}

/** One tick; false when the robot cannot go on. */
static bool pass_tick(struct drive *drive)
{
    jp_hal_tick(&drive->rig.hal, &drive->rig.robot, &drive->rig.written);
    if (!still_stands(drive)) {
        return false;
    }
    keep_books(drive);
    world_step(&drive->rig.world);
    return true;
}

bool mission_is_at_rest(const struct scenario *scenario, const struct plant *plant)
{
    return fabs(plant->state.wheel_rate) * scenario->robot.wheel.radius_m < REST_SPEED &&
           fabs(plant->state.yaw_rate) < REST_TURN_RATE;
}

/** After the last leg, until the robot has been at rest for a while. */
static bool brake(struct drive *drive)
{
    const double rate = drive->scenario->robot.control.rate_hz;
    struct mission_leg *braking = &drive->mission->braking;
    double rest = 0;

    braking->target = drive->mission->legs[drive->mission->leg_count - 1].target;
    while (rest < MISSION_REST_SECONDS) {
        if (!pass_tick(drive)) {
            return false;
        }
        rest = mission_is_at_rest(drive->scenario, &drive->rig.world.plant) ? rest + 1 / rate : 0;
        if (seconds(drive, drive->rig.world.tick - drive->leg_tick) > MISSION_BRAKING_SECONDS_MAX) {
            return mission_cannot(
                drive->mission,
                "the robot does not come to a stand within %g s; correct control.weights of the robot "
                "file, or leave out end = \"stand\"",
                MISSION_BRAKING_SECONDS_MAX);
        }
    }
    close_leg(drive, braking);
    braking->passed = braking->end_error;
    return true;
}

static bool run(struct drive *drive)
{
    struct mission *mission = drive->mission;

    while (drive->leg < mission->leg_count) {
        if (!command(drive) || !pass_tick(drive)) {
            return false;
        }
        if (drive->view.progress != NULL) {
            progress_show(drive->view.progress, percent_done(drive), 100);
        }
    }
    return !drive->scenario->to_stand || brake(drive);
}

static void add(struct mission_leg *total, const struct mission_leg *leg)
{
    total->duration += leg->duration;
    total->measured_energy += leg->measured_energy;
    total->plant_energy += leg->plant_energy;
    total->battery_energy += leg->battery_energy;
}

void mission_sum_up(struct mission *mission)
{
    struct mission_leg *total = &mission->total;

    *total = mission->legs[mission->leg_count - 1];
    total->planned = true;
    total->planned_energy = total->duration = total->measured_energy = total->plant_energy = total->battery_energy = 0;
    for (size_t i = 0; i < mission->leg_count; i++) {
        const struct mission_leg *leg = &mission->legs[i];

        total->planned = total->planned && leg->planned;
        total->planned_energy += leg->planned_energy;
        total->passed = fmax(total->passed, leg->passed);
        add(total, leg);
    }
    /* No plan knows the braking. */
    if (mission->braking.duration > 0) {
        total->planned = false;
        add(total, &mission->braking);
        total->end = mission->braking.end;
        total->end_error = mission->braking.end_error;
        total->end_speed = mission->braking.end_speed;
    }
}

const struct jp_energy_model *mission_model(const struct scenario *scenario, const struct robot_entry *entry)
{
    return scenario->model == SCENARIO_PUBLISHED ? &jp_energy_model_published
                                                 : rig_energy_model(entry, scenario->energy);
}

/* Plans while the robot stands, so that no time passes. */
static bool follow_with_pilot(struct drive *drive)
{
    const struct jp_pilot_route route = {.targets = drive->targets,
                                         .count = (uint16_t)drive->mission->leg_count,
                                         .end = drive->scenario->to_stand ? JP_PILOT_STAND : JP_PILOT_PASS,
                                         .passages = drive->mission->strategy == MISSION_CRUISE
                                                         ? &drive->scenario->passages[1]
                                                         : drive->cruise.passages};
    struct jp_forecast forecast;

    (void)jp_pilot_follow(&drive->pilot, &route);
    while (drive->pilot.targets_planned == 0) {
        /* One that fell or stopped before is never given a plan. */
        if (!still_stands(drive) || !work_of_pilot(drive)) {
            return false;
        }
    }
    (void)jp_pilot_answer(&drive->pilot, &forecast);
    drive->mission->forecast = (struct mission_forecast){true, energy_unit_joules(drive->model, forecast.energy),
                                                         energy_unit_joules(drive->model, forecast.deviation)};
    return true;
}

static bool follow(struct drive *drive)
{
    if (is_piloted(drive)) {
        return follow_with_pilot(drive);
    }
    if (drive->mission->strategy == MISSION_CRUISE) {
        (void)jp_robot_drive_trajectory(&drive->rig.robot, &drive->cruise.trajectory);
    }
    return true;
}

static bool start(struct drive *drive, const struct mission *driven)
{
    const struct scenario *scenario = drive->scenario;
    const struct robot_entry *entry = rig_find_robot(scenario->robot.name);
    struct mission *mission = drive->mission;

    drive->model = entry == NULL ? NULL : mission_model(scenario, entry);
    if (drive->model == NULL || !rig_init(&drive->rig, entry, &scenario->robot, scenario->seed)) {
        return false;
    }
    mission->leg_count = scenario->waypoint_count - 1;
    for (size_t i = 0; i < mission->leg_count; i++) {
        mission_set_target(&mission->legs[i], scenario->waypoints[i + 1]);
        drive->targets[i].x = (jp_q16)lround(scenario->waypoints[i + 1].x * Q16_ONE);
        drive->targets[i].y = (jp_q16)lround(scenario->waypoints[i + 1].y * Q16_ONE);
    }
    if (!prepare(drive, entry, driven)) {
        return false;
    }
    rig_release(&drive->rig, 0);
    drive->start_tick = drive->rig.world.tick;
    drive->reference_wheel = telemetry_of(drive).reference_wheel;
    drive->reference_yaw = telemetry_of(drive).reference_yaw;
    return follow(drive);
}

void mission_complain(const struct mission *mission, const struct scenario *scenario)
{
    if (mission->impossible[0] != '\0') {
        error_line("%s: %s", scenario->name, mission->impossible);
    }
}

double mission_wall_clock(void)
{
    struct timespec now;

    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

bool mission_run(struct mission *mission, enum mission_strategy strategy, const struct scenario *scenario,
                 const struct mission *driven, const struct mission_view *view)
{
    struct drive drive = {.mission = mission, .scenario = scenario};

    *mission = (struct mission){.strategy = strategy};
    if (view != NULL) {
        drive.view = *view;
    }
    if (drive.view.log != NULL) {
        mission_log_header(drive.view.log);
    }

    bool done = start(&drive, driven);
    double begin = mission_wall_clock();

    done = done && run(&drive);
    mission->wall_seconds = mission_wall_clock() - begin;
    if (drive.view.progress != NULL) {
        progress_end();
    }
    if (done) {
        mission->ticks = drive.rig.world.tick - drive.start_tick;
        mission->saturated_ticks = telemetry_of(&drive).saturated_ticks;
        mission_sum_up(mission);
    }
    script_free(&drive.script);
    return done;
}
