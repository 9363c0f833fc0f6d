#include "tests/support/chain.h"

#include <math.h>

#define RADIANS_PER_DEGREE 0.017453292519943295
#define RADIANS_PER_TURN   6.283185307179586

/** A segment must run for a tick before the next is handed over. */
#define TICKS_MIN 2.0

static void draw(struct chain_record *record, const struct robot_file *file, const struct chain_ranges *ranges,
                 struct random *random)
{
    const double speed = ranges->speed_share * file->limits.speed_m_s;
    const double backward = ranges->backward_share * file->limits.speed_m_s;
    const double turn_rate = ranges->turn_rate_share * file->limits.turn_rate_rad_s;
    const double turn = ranges->turn_share * file->limits.turn_deg * RADIANS_PER_DEGREE;

    *record = (struct chain_record){0};
    record->command.speed = random_uniform(random, -backward, speed);
    record->command.turn_rate = random_uniform(random, -turn_rate, turn_rate);
    record->command.turn = random_uniform(random, -turn, turn);
    record->commanded_ticks = (uint32_t)fmax(
        TICKS_MIN, round(random_uniform(random, ranges->shortest, ranges->longest) * file->control.rate_hz));
}

void chain_draw(struct chain_record *records, size_t count, const struct robot_file *file,
                const struct chain_ranges *ranges, struct random *random)
{
    for (size_t i = 0; i < count; i++) {
        draw(&records[i], file, ranges, random);
    }
}

static void hand_over(struct rig *rig, const struct chain_record *record)
{
    const double seconds = record->commanded_ticks * world_tick_seconds(&rig->world);
    const struct jp_segment_command command = experiment_command(&record->command, seconds);

    (void)jp_robot_drive(&rig->robot, &command);
}

/** One tick; false, and nothing entered, when the robot no longer drives. */
static bool drive_tick(struct rig *rig, struct chain_record *record)
{
    const struct world *world = &rig->world;
    const struct plant_ledger before = world->plant.ledger;
    const uint32_t saturated = jp_robot_last_tick(&rig->robot)->saturated_ticks;

    rig_tick(rig);
    if (jp_robot_state_now(&rig->robot) != JP_ROBOT_DRIVING) {
        return false;
    }

    const double electrical = world->plant.ledger.electrical - before.electrical;
    const double electronics = world->robot.electronics.power_w * world_tick_seconds(world);

    record->ticks++;
    record->motor += world->plant.ledger.motor - before.motor;
    record->electrical += electrical;
    record->charge += (electrical + electronics) / world->bus_voltage;
    record->bus_voltage += (world->bus_voltage - record->bus_voltage) / record->ticks;
    record->saturated_ticks += jp_robot_last_tick(&rig->robot)->saturated_ticks - saturated;
    return true;
}

static double joules(jp_energy energy)
{
    return (double)energy / 4294967296.0;
}

/** In the tick after the segment's last one, in which the robot meters that one; `start`: likewise after its first. */
static void close_record(const struct rig *rig, const struct jp_meter *start, struct chain_record *record)
{
    const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(&rig->robot);

    record->model = joules(jp_robot_meter(&rig->robot)->model - start->model);
    record->battery = joules(jp_robot_meter(&rig->robot)->battery - start->battery);
    record->faults = telemetry->faults;
    if (telemetry->state == JP_ROBOT_FALLEN) {
        record->end = CHAIN_FELL;
    } else if (telemetry->state == JP_ROBOT_FAULT) {
        record->end = CHAIN_FAULT;
    }
}

static double radians(jp_q24 turns)
{
    return (double)turns / JP_Q24_ONE * RADIANS_PER_TURN;
}

static double phase_radians(jp_phase a, jp_phase b)
{
    return radians(jp_phase_difference(a, b));
}

static double volts(jp_q16 voltage)
{
    return (double)voltage / JP_Q16_ONE;
}

static struct chain_state state_of(const struct rig *rig)
{
    const struct plant *plant = &rig->world.plant;
    const struct jp_reference *reference = jp_robot_reference(&rig->robot);
    const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(&rig->robot);
    const double integral_unit = RADIANS_PER_TURN / JP_Q24_ONE * world_tick_seconds(&rig->world);

    return (struct chain_state){
        .x = plant->x,
        .y = plant->y,
        .yaw = plant->state.yaw,
        .pitch = plant->state.pitch,
        .wheel_rate = plant->state.wheel_rate,
        .pitch_rate = plant->state.pitch_rate,
        .yaw_rate = plant->state.yaw_rate,
        .voltage_left = volts(telemetry->voltages.left),
        .voltage_right = volts(telemetry->voltages.right),
        .wheel_error = phase_radians(reference->wheel.angle, telemetry->motion.wheel),
        .yaw_error = phase_radians(reference->yaw.angle, telemetry->motion.yaw),
        .wheel_integral = (double)rig->robot.internal.lqr.wheel_integral * integral_unit,
        .yaw_integral = (double)rig->robot.internal.lqr.yaw_integral * integral_unit,
        .reference_wheel_rate = radians(reference->wheel.rate),
        .reference_yaw_rate = radians(reference->yaw.rate),
        .wheel_lag = phase_radians(reference->wheel.target, reference->wheel.angle),
        .yaw_lag = phase_radians(reference->yaw.target, reference->yaw.angle),
    };
}

/** From the second tick to the last; false after a fall. */
static bool drive_on(struct rig *rig, struct chain_record *record)
{
    bool driving = true;

    while (driving && record->ticks < record->commanded_ticks) {
        driving = drive_tick(rig, record);
    }
    record->state = state_of(rig);
    return driving;
}

size_t chain_run(struct rig *rig, struct chain_record *records, size_t count, const struct chain_change *change)
{
    struct chain_record *open = records;
    struct jp_meter start = *jp_robot_meter(&rig->robot);
    bool driving = true;

    rig_release(rig, 0);
    hand_over(rig, records);
    for (size_t i = 0; i < count && driving; i++) {
        if (change != NULL && change->at == i) {
            (void)world_change_robot(&rig->world, change->robot);
        }
        driving = drive_tick(rig, &records[i]);
        close_record(rig, &start, open);
        if (driving) {
            open = &records[i];
            start = *jp_robot_meter(&rig->robot);
            if (i + 1 < count) {
                hand_over(rig, &records[i + 1]);
            }
            driving = drive_on(rig, open);
        }
    }
    if (driving) {
        rig_tick(rig);
    }
    close_record(rig, &start, open);
    return (size_t)(open - records) + 1;
}
