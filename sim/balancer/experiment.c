#include "sim/balancer/experiment.h"

#include <math.h>
#include <stdlib.h>

#define RADIANS_PER_DEGREE 0.017453292519943295

static void draw_segment(struct experiment_segment *segment, const struct robot_file *file, struct random *random)
{
    double turn = file->limits.turn_deg * RADIANS_PER_DEGREE;

    segment->speed = random_uniform(random, 0, file->limits.speed_m_s);
    segment->turn_rate = random_uniform(random, -file->limits.turn_rate_rad_s, file->limits.turn_rate_rad_s);
    segment->turn = random_uniform(random, -turn, turn);
}

void experiment_draw(struct experiment *experiment, const struct robot_file *file, struct random *random)
{
    *experiment = (struct experiment){.end = JP_ROBOT_IDLE};
    draw_segment(&experiment->first, file, random);
    draw_segment(&experiment->second, file, random);
}

struct jp_segment_command experiment_command(const struct experiment_segment *segment, double seconds)
{
    return (struct jp_segment_command){
        .motion = {.speed = (jp_q24)lround(segment->speed * JP_Q24_ONE),
                   .turn_rate = (jp_q24)lround(segment->turn_rate * JP_Q24_ONE)},
        .turn = (jp_q24)lround(segment->turn * JP_Q24_ONE),
        .duration = (jp_q16)lround(seconds * JP_Q16_ONE),
    };
}

static double joules(jp_energy energy)
{
    return (double)energy / 4294967296.0;
}

static double volts(jp_q16 voltage)
{
    return (double)voltage / JP_Q16_ONE;
}

/** The motors' share of what the meters counted in `ticks`. */
static struct experiment_energy of_motors(const struct jp_meter *meter, jp_energy model, jp_energy battery,
                                          uint32_t ticks)
{
    const double electronics = ticks * joules(meter->electronics_tick);

    return (struct experiment_energy){.motor = joules(model) - electronics, .battery = joules(battery) - electronics};
}

/** Drives the waiting segment from its first tick to its last; false when the robot stopped driving. */
static bool drive(struct rig *rig, const struct jp_segment_command *command, uint32_t ticks, double *window_voltage,
                  struct experiment_energy *energy)
{
    const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(&rig->robot);
    const struct jp_meter *meter = jp_robot_meter(&rig->robot);
    jp_energy model = 0;
    jp_energy battery = 0;

    (void)jp_robot_drive(&rig->robot, command);
    for (uint32_t tick = 0; tick < ticks; tick++) {
        rig_tick(rig);
        if (telemetry->state != JP_ROBOT_DRIVING) {
            return false;
        }
        if (tick == 0) {
            model = meter->model;
            battery = meter->battery;
        }
        if (window_voltage != NULL) {
            double *window = &window_voltage[2 * (tick / EXPERIMENT_WINDOW_TICKS)];

            window[0] += volts(telemetry->voltages.left) / EXPERIMENT_WINDOW_TICKS;
            window[1] += volts(telemetry->voltages.right) / EXPERIMENT_WINDOW_TICKS;
            if (tick % EXPERIMENT_WINDOW_TICKS == 0) {
                energy[tick / EXPERIMENT_WINDOW_TICKS] =
                    of_motors(meter, meter->model - model, meter->battery - battery, tick);
            }
        }
    }
    return true;
}

/** First window from which successive means differ by less than the threshold, in windows. */
static uint32_t settled_window(const double *window_voltage, uint32_t windows, double threshold)
{
    uint32_t settled = windows;

    while (settled > 1 && fabs(window_voltage[2 * settled - 2] - window_voltage[2 * settled - 4]) < threshold &&
           fabs(window_voltage[2 * settled - 1] - window_voltage[2 * settled - 3]) < threshold) {
        settled--;
    }
    return settled;
}

void experiment_run(struct experiment *experiment, struct rig *rig, double seconds, double threshold,
                    struct experiment_energy *energy)
{
    const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(&rig->robot);
    double tick = world_tick_seconds(&rig->world);
    uint32_t ticks = (uint32_t)lround(seconds / tick);
    uint32_t windows = ticks / EXPERIMENT_WINDOW_TICKS;
    struct jp_segment_command first = experiment_command(&experiment->first, seconds);
    struct jp_segment_command second = experiment_command(&experiment->second, seconds);
    double *window_voltage = calloc(2 * (size_t)windows + 2, sizeof *window_voltage);

    if (window_voltage == NULL) {
        abort();
    }
    rig_release(rig, 0);
    if (drive(rig, &first, ticks, NULL, NULL)) {
        experiment->voltage_left = volts(telemetry->voltages.left);
        experiment->voltage_right = volts(telemetry->voltages.right);
        (void)drive(rig, &second, ticks, window_voltage, energy);
    }
    experiment->end = jp_robot_state_now(&rig->robot);
    experiment->faults = telemetry->faults;

    /* One tick more closes the last window. */
    rig_tick(rig);
    energy[windows] = of_motors(jp_robot_meter(&rig->robot), telemetry->segment_energy_model,
                                telemetry->segment_energy_battery, ticks);
    experiment->settling = settled_window(window_voltage, windows, threshold) * EXPERIMENT_WINDOW_TICKS * tick;
    free(window_voltage);
}
