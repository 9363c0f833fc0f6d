#include "sim/balancer/instruments.h"

#include <math.h>

#include "sim/base/digital.h"
#include "sim/base/strict_math.h"

static void read_encoders(const struct instruments *instruments, const struct plant *plant, struct jp_sensors *sensors)
{
    const double mean = plant->state.wheel - plant->state.pitch;
    const double difference = plant->constants.half_track * plant->state.yaw;
    const int counts = instruments->robot->encoder.counts_per_turn;
    sensors->encoder_left = digital_count(mean - difference, counts, instruments->encoder_start_left);
    sensors->encoder_right = digital_count(mean + difference, counts, instruments->encoder_start_right);
}

static jp_q24 gyro(const struct robot_file *robot, double rad_s, struct random *random)
{
    const double dps = rad_s * 180.0 / M_PI + robot->gyro.bias_dps;
    const double digital =
        digital_sense(dps, robot->gyro.noise_rms_dps, robot->gyro.step_dps, robot->gyro.full_scale_dps, random);
    return digital_fixed(digital / 360.0, JP_Q24_ONE);
}

static jp_q24 accelerometer(const struct robot_file *robot, double g, struct random *random)
{
    return digital_fixed(digital_sense(g, robot->accelerometer.noise_rms_g, robot->accelerometer.step_g,
                                       robot->accelerometer.full_scale_g, random),
                         JP_Q24_ONE);
}

static void read_inertial(const struct robot_file *robot, const struct plant *plant, const struct plant_input *input,
                          struct random *random, struct jp_sensors *sensors)
{
    const struct plant_state *s = &plant->state;
    const struct plant_acceleration acceleration = plant_acceleration(plant, input);
    const double height = robot->accelerometer.height_m;
    const struct strict_turn turn = strict_sin_cos(s->pitch);
    const double sine = turn.sine;
    const double cosine = turn.cosine;
    const double forward = plant->constants.wheel_radius * acceleration.wheel;
    const double yaw_square = s->yaw_rate * s->yaw_rate;
    const double tangential = height * (acceleration.pitch - yaw_square * sine * cosine);
    const double radial = -height * (s->pitch_rate * s->pitch_rate + yaw_square * sine * sine);

    sensors->pitch_rate = gyro(robot, s->pitch_rate, random);
    sensors->yaw_rate = gyro(robot, s->yaw_rate * cosine, random);
    sensors->accel_x = accelerometer(robot, (forward * cosine + tangential) / PLANT_GRAVITY - sine, random);
    sensors->accel_z = accelerometer(robot, (forward * sine + radial) / PLANT_GRAVITY + cosine, random);
}

static jp_q16 current(const struct robot_file *robot, double ampere, struct random *random)
{
    const double full_scale = robot->current_sense.full_scale_a;
    const double noisy = digital_sense(ampere, robot->current_sense.noise_rms_a, 0.0, 0.0, random);
    return digital_fixed(digital_convert(noisy, -full_scale, full_scale, robot->current_sense.bits), JP_Q16_ONE);
}

void instruments_read(const struct instruments *instruments, const struct plant *plant, const struct plant_input *input,
                      double bus_voltage, struct random *random, struct jp_sensors *sensors)
{
    const struct robot_file *robot = instruments->robot;
    read_encoders(instruments, plant, sensors);
    read_inertial(robot, plant, input, random, sensors);
    sensors->current_left = current(robot, plant_current_left(plant, input), random);
    sensors->current_right = current(robot, plant_current_right(plant, input), random);
    sensors->bus_voltage = digital_fixed(
        digital_convert(bus_voltage, 0.0, robot->bus_sense.full_scale_v, robot->bus_sense.bits), JP_Q16_ONE);
}
