/* The balancer of the page: one robot in its world, driven by its pilot through a list of waypoints, pushed, and asked
 * what a route takes at other speeds. Exactly as jp-mission drives it, tick by tick. */
#include <joulepath/pilot.h>
#include <math.h>
#include <string.h>

#include "sim/balancer/energy_unit.h"
#include "sim/balancer/fault_names.h"
#include "sim/balancer/rig.h"
#include "sim/base/fingerprint.h"
#include "sim/base/strict_math.h"
#include "sim/missions/cruise_plan.h"
#include "sim/missions/front.h"
#include "sim/page/page_export.h"
#include "sim/page/page_robots.h"

#define Q16_ONE  65536.0
#define Q24_ONE  16777216.0
#define JOULE    4294967296.0
#define TURN_Q24 (2 * M_PI / Q24_ONE)
#define ANGLE    (2 * M_PI / 4294967296.0)

/* An energy of which nothing is known yet. */
#define UNKNOWN ((double)NAN)

#define VIEW(X)                                                                                                        \
    X(time_s)                                                                                                          \
    X(x_m)                                                                                                             \
    X(y_m)                                                                                                             \
    X(heading_rad)                                                                                                     \
    X(pitch_rad)                                                                                                       \
    X(wheel_rad)                                                                                                       \
    X(speed_m_s)                                                                                                       \
    X(turn_rate_rad_s)                                                                                                 \
    X(believed_x_m)                                                                                                    \
    X(believed_y_m)                                                                                                    \
    X(voltage_left_v)                                                                                                  \
    X(voltage_right_v)                                                                                                 \
    X(push_n)                                                                                                          \
    X(has_fallen)                                                                                                      \
    X(faults)                                                                                                          \
    X(is_planning)                                                                                                     \
    X(is_driving)                                                                                                      \
    X(status)                                                                                                          \
    X(leg)                                                                                                             \
    X(leg_count)                                                                                                       \
    X(forecast_j)                                                                                                      \
    X(deviation_j)                                                                                                     \
    X(driven_j)                                                                                                        \
    X(driven_s)                                                                                                        \
    X(drawn_j)                                                                                                         \
    X(capacity_j)                                                                                                      \
    X(legs_learned)                                                                                                    \
    X(radius_m)                                                                                                        \
    X(width_m)                                                                                                         \
    X(centre_height_m)                                                                                                 \
    X(mass_kg)                                                                                                         \
    X(speed_limit_m_s)                                                                                                 \
    X(ticks)                                                                                                           \
    X(digest_low)                                                                                                      \
    X(digest_high)

enum { VIEW(PAGE_INDEX) VIEW_COUNT };

struct leg {
    double planned_j;
    double driven_j;
    double seconds;
};

static struct {
    const struct robot_file *file;
    const struct robot_entry *entry;
    const struct jp_energy_model *model;
    struct rig rig;
    struct jp_pilot pilot;
    enum jp_status status; /* of the pilot */
    struct jp_point targets[2][BEZIER_WAYPOINTS_MAX];
    unsigned targets_used; /* of the two, by the pilot */
    size_t count;
    struct jp_forecast forecast;
    bool has_forecast;
    bool has_begun;           /* the route */
    uint16_t segments_before; /* of the route before, which are driven to their end first */
    size_t leg;
    struct leg legs[BEZIER_WAYPOINTS_MAX];
    uint64_t leg_tick;
    jp_energy leg_energy;
    struct cruise_plan cruise; /* of the front */
    struct cruise_plan within; /* that is driven, within a time */
    struct scenario scenario;
    struct front front;
    double front_points[FRONT_FORECASTS][3];
    double view[VIEW_COUNT];
} page;

static struct jp_telemetry telemetry_now(void)
{
    struct jp_telemetry telemetry;

    jp_robot_telemetry(&page.rig.robot, &telemetry);
    return telemetry;
}

static double joules_between(jp_energy begin, jp_energy end)
{
    return (double)(end - begin) / JOULE;
}

static double seconds_of(uint64_t ticks)
{
    return (double)ticks * world_tick_seconds(&page.rig.world);
}

