#include "sim/balancer/world.h"

#include <math.h>

#include "sim/base/digital.h"

void world_init(struct world *world, const struct robot_file *robot, uint64_t seed)
{
    *world = (struct world){.robot = *robot, .bus_voltage = robot->supply.voltage_v};
    plant_init(&world->plant, robot);
    world->instruments.robot = &world->robot;
    random_init(&world->random, seed);
}

static bool counts_alike(const struct robot_file *a, const struct robot_file *b)
{
    return a->control.rate_hz == b->control.rate_hz && a->encoder.counts_per_turn == b->encoder.counts_per_turn &&
           a->wheel.radius_m == b->wheel.radius_m && a->body.width_m == b->body.width_m;
}

bool world_change_robot(struct world *world, const struct robot_file *robot)
{
    if (!counts_alike(&world->robot, robot)) {
        return false;
    }
    world->robot = *robot;
    plant_change(&world->plant, robot);
    return true;
}

double world_tick_seconds(const struct world *world)
{
    return 1.0 / world->robot.control.rate_hz;
}

void world_feed(struct world *world, const struct cell_constants *cell, const struct cell_wiring *wiring,
                const struct cell_condition *condition)
{
    cell_pack_init(&world->pack, cell, wiring, condition);
    world->bus_voltage = cell_pack_source(&world->pack).open_v;
    world->has_pack = true;
}

static struct cell_source source_of(const struct world *world)
{
    return world->has_pack ? cell_pack_source(&world->pack)
                           : (struct cell_source){world->robot.supply.voltage_v, world->robot.supply.resistance_ohm};
}

/* Bus voltage with both motors' and the electronics' current: V = V0 − R (Σ d·i + Ps/V0), i = (d·V − e)/Rm. */
static double sagged_voltage(const struct world *world, double duty_left, double duty_right)
{
    const struct cell_source supply = source_of(world);
    const double open = supply.open_v;
    const double resistance = supply.resistance_ohm;
    if (resistance == 0.0) {
        return open;
    }
    const struct plant *plant = &world->plant;
    const double ratio = resistance / plant->constants.resistance;
    const double back_emf = plant->constants.volts_per_rate *
                            (duty_left * plant_motor_rate_left(plant) + duty_right * plant_motor_rate_right(plant));
    const double source = open - resistance * world->robot.electronics.power_w / open + ratio * back_emf;
    return source / (1.0 + ratio * (duty_left * duty_left + duty_right * duty_right));
}

/* The cells give what the robot has taken in a tick. */
static void draw(struct world *world, double electrical)
{
    const double seconds = world_tick_seconds(world);
    const double watts = electrical / seconds + world->robot.electronics.power_w;

    cell_pack_step(&world->pack, watts / world->bus_voltage, seconds);
}

void world_step(struct world *world)
{
    const double electrical = world->plant.ledger.electrical;
    const bool driven = world->actuation.enabled != 0;
    const bool pushed = world->tick < world->push_until;
    const double duty_left = driven ? digital_duty(world->actuation.duty_left, world->robot.pwm.bits) : 0.0;
    const double duty_right = driven ? digital_duty(world->actuation.duty_right, world->robot.pwm.bits) : 0.0;

    world->bus_voltage = sagged_voltage(world, duty_left, duty_right);
    world->input = (struct plant_input){.voltage_left = duty_left * world->bus_voltage,
                                        .voltage_right = duty_right * world->bus_voltage,
                                        .driven = driven,
                                        .push_n = pushed ? world->push_n : 0.0,
                                        .yaw_torque_nm = pushed ? world->yaw_torque_nm : 0.0};
    plant_step(&world->plant, &world->input, world_tick_seconds(world));
    if (world->has_pack) {
        draw(world, world->plant.ledger.electrical - electrical);
    }
    world->tick++;
}

static bool is_failing(const struct world *world, enum world_channel channel)
{
    return world_faults_fail(&world->faults, channel, world->tick);
}

bool world_read(struct world *world, struct jp_sensors *sensors)
{
    if (is_failing(world, WORLD_HAL_READ)) {
        return false;
    }
    instruments_read(&world->instruments, &world->plant, &world->input, world->bus_voltage, &world->random, sensors);
    world_faults_apply(&world->faults, world->tick, sensors);
    return true;
}

bool world_write(struct world *world, const struct jp_actuation *actuation)
{
    if (is_failing(world, WORLD_HAL_WRITE)) {
        world->actuation = (struct jp_actuation){0};
        return false;
    }
    world->actuation = *actuation;
    return true;
}

void world_push(struct world *world, double force_n, double yaw_torque_nm, uint64_t ticks)
{
    world->push_n = force_n;
    world->yaw_torque_nm = yaw_torque_nm;
    world->push_until = world->tick + ticks;
}

bool world_add_fault(struct world *world, const struct world_fault *fault)
{
    return world_faults_add(&world->faults, fault);
}
