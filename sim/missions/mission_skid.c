#include "sim/missions/mission_skid.h"

#include <joulepath/skid_pilot.h>
#include <math.h>

#include "sim/balancer/fault_names.h"
#include "sim/base/error.h"
#include "sim/base/progress.h"
#include "sim/base/strict_math.h"
#include "sim/missions/mission_log.h"
#include "sim/missions/navigation_skid.h"

#define Q24_ONE 16777216.0
#define Q16_ONE 65536.0
#define JOULE   4294967296.0
#define RADIANS (2 * M_PI / 4294967296.0)
#define DEGREES (180 / M_PI)

/** A mission in progress. */
struct skid_mission {
    struct mission *mission;
    const struct scenario *scenario;
    struct mission_view view;
    struct navigation_skid skid;
    struct navigation_robot robot;
    struct jp_point targets[BEZIER_WAYPOINTS_MAX];
    struct jp_path_piece pieces[JP_SKID_PILOT_PIECES(BEZIER_WAYPOINTS_MAX)];
    struct jp_path_drive follower; /**< tells what the robot is to follow */
    struct jp_path_set_point reference;
    uint64_t ticks;      /**< since the path was handed over */
    double start_energy; /**< of the robot's meter, J */
    double leg_plant;    /**< of the plant's ledger where the leg began, J */
    struct jp_skid_telemetry telemetry;
};

static struct jp_skid_pilot *pilot_of(struct skid_mission *run)
{
    return &run->skid.pilot;
}

static double joules(const struct skid_mission *run, jp_q16 energy)
{
    return ldexp(energy / Q16_ONE, run->robot.unit_exponent);
}

/** By the robot, J. */
static double metered_energy(const struct skid_mission *run)
{
    return (double)jp_skid_robot_meter(&run->skid.controller)->battery / JOULE;
}

/** Out of the battery's terminals, electronics included, J. */
static double plant_energy(const struct skid_mission *run)
{
    const struct skid_ledger *ledger = &run->skid.world.plant.state.ledger;

    return ledger->battery - ledger->supply;
}

/* ---- Start ---- */

static bool prepare_pilot(struct skid_mission *run, const struct mission *driven)
{
    struct jp_skid_pilot *pilot = pilot_of(run);
    struct jp_skid_pilot_config config = pilot->config;
    const char *field = "";

    /* The waypoint of a rounded corner is still between the robot's tracks. */
    config.corner = run->mission->strategy == MISSION_TURN_AND_GO ? 0 : config.limits.width / 2;
    config.pieces = run->pieces;
    config.places = sizeof run->pieces / sizeof run->pieces[0];
    if (jp_skid_pilot_init(pilot, &config, &run->skid.controller, &field) != JP_OK) {
        error_line("%s: %s is out of range; run make identify ROBOT=%s", run->robot.name, field, run->robot.name);
        return false;
    }
    return run->mission->strategy != MISSION_ROUNDED_AGAIN ||
           jp_skid_learner_restore(&pilot->learner, &driven[MISSION_ROUNDED].learned, &field) == JP_OK;
}

/** On level ground, looking along x. */
static bool prepare(struct skid_mission *run, const struct mission *driven)
{
    const uint64_t again = run->mission->strategy == MISSION_ROUNDED_AGAIN ? 1 : 0;
    const struct scenario *scenario = run->scenario;
    const struct skid_robot_entry *entry = skid_robot_find(scenario->skid.name);
    const struct jp_terrain level = {.config = {.has_elevation = false}};
    const struct clearance_pose origin = {0, 0, 0};

    return entry != NULL &&
           navigation_skid_init(&run->skid, entry, &scenario->skid, &level, NULL, &origin, scenario->seed + again,
                                &run->robot) &&
           prepare_pilot(run, driven);
}

static bool cannot_be_planned(const struct skid_mission *run, enum jp_status status)
{
    return mission_cannot(run->mission,
                          "the route cannot be planned (status %d); leave at least 1 mm and at most %d m from each "
                          "waypoint to the next",
                          (int)status, JP_PIECE_LENGTH_MAX / JP_Q24_ONE);
}