/* ---- Set up ---- */

static bool prepare_pilot(void)
{
    const struct jp_pilot_config config = {
        .model = page.model, .learning = page.entry->learning_battery, .meter = JP_PILOT_BATTERY};
    const char *field = "";

    return jp_pilot_init(&page.pilot, &config, &page.rig.robot, &field) == JP_OK;
}

/** Number of robots to choose from. */
PAGE_EXPORT(balancer_robots) unsigned balancer_robots(void)
{
    return (unsigned)page_balancer_count;
}

PAGE_EXPORT(balancer_robot_name) const char *balancer_robot_name(unsigned robot)
{
    return page_balancers[robot]->name;
}

/** Upright at the origin, looking along x; it balances. The noise of its sensors is of the seed. */
PAGE_EXPORT(balancer_reset) unsigned balancer_reset(unsigned robot, double seed)
{
    memset(&page, 0, sizeof page);
    page.file = page_balancers[robot];
    page.entry = rig_find_robot(page.file->name);
    page.model = page.entry == NULL ? NULL : rig_energy_model(page.entry, ENERGY_BATTERY);
    if (page.model == NULL || !rig_init(&page.rig, page.entry, page.file, (uint64_t)seed) || !prepare_pilot()) {
        return 0;
    }
    rig_release(&page.rig, 0);
    return 1;
}

/* ---- Routes ---- */

/** One more waypoint of the next route, m; false: there are too many. */
PAGE_EXPORT(balancer_add) unsigned balancer_add(double x, double y)
{
    if (page.scenario.waypoint_count >= BEZIER_WAYPOINTS_MAX - 1) {
        return 0;
    }
    page.scenario.waypoints[page.scenario.waypoint_count++] = (struct bezier_point){x, y};
    return 1;
}

static void begin_route(void)
{
    page.status = JP_OK;
    page.has_forecast = false;
    page.has_begun = false;
    page.leg = 0;
    memset(page.legs, 0, sizeof page.legs);
    for (size_t i = 0; i < page.count; i++) {
        page.legs[i].planned_j = UNKNOWN;
    }
}

/* Driven, or waiting to be. */
static uint16_t segments_in_hand(void)
{
    return (uint16_t)(telemetry_now().segment + (jp_robot_has_next(&page.rig.robot) ? 1 : 0));
}

/* Plans while the robot stands, so that no time passes, as jp-mission does. */
static void plan_whole(void)
{
    while (page.pilot.targets_planned == 0 && page.status == JP_OK) {
        page.status = jp_pilot_work(&page.pilot);
    }
    page.has_forecast = jp_pilot_answer(&page.pilot, &page.forecast) == JP_OK;
}

/** Follows the waypoints that were added, to a stand at the last of them. Plans at once if the robot stands, else as it
 *  drives on. A status of the library. */
PAGE_EXPORT(balancer_follow) int balancer_follow(void)
{
    const unsigned other = 1 - page.targets_used;
    const bool stands = page.pilot.phase == JP_PILOT_RESTING;
    const size_t count = page.scenario.waypoint_count;

    for (size_t i = 0; i < count; i++) {
        page.targets[other][i] = (struct jp_point){(jp_q16)lround(page.scenario.waypoints[i].x * Q16_ONE),
                                                   (jp_q16)lround(page.scenario.waypoints[i].y * Q16_ONE)};
    }
    page.scenario.waypoint_count = 0;

    const struct jp_pilot_route route = {
        .targets = page.targets[other], .count = (uint16_t)count, .end = JP_PILOT_STAND};
    const enum jp_status status = jp_pilot_follow(&page.pilot, &route);

    if (status == JP_OK) {
        page.targets_used = other;
        page.count = count;
        begin_route();
        page.segments_before = stands ? 0 : segments_in_hand();
        if (stands) {
            plan_whole();
        }
    }
    return (int)(status == JP_OK ? page.status : status);
}

/** Brakes to a stand and forgets the route. */
PAGE_EXPORT(balancer_stop) void balancer_stop(void)
{
    jp_pilot_stop(&page.pilot);
    (void)jp_robot_stop(&page.rig.robot);
}

