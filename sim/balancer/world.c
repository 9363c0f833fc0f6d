#include "sim/balancer/world.h"

#include <math.h>
#include <string.h>

#include "sim/base/digital.h"

/* Offset of each channel; all are 32 bits wide. */
static const size_t channel_offsets[] = {
    [WORLD_ENCODER_LEFT] = offsetof(struct jp_sensors, encoder_left),
    [WORLD_ENCODER_RIGHT] = offsetof(struct jp_sensors, encoder_right),
    [WORLD_PITCH_RATE] = offsetof(struct jp_sensors, pitch_rate),
    [WORLD_YAW_RATE] = offsetof(struct jp_sensors, yaw_rate),
    [WORLD_ACCEL_X] = offsetof(struct jp_sensors, accel_x),
    [WORLD_ACCEL_Z] = offsetof(struct jp_sensors, accel_z),
    [WORLD_CURRENT_LEFT] = offsetof(struct jp_sensors, current_left),
    [WORLD_CURRENT_RIGHT] = offsetof(struct jp_sensors, current_right),
    [WORLD_BUS_VOLTAGE] = offsetof(struct jp_sensors, bus_voltage),
};

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

/* Bus voltage with both motors' and the electronics' current: V = V0 − R (Σ d·i + Ps/V0), i = (d·V − e)/Rm. */
static double sagged_voltage(const struct world *world, double duty_left, double duty_right)
{
    const double open = world->robot.supply.voltage_v;
    const double resistance = world->robot.supply.resistance_ohm;
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

void world_step(struct world *world)
{
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
    world->tick++;
}

static bool is_active(const struct world_fault *fault, uint64_t tick)
{
    return tick >= fault->from && (fault->until == 0 || tick < fault->until);
}

static bool is_failing(const struct world *world, enum world_channel channel)
{
    for (size_t i = 0; i < world->fault_count; i++) {
        if (world->faults[i].channel == channel && is_active(&world->faults[i], world->tick)) {
            return true;
        }
    }
    return false;
}

static uint32_t faulty_value(const struct world_fault *fault, uint32_t measured, uint32_t last)
{
    switch (fault->kind) {
    case WORLD_FROZEN:
        return last;
    case WORLD_STUCK:
        return (uint32_t)fault->value;
    case WORLD_SCALED:
        return (uint32_t)jp_multiply_shift((int32_t)measured, fault->value, 16);
    default:
        break;
    }
    if (fault->channel == WORLD_ENCODER_LEFT || fault->channel == WORLD_ENCODER_RIGHT) {
        return measured + (uint32_t)fault->value;
    }
    return (uint32_t)jp_saturate32((int64_t)(int32_t)measured + fault->value);
}

static void apply_faults(struct world *world, const struct jp_sensors *last, struct jp_sensors *sensors)
{
    for (size_t i = 0; i < world->fault_count; i++) {
        const struct world_fault *fault = &world->faults[i];
        if (fault->channel > WORLD_BUS_VOLTAGE || !is_active(fault, world->tick)) {
            continue;
        }
        const size_t offset = channel_offsets[fault->channel];
        uint32_t value;
        uint32_t last_value;
        memcpy(&value, (const char *)sensors + offset, sizeof value);
        memcpy(&last_value, (const char *)last + offset, sizeof last_value);
        value = faulty_value(fault, value, last_value);
        memcpy((char *)sensors + offset, &value, sizeof value);
    }
}

bool world_read(struct world *world, struct jp_sensors *sensors)
{
    if (is_failing(world, WORLD_HAL_READ)) {
        return false;
    }
    instruments_read(&world->instruments, &world->plant, &world->input, world->bus_voltage, &world->random, sensors);
    const struct jp_sensors last = world->last_read;
    apply_faults(world, &last, sensors);
    world->last_read = *sensors;
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
    if (world->fault_count == WORLD_FAULTS_MAX) {
        return false;
    }
    world->faults[world->fault_count++] = *fault;
    return true;
}
