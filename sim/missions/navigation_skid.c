#include "sim/missions/navigation_skid.h"

#include <math.h>

#include "sim/base/error.h"
#include "sim/base/strict_math.h"
#include "sim/skid_steer/skid_hal_sim.h"

#define Q16 65536.0
#define Q24 16777216.0
#define Q32 4294967296.0

/** Until the first frame was read, and it stands before it is told where to go, s. */
#define WAKING_SECONDS 0.1
#define STAND_SECONDS  3.0

static void tick(void *self)
{
    struct navigation_skid *skid = self;

    jp_hal_skid_tick(&skid->hal, &skid->controller, &skid->written);
    skid_world_step(&skid->world);
}

static struct clearance_pose pose(const void *self)
{
    const struct navigation_skid *skid = self;
    const struct planar_pose pose = skid_plant_pose(&skid->world.plant);

    return (struct clearance_pose){pose.x, pose.y, pose.heading};
}

/** Out of the battery's cells: of braking, the robot itself meters what its bridges burn as won. */
static double joules(const void *self)
{
    const struct navigation_skid *skid = self;

    return skid->world.plant.state.ledger.battery;
}

static double given(const void *self)
{
    const struct navigation_skid *skid = self;

    return skid->world.plant.state.ledger.battery - skid->world.plant.state.ledger.supply;
}

static void feed(void *self, const struct cell_constants *cell, const struct cell_wiring *wiring,
                 const struct cell_condition *condition)
{
    struct navigation_skid *skid = self;

    skid_plant_feed(&skid->world.plant, cell, wiring, condition);
}

static jp_energy metered(const void *self)
{
    const struct navigation_skid *skid = self;

    return jp_skid_robot_meter(&skid->controller)->battery;
}

static jp_q16 bus_voltage(const void *self)
{
    const struct navigation_skid *skid = self;
    const struct jp_sensors *frame = jp_skid_robot_good_frame(&skid->controller);

    return frame != NULL ? frame->bus_voltage : 0;
}

/** The root of the larger eigenvalue of the covariance. */
static double deviation(const void *self)
{
    const struct navigation_skid *skid = self;
    struct jp_skid_estimate estimate;

    jp_skid_odometry_estimate(jp_skid_robot_odometry(&skid->controller),
                              &jp_skid_robot_configuration(&skid->controller)->odometry, &estimate);
    const double mean = ((double)estimate.xx + (double)estimate.yy) / 2;
    const double half = ((double)estimate.xx - (double)estimate.yy) / 2;

    return sqrt((mean + strict_hypot(half, (double)estimate.xy)) / Q32);
}

static void stand(struct navigation_skid *skid, double seconds)
{
    for (int i = 0; i < (int)(seconds * skid->world.plant.model.control.rate_hz); i++) {
        tick(skid);
    }
}

static jp_q24 q24(double value)
{
    return (jp_q24)lround(value * Q24);
}

/** Of a robot that drives by itself: as fast as its lattice, and as its controller can. */
static struct jp_path_limits limits_of(const struct skid_robot_entry *entry, const struct skid_steer_model *model)
{
    return (struct jp_path_limits){.speed = q24(model->lattice.speed_m_s),
                                   .turn_rate = q24(model->lattice.turn_rate_rad_s),
                                   .side_speed = entry->config->limits.speed,
                                   .width = q24(model->body.width_m),
                                   .acceleration = entry->config->limits.acceleration,
                                   .turn_acceleration = entry->config->limits.turn_acceleration};
}

static bool prepare(struct navigation_skid *skid, const struct skid_robot_entry *entry,
                    const struct skid_steer_model *model, bool tells_grounds_apart, struct navigation_robot *robot)
{
    const struct jp_skid_pilot_config config = {.model = entry->energy,
                                                .learning = entry->learning,
                                                .limits = limits_of(entry, model),
                                                .corner = isnan(robot->margin_m) ? 0 : q24(robot->margin_m),
                                                .pieces = skid->pieces,
                                                .places = sizeof skid->pieces / sizeof skid->pieces[0],
                                                .grounds = tells_grounds_apart ? &skid->grounds : NULL,
                                                .ground_learning = &jp_ground_learning};
    const char *field = "";

    if (jp_skid_robot_init(&skid->controller, entry->config, &field) != JP_OK ||
        jp_skid_pilot_init(&skid->pilot, &config, &skid->controller, &field) != JP_OK) {
        error_line("%s: the configuration is refused: %s; run make skid-robot ROBOT=%s", entry->name, field,
                   entry->name);
        return false;
    }
    return jp_skid_vehicle_init(&skid->vehicle, &skid->pilot, &robot->vehicle) == JP_OK;
}