/** From now on a force forward at the centre of mass, N, for so many ticks. */
PAGE_EXPORT(balancer_push) void balancer_push(double newtons, unsigned ticks)
{
    world_push(&page.rig.world, newtons, 0, ticks);
}

/* ---- The front ---- */

/* The waypoints that were added, as the robot sees them from where it comes to a stand. */
static void see_waypoints(void)
{
    const struct jp_telemetry telemetry = telemetry_now();
    struct jp_point position;
    jp_angle heading = 0;

    jp_robot_predict_end(&page.rig.robot, &telemetry, &position, &heading);
    const double x = position.x / Q16_ONE;
    const double y = position.y / Q16_ONE;
    const double turned = (int32_t)heading / 4294967296.0 * 2 * M_PI;
    const double cosine = strict_cos(turned);
    const double sine = strict_sin(turned);

    for (size_t i = page.scenario.waypoint_count; i > 0; i--) {
        const struct bezier_point *at = &page.scenario.waypoints[i - 1];
        const double dx = at->x - x;
        const double dy = at->y - y;

        page.scenario.waypoints[i] = (struct bezier_point){dx * cosine + dy * sine, dy * cosine - dx * sine};
    }
    page.scenario.waypoints[0] = (struct bezier_point){0, 0};
    page.scenario.waypoint_count++;
    page.scenario.to_stand = true;
    page.scenario.energy = ENERGY_BATTERY;
}

static bool forecast_at(jp_q24 cruise, double point[3])
{
    const struct jp_budget_plan *forecast = &page.cruise.forecast;
    const bool is_planned =
        cruise_plan_at(&page.cruise, &page.scenario, page.entry->config, page.model, cruise) == JP_OK &&
        forecast->seconds < INT32_MAX && forecast->energy < INT32_MAX;

    if (is_planned) {
        point[0] = cruise / Q24_ONE;
        point[1] = forecast->seconds / Q16_ONE;
        point[2] = energy_unit_joules(page.model, forecast->energy);
    }
    return is_planned;
}

/** From a stand, the waypoints that were added within so many seconds, for the least energy, to a stand; as jp-mission
 *  does it. A status of the library; JP_ERR_INFEASIBLE: too little time, and balancer_within_needs() says how much it
 *  takes. */
PAGE_EXPORT(balancer_drive_within) int balancer_drive_within(double seconds)
{
    enum jp_status status = JP_ERR_STATE;

    see_waypoints();
    page.scenario.within_seconds = seconds;
    if (page.pilot.phase == JP_PILOT_RESTING && jp_robot_state_now(&page.rig.robot) == JP_ROBOT_BALANCING) {
        status = cruise_plan_within(&page.within, &page.scenario, page.entry->config, page.model);
    }
    if (status == JP_OK) {
        status = jp_robot_drive_trajectory(&page.rig.robot, &page.within.trajectory);
    }
    if (status == JP_OK) {
        page.count = page.scenario.waypoint_count - 1;
        page.segments_before = 0;
        begin_route();
    }
    page.scenario.waypoint_count = 0;
    return (int)status;
}

/** What the last balancer_drive_within() takes at least, s. */
PAGE_EXPORT(balancer_within_needs) double balancer_within_needs(void)
{
    return page.within.forecast.seconds / Q16_ONE;
}

/** What it is foretold to take, J: of the model alone, which says no interval. */
PAGE_EXPORT(balancer_within_forecast) double balancer_within_forecast(void)
{
    return energy_unit_joules(page.model, page.within.forecast.energy);
}

/** What the waypoints that were added take from here, at cruises from half of the cheapest up to the robot's limit: so
 *  many points. They are forgotten then. Of the built-in model, as jp-front. */