/* Plans while the robot stands, so that no time passes. */
static bool plan(struct skid_mission *run)
{
    struct jp_skid_pilot *pilot = pilot_of(run);
    const struct jp_skid_pilot_route route = {.targets = run->targets, .count = (uint16_t)run->mission->leg_count};
    struct jp_forecast forecast;
    enum jp_status status = jp_skid_pilot_follow(pilot, &route);

    while (status == JP_OK && pilot->phase == JP_SKID_PILOT_PLANNING) {
        status = jp_skid_pilot_work(pilot);
    }
    if (status != JP_OK) {
        return cannot_be_planned(run, status);
    }
    (void)jp_skid_pilot_answer(pilot, &forecast);
    run->mission->forecast =
        (struct mission_forecast){true, joules(run, forecast.energy), joules(run, forecast.deviation)};
    return true;
}

static bool start(struct skid_mission *run, const struct mission *driven)
{
    struct mission *mission = run->mission;
    const struct scenario *scenario = run->scenario;
    const char *field;

    mission->leg_count = scenario->waypoint_count - 1;
    for (size_t i = 0; i < mission->leg_count; i++) {
        mission_set_target(&mission->legs[i], scenario->waypoints[i + 1]);
        run->targets[i].x = (jp_q16)lround(scenario->waypoints[i + 1].x * Q16_ONE);
        run->targets[i].y = (jp_q16)lround(scenario->waypoints[i + 1].y * Q16_ONE);
    }
    if (!prepare(run, driven) || !plan(run)) {
        return false;
    }
    (void)jp_path_drive_init(&run->follower, &jp_skid_robot_configuration(&run->skid.controller)->path, &field);
    jp_path_drive_begin(&run->follower, jp_skid_pilot_path(pilot_of(run)));
    run->leg_plant = plant_energy(run);
    run->start_energy = metered_energy(run);
    return true;
}

/* ---- Legs ---- */

static void note_plan(struct skid_mission *run)
{
    const struct jp_skid_pilot *pilot = pilot_of(run);
    struct mission_leg *leg = &run->mission->legs[pilot->legs_begun - 1];

    leg->planned = true;
    leg->planned_energy = joules(run, pilot->leg.energy);
    leg->speed = pilot->leg.speed / Q24_ONE;
    leg->turn = pilot->leg.turn / Q24_ONE;
}

/** What the leg that ended took, as the pilot tells. */
static void note_result(struct skid_mission *run)
{
    const struct jp_skid_pilot *pilot = pilot_of(run);
    struct mission_leg *leg = &run->mission->legs[pilot->legs_ended - 1];
    const double plant = plant_energy(run);
    const struct clearance_pose pose = run->robot.pose(run->robot.self);

    leg->duration = pilot->result.ticks / run->robot.rate_hz;
    leg->measured_energy = (double)pilot->result.energy / JOULE;
    leg->battery_energy = leg->measured_energy;
    leg->plant_energy = plant - run->leg_plant;
    run->leg_plant = plant;
    leg->end = (struct bezier_point){pose.x, pose.y};
    leg->end_error = strict_hypot(pose.x - leg->target.x, pose.y - leg->target.y);
    leg->end_speed = run->skid.world.plant.state.forward;
}

/** How near the robot comes to the targets before and after it. */
static void note_passing(struct skid_mission *run)
{
    const struct clearance_pose pose = run->robot.pose(run->robot.self);
    const size_t ended = pilot_of(run)->legs_ended;
    struct mission *mission = run->mission;

    for (size_t i = ended > 0 ? ended - 1 : 0; i <= ended && i < mission->leg_count; i++) {
        struct mission_leg *leg = &mission->legs[i];
        const double distance = strict_hypot(pose.x - leg->target.x, pose.y - leg->target.y);

        leg->passed = fmin(leg->passed, distance);
    }
}

/* ---- The drive ---- */