struct clearance_robot navigation_skid_body(const struct skid_steer_model *model)
{
    return (struct clearance_robot){model->body.length_m + 2 * fabs(model->body.middle_ahead_m),
                                    model->body.overall_width_m, 0};
}

struct skid_surface navigation_skid_surface(const struct jp_terrain *map, const struct map_ground *grounds,
                                            struct skid_classes *classes)
{
    classes->map = map;
    for (unsigned k = 0; k < JP_GROUND_CLASSES; k++) {
        classes->grip[k] = (struct skid_grip){grounds[k].rolling, grounds[k].friction};
    }
    return skid_surface_map(classes);
}

static double cruise_power(const struct skid_robot_entry *entry)
{
    const struct jp_motion motion = {.speed = entry->limits->speed};
    jp_q16 power = 0;

    (void)jp_skid_energy_power(entry->energy, &motion, 0, &power);
    return power / Q16;
}

static void lack(void *self, jp_q16 lacking)
{
    struct navigation_skid *skid = self;

    (void)jp_skid_pilot_lack_voltage(&skid->pilot, lacking);
}

bool navigation_skid_init(struct navigation_skid *skid, const struct skid_robot_entry *entry,
                          const struct skid_steer_model *model, const struct jp_terrain *terrain,
                          const struct skid_surface *surface, const struct clearance_pose *start, uint64_t seed,
                          struct navigation_robot *robot)
{
    static const struct jp_gyro_scale nothing;

    return navigation_skid_init_again(skid, entry, model, terrain, surface, start, seed, &nothing, robot);
}

struct jp_gyro_scale navigation_skid_gyro_scale(const struct navigation_skid *skid)
{
    struct jp_gyro_scale scale;

    jp_skid_odometry_scale(jp_skid_robot_odometry(&skid->controller),
                           &jp_skid_robot_configuration(&skid->controller)->odometry, &scale);
    return scale;
}

bool navigation_skid_init_again(struct navigation_skid *skid, const struct skid_robot_entry *entry,
                                const struct skid_steer_model *model, const struct jp_terrain *terrain,
                                const struct skid_surface *surface, const struct clearance_pose *start, uint64_t seed,
                                const struct jp_gyro_scale *scale, struct navigation_robot *robot)
{
    const struct planar_pose place = {start->x, start->y, start->heading};
    const struct skid_ground level = {NULL, NULL};
    const struct skid_ground ground = terrain->config.has_elevation ? skid_ground_map(terrain) : level;

    *robot = (struct navigation_robot){.name = entry->name,
                                       .rate_hz = model->control.rate_hz,
                                       .body = navigation_skid_body(model),
                                       .margin_m = model->navigation.margin_m / 2,
                                       .unit_exponent = entry->energy->unit_exponent,
                                       .supply = {.battery = entry->battery,
                                                  .standing_w = model->electronics.power_w,
                                                  .voltage_min_v = entry->config->monitor.voltage_min / Q16,
                                                  .feed = feed,
                                                  .pack = &skid->world.plant.pack,
                                                  .metered = metered,
                                                  .bus_voltage = bus_voltage,
                                                  .cruise_w = cruise_power(entry),
                                                  .lack = lack},
                                       .self = skid,
                                       .tick = tick,
                                       .pose = pose,
                                       .joules = joules,
                                       .given = given,
                                       .deviation = deviation};
    *skid = (struct navigation_skid){.written = JP_OK};
    skid_world_init(&skid->world, model, &ground, &place, seed);
    if (surface != NULL) {
        skid_plant_lay(&skid->world.plant, surface);
    }
    skid->hal = skid_hal_sim(&skid->world);
    if (!prepare(skid, entry, model, surface != NULL, robot)) {
        return false;
    }
    jp_skid_robot_know_gyro_scale(&skid->controller, scale);
    stand(skid, WAKING_SECONDS);
    if (jp_skid_robot_enable(&skid->controller) != JP_OK) {
        error_line("--start: the ground there is too steep for %s; give another place", entry->name);
        return false;
    }
    stand(skid, STAND_SECONDS);
    return true;
}