PAGE_EXPORT(balancer_front) unsigned balancer_front(void)
{
    const jp_q24 limit = page.entry->config->limits.speed;
    const jp_q24 cheapest = jp_cruise_speed(page.model);
    const jp_q24 low = (cheapest < limit ? cheapest : limit) / 2;
    unsigned count = 0;

    see_waypoints();
    for (int i = 0; i < FRONT_FORECASTS; i++) {
        count += forecast_at(low + (limit - low) / (FRONT_FORECASTS - 1) * i, page.front_points[count]);
    }
    page.scenario.waypoint_count = 0;
    return count;
}

/** Cruise in m/s, s and J of each point. */
PAGE_EXPORT(balancer_front_points) const double *balancer_front_points(void)
{
    return &page.front_points[0][0];
}

/* ---- Time ---- */

static void begin_leg(const struct jp_telemetry *telemetry)
{
    page.leg_tick = page.rig.world.tick;
    page.leg_energy = telemetry->energy_battery;
}

static void note_leg_now(const struct jp_telemetry *telemetry)
{
    struct leg *leg = &page.legs[page.leg];

    leg->driven_j = joules_between(page.leg_energy, telemetry->energy_battery);
    leg->seconds = seconds_of(page.rig.world.tick - page.leg_tick);
}

static void note_plan(void)
{
    const uint16_t planned = page.pilot.targets_planned;

    if (planned > 0 && planned <= page.count && isnan(page.legs[planned - 1].planned_j)) {
        page.legs[planned - 1].planned_j = energy_unit_joules(page.model, page.pilot.leg.energy);
    }
    if (!page.has_forecast) {
        page.has_forecast =
            page.pilot.phase == JP_PILOT_DRIVING && jp_pilot_answer(&page.pilot, &page.forecast) == JP_OK;
    }
}

/* In the tick that ends a leg, before its physics, as jp-mission. A route counts from its first tick. */
static void keep_books(void)
{
    const struct jp_telemetry telemetry = telemetry_now();

    if (telemetry.segments_ended < page.segments_before) {
        page.segments_before = telemetry.segment == 0 ? 0 : page.segments_before;
        return;
    }
    if (page.leg >= page.count) {
        return;
    }
    if (!page.has_begun) {
        page.has_begun = true;
        begin_leg(&telemetry);
    }
    note_leg_now(&telemetry);
    if (telemetry.segments_ended - page.segments_before > (int)page.leg) {
        page.leg++;
        begin_leg(&telemetry);
    }
}

static bool can_go_on(void)
{
    const enum jp_robot_state state = jp_robot_state_now(&page.rig.robot);

    return state != JP_ROBOT_FALLEN && state != JP_ROBOT_FAULT;
}

/** So many ticks; fewer when the robot falls. */
PAGE_EXPORT(balancer_run) unsigned balancer_run(unsigned ticks)
{
    unsigned done = 0;

    for (; done < ticks && !page.rig.world.plant.fallen; done++) {
        const enum jp_status status = jp_pilot_work(&page.pilot);

        if (status != JP_OK) {
            page.status = status;
        }
        note_plan();
        jp_hal_tick(&page.rig.hal, &page.rig.robot, &page.rig.written);
        if (can_go_on()) {
            keep_books();
        }
        world_step(&page.rig.world);
    }
    return done;
}

PAGE_EXPORT(balancer_ticks_a_second) unsigned balancer_ticks_a_second(void)
{
    return (unsigned)page.file->control.rate_hz;
}

/* ---- The view ---- */

/* Of the plant and of what it has spent: equal bits, equal fingerprints. */
static uint64_t digest(void)
{
    const struct plant *plant = &page.rig.world.plant;
    uint64_t fingerprint = FINGERPRINT_START;

    fingerprint_add(&fingerprint, &plant->state, sizeof plant->state);
    fingerprint_add(&fingerprint, &plant->ledger, sizeof plant->ledger);
    fingerprint_add(&fingerprint, &plant->x, sizeof plant->x);
    fingerprint_add(&fingerprint, &plant->y, sizeof plant->y);
    return fingerprint;
}