static void log_row(const struct skid_mission *run)
{
    const struct skid_plant *plant = &run->skid.world.plant;
    const struct clearance_pose pose = run->robot.pose(run->robot.self);
    const struct jp_path_set_point *reference = &run->reference;

    mission_view_row(&run->view, run->scenario,
                     &(struct mission_row){
                         .time = (double)run->ticks / run->robot.rate_hz,
                         .position = {pose.x, pose.y},
                         .reference = {reference->pose.position.x / Q16_ONE, reference->pose.position.y / Q16_ONE},
                         .heading = pose.heading,
                         .speed = plant->state.forward,
                         .turn_rate = plant->state.turn_rate,
                         .reference_speed = reference->motion.speed / Q24_ONE,
                         .reference_turn_rate = reference->motion.turn_rate / Q24_ONE,
                         .voltage_left = run->telemetry.voltages.left / Q16_ONE,
                         .voltage_right = run->telemetry.voltages.right / Q16_ONE,
                         .current_left = plant->attitude.current[SKID_LEFT],
                         .current_right = plant->attitude.current[SKID_RIGHT],
                         .energy = metered_energy(run) - run->start_energy,
                         .leg = run->skid.pilot.legs_ended,
                     });
}

/** What goes on besides the robot and its pilot. */
static void keep_books(struct skid_mission *run)
{
    const uint64_t row_ticks = (uint64_t)fmax(run->robot.rate_hz / MISSION_LOG_RATE, 1);

    if (run->ticks % JP_TICKS_PER_PATH_POINT == 0) {
        (void)jp_path_drive_advance(&run->follower, &run->reference);
    }
    (void)jp_skid_robot_telemetry(&run->skid.controller, &run->telemetry);
    note_passing(run);
    if (mission_view_wants_rows(&run->view) && run->ticks % row_ticks == 0) {
        log_row(run);
    }
    if (run->view.watch != NULL) {
        const struct clearance_pose pose = run->robot.pose(run->robot.self);

        run->view.watch(run->view.context, (struct bezier_point){pose.x, pose.y}, pose.heading);
    }
    if (run->view.progress != NULL) {
        progress_show(run->view.progress, pilot_of(run)->legs_ended, run->mission->leg_count);
    }
}

static bool cannot_go_on(const struct skid_mission *run)
{
    char faults[FAULTS_NAME_SIZE];

    faults_name(run->telemetry.faults, faults);
    return mission_cannot(run->mission,
                          "leg %u: the robot stopped with the fault: %s; correct its sensors or lower limits in the "
                          "robot file",
                          run->skid.pilot.legs_ended + 1U, faults);
}

/** A tick, and a slice of the pilot's work; false when the robot cannot go on. */
static bool pass_tick(struct skid_mission *run)
{
    struct jp_skid_pilot *pilot = pilot_of(run);
    const uint16_t ended = pilot->legs_ended;
    const uint16_t begun = pilot->legs_begun;

    keep_books(run);
    run->robot.tick(run->robot.self);
    run->ticks++;
    if (jp_skid_pilot_work(pilot) != JP_OK) {
        return cannot_go_on(run);
    }
    if (pilot->legs_ended > ended) {
        note_result(run);
    }
    if (pilot->legs_begun > begun) {
        note_plan(run);
    }
    return true;
}

static bool drive(struct skid_mission *run)
{
    note_plan(run);
    while (pilot_of(run)->phase != JP_SKID_PILOT_RESTING) {
        if (!pass_tick(run)) {
            return false;
        }
    }
    keep_books(run);
    return true;
}

bool mission_skid_run(struct mission *mission, enum mission_strategy strategy, const struct scenario *scenario,
                      const struct mission *driven, const struct mission_view *view)
{
    struct skid_mission run = {.mission = mission, .scenario = scenario};

    *mission = (struct mission){.strategy = strategy};
    if (view != NULL) {
        run.view = *view;
    }
    if (run.view.log != NULL) {
        mission_log_header(run.view.log);
    }
    if (!start(&run, driven)) {
        return false;
    }
    const double begin = mission_wall_clock();
    const bool done = drive(&run);

    mission->wall_seconds = mission_wall_clock() - begin;
    if (run.view.progress != NULL) {
        progress_end();
    }
    if (done) {
        mission->ticks = run.ticks;
        mission->saturated_ticks = run.telemetry.saturated_ticks;
        mission->learned = run.skid.pilot.learner.state;
        mission_sum_up(mission);
    }
    return done;
}
