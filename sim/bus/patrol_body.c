#include "sim/bus/patrol_body.h"

#include <math.h>

#include "sim/base/digital.h"
#include "sim/scenes/patrol_scene.h"

/* The sensor of the current, A. */
#define CURRENT_STEP 0.005

#define TICK (1.0 / FOUR_WHEEL_RATE_HZ)

bool patrol_body_init(struct patrol_body *body, const struct four_wheel_file *robot, const struct patrol_scene *scene,
                      uint64_t seed)
{
    const struct planar_pose start = {(double)scene->start.x, (double)scene->start.y, (double)scene->start.heading};

    *body = (struct patrol_body){.robot = robot};
    if (!patrol_scene_enter(scene, robot, &body->world)) {
        return false;
    }
    four_wheel_plant_init(&body->plant, robot, &start);
    body->laser = laser_config_of(robot->laser.beams, robot->laser.field_deg * M_PI / 180, robot->laser.range_m,
                                  robot->laser.noise_m);
    random_init(&body->random, seed);
    body->scan_next = JP_SCAN_FRAMES((unsigned)robot->laser.beams);
    body->current = robot->electronics.power_w / robot->electronics.voltage_v;
    return true;
}

void patrol_body_free(struct patrol_body *body)
{
    patrol_world_free(&body->world);
}

/* Out. */

static uint32_t count_of(const struct patrol_body *body, int wheel)
{
    const double turns = body->plant.state.wheels[wheel].roll / (2 * M_PI);

    return (uint32_t)(int64_t)floor(turns * body->robot->encoder.wheel_counts_per_turn);
}

void patrol_body_read(const struct patrol_body *body, struct jp_four_wheel_sensors *sensors)
{
    *sensors = (struct jp_four_wheel_sensors){.bus_voltage = digital_fixed(body->plant.bus_voltage, JP_Q16_ONE),
                                              .bus_current = digital_fixed(body->current, JP_Q16_ONE)};
    for (int i = 0; i < JP_WHEELS; i++) {
        sensors->count[i] = count_of(body, i);
        sensors->angle[i] = body->plant.measured.angle[i];
    }
}

static void send_sample(struct patrol_body *body, const struct jp_can_port *port)
{
    struct jp_four_wheel_sensors sensors;
    struct jp_can_frame frames[JP_WHEEL_SAMPLE_FRAMES];

    patrol_body_read(body, &sensors);
    jp_wheel_sample_pack(frames, &body->sample_counter, &sensors);
    for (unsigned i = 0; i < JP_WHEEL_SAMPLE_FRAMES; i++) {
        (void)port->send(port->context, &frames[i]);
    }
}

/* What is too far for the signal was not seen. */
static uint16_t raw_of(float range)
{
    const double raw = rint((double)range * JP_SCAN_RANGE_ONE);

    if (range < 0) {
        return JP_SCAN_RANGE_DROPPED;
    }
    return raw < JP_SCAN_RANGE_DROPPED ? (uint16_t)raw : JP_SCAN_RANGE_NOTHING;
}

static void take_scan(struct patrol_body *body)
{
    const struct planar_pose mount = {body->robot->laser.x_m, body->robot->laser.y_m, 0};
    const struct planar_pose scanner = planar_compose(&body->plant.state.pose, &mount);

    laser_take(&body->laser, &body->world.map, body->world.shapes, body->world.shape_count, &scanner, &body->random,
               &body->scan);
    for (int i = 0; i < body->scan.beams; i++) {
        body->ranges[i] = raw_of(body->scan.ranges[i]);
    }
    body->scan_next = 0;
}

static void send_scan(struct patrol_body *body, const struct jp_can_port *port)
{
    const uint16_t beams = (uint16_t)body->scan.beams;
    struct jp_can_frame frame;

    for (unsigned sent = 0; sent < PATROL_BODY_SCAN_FRAMES && body->scan_next < JP_SCAN_FRAMES(beams); sent++) {
        jp_scan_pack(&body->scan_counters, body->ranges, beams, body->scan_next, &frame);
        body->scan_next++;
        (void)port->send(port->context, &frame);
    }
}

void patrol_body_sense(struct patrol_body *body, const struct jp_can_port *port)
{
    send_sample(body, port);
    if (body->tick % (uint64_t)(FOUR_WHEEL_RATE_HZ / body->robot->laser.rate_hz) == 0) {
        take_scan(body);
    }
    send_scan(body, port);
    if (body->battery != NULL) {
        patrol_battery_tell(body->battery, body->tick, port);
    }
}

/* In. */

enum jp_e2e_result patrol_body_accept(struct patrol_body *body, const struct jp_can_frame *frame, bool *is_whole)
{
    return jp_wheel_targets_accept(&body->targets, frame, &body->actuation, is_whole);
}

/* Physics. */

/** Drives that are off are braked, and keep their angles. */
static struct jp_wheels set_points(const struct patrol_body *body)
{
    struct jp_wheels wheels = body->actuation.wheels;

    for (int i = 0; i < JP_WHEELS && body->actuation.enabled == 0; i++) {
        wheels.angle[i] = body->plant.measured.angle[i];
        wheels.speed[i] = 0;
    }
    return wheels;
}

void patrol_body_step(struct patrol_body *body)
{
    const struct jp_wheels wheels = set_points(body);
    double amperes;

    four_wheel_plant_tick(&body->plant, &wheels);
    patrol_world_step(&body->world, &body->plant.state.pose, body->is_world_moving ? TICK : 0);
    amperes = (body->plant.ledger.battery - body->last_battery) * FOUR_WHEEL_RATE_HZ / body->plant.bus_voltage;
    if (body->battery != NULL) {
        patrol_battery_step(body->battery, &body->plant.state, body->plant.ledger.battery - body->last_battery, TICK);
    }
    body->last_battery = body->plant.ledger.battery;
    body->current = rint(amperes / CURRENT_STEP) * CURRENT_STEP;
    body->tick++;
}