static void view_motion(const struct jp_telemetry *telemetry)
{
    const struct world *world = &page.rig.world;
    const struct plant *plant = &world->plant;

    page.view[VIEW_time_s] = seconds_of(world->tick);
    page.view[VIEW_x_m] = plant->x;
    page.view[VIEW_y_m] = plant->y;
    page.view[VIEW_heading_rad] = plant->state.yaw;
    page.view[VIEW_pitch_rad] = plant->state.pitch;
    page.view[VIEW_wheel_rad] = plant->state.wheel;
    page.view[VIEW_speed_m_s] = plant->state.wheel_rate * page.file->wheel.radius_m;
    page.view[VIEW_turn_rate_rad_s] = plant->state.yaw_rate;
    page.view[VIEW_believed_x_m] = telemetry->position.x / Q16_ONE;
    page.view[VIEW_believed_y_m] = telemetry->position.y / Q16_ONE;
    page.view[VIEW_voltage_left_v] = telemetry->voltages.left / Q16_ONE;
    page.view[VIEW_voltage_right_v] = telemetry->voltages.right / Q16_ONE;
    page.view[VIEW_push_n] = world->tick < world->push_until ? world->push_n : 0;
    page.view[VIEW_has_fallen] = plant->fallen;
    page.view[VIEW_faults] = telemetry->faults;
}

static void view_route(const struct jp_telemetry *telemetry)
{
    double joules = 0;
    double seconds = 0;

    for (size_t i = 0; i < page.count; i++) {
        joules += page.legs[i].driven_j;
        seconds += page.legs[i].seconds;
    }
    page.view[VIEW_is_planning] = page.pilot.phase == JP_PILOT_PLANNING;
    page.view[VIEW_is_driving] = page.pilot.phase == JP_PILOT_DRIVING || telemetry->state == JP_ROBOT_DRIVING;
    page.view[VIEW_status] = page.status;
    page.view[VIEW_leg] = (double)page.leg;
    page.view[VIEW_leg_count] = (double)page.count;
    page.view[VIEW_forecast_j] = page.has_forecast ? energy_unit_joules(page.model, page.forecast.energy) : UNKNOWN;
    page.view[VIEW_deviation_j] = page.has_forecast ? energy_unit_joules(page.model, page.forecast.deviation) : UNKNOWN;
    page.view[VIEW_driven_j] = joules;
    page.view[VIEW_driven_s] = seconds;
    page.view[VIEW_drawn_j] = (double)telemetry->energy_battery / JOULE;
    page.view[VIEW_capacity_j] = page.file->supply.capacity_wh * 3600;
    page.view[VIEW_legs_learned] = page.pilot.legs_learned_from;
}

static void view_robot(void)
{
    const uint64_t fingerprint = digest();

    page.view[VIEW_radius_m] = page.file->wheel.radius_m;
    page.view[VIEW_width_m] = page.file->body.width_m;
    page.view[VIEW_centre_height_m] = page.file->body.centre_height_m;
    page.view[VIEW_mass_kg] = page.file->body.mass_kg + 2 * page.file->wheel.mass_kg;
    page.view[VIEW_speed_limit_m_s] = page.file->limits.speed_m_s;
    page.view[VIEW_ticks] = (double)page.rig.world.tick;
    page.view[VIEW_digest_low] = (double)(fingerprint & 0xFFFFFFFFU);
    page.view[VIEW_digest_high] = (double)(fingerprint >> 32);
}

PAGE_EXPORT(balancer_view_names) const char *balancer_view_names(void)
{
    return VIEW(PAGE_NAME);
}

PAGE_EXPORT(balancer_view) const double *balancer_view(void)
{
    const struct jp_telemetry telemetry = telemetry_now();

    view_motion(&telemetry);
    view_route(&telemetry);
    view_robot();
    return page.view;
}

/** Planned and driven J and s of each leg of the route; not a number: not known yet. */
PAGE_EXPORT(balancer_legs) const double *balancer_legs(void)
{
    return &page.legs[0].planned_j;
}

/** What is wrong with the robot, for people. */
PAGE_EXPORT(balancer_faults) const char *balancer_faults(void)
{
    static char text[FAULTS_NAME_SIZE];

    faults_name(telemetry_now().faults, text);
    return text;
}
