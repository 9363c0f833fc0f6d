#include "sim/missions/leg_drive.h"

#include <joulepath/pilot.h>
#include <math.h>

#include "sim/balancer/energy_unit.h"
#include "sim/balancer/fault_names.h"
#include "sim/base/error.h"
#include "sim/missions/random_targets.h"

/* A stand before a route begins, s. */
#define STAND_SECONDS 8.0

/* No cruise is below it. */
#define SLOWEST JP_Q24(0.02)

/* The random numbers of missions begin below it. */
#define SEEDS_OF_LEGS ((uint64_t)1 << 41)

struct drive {
    struct leg_drive *legs;
    struct rig rig;
    enum energy_kind kind;
    const struct jp_energy_model *built_in;
    struct jp_energy_model model; /**< as learned */
    struct random random;
    struct jp_point targets[LEG_DRIVE_ROUTE];
    struct jp_trajectory_leg planned[LEG_DRIVE_ROUTE];
    struct jp_trajectory trajectory;
};

static double joules(jp_energy energy)
{
    return (double)energy / 4294967296.0;
}

/* From the stand. */
static enum jp_status plan_at(struct drive *drive, jp_q24 cruise)
{
    struct jp_telemetry telemetry;
    const struct jp_robot_config *config = jp_robot_configuration(&drive->rig.robot);
    struct jp_trajectory_task task = {.config = &config->trajectory,
                                      .cruise = cruise,
                                      .targets = drive->targets,
                                      .count = LEG_DRIVE_ROUTE,
                                      .to_stand = true};

    (void)jp_robot_telemetry(&drive->rig.robot, &telemetry);
    task.start = telemetry.position;
    task.heading = jp_phase_angle(telemetry.reference_yaw);
    return jp_trajectory_by_rule(&task, drive->planned, &drive->trajectory);
}

/* As the pilot does it: slower where legs are too short. */
static bool find_plan(struct drive *drive)
{
    const struct jp_robot_config *config = jp_robot_configuration(&drive->rig.robot);
    jp_q24 cruise = jp_pilot_cruise(config, &drive->model);
    enum jp_status status;

    random_targets_draw(&drive->random, &drive->rig, drive->targets, LEG_DRIVE_ROUTE);
    do {
        status = plan_at(drive, cruise);
        cruise -= cruise / 4;
    } while (status == JP_ERR_INFEASIBLE && cruise > SLOWEST);
    return status == JP_OK;
}

static void expect(struct drive *drive, struct driven_leg *legs)
{
    const struct jp_robot_config *config = jp_robot_configuration(&drive->rig.robot);
    const struct jp_back_emf back_emf =
        jp_pilot_back_emf(config, drive->kind == ENERGY_BATTERY ? JP_PILOT_BATTERY : JP_PILOT_MOTORS);
    jp_q24 modes[JP_TRAVEL_MODES];

    jp_trajectory_modes(&drive->trajectory, modes);
    for (uint16_t i = 0; i < drive->trajectory.count; i++) {
        (void)jp_trajectory_leg_energy(&config->trajectory, drive->built_in, &back_emf, &drive->planned[i], modes,
                                       &legs[i].expected);
    }
}

static void stand(struct drive *drive)
{
    const uint64_t ticks = (uint64_t)lround(STAND_SECONDS / world_tick_seconds(&drive->rig.world));

    for (uint64_t i = 0; i < ticks; i++) {
        rig_tick(&drive->rig);
    }
}

/* False: the robot did not drive all legs. */
static bool measure(struct drive *drive, struct driven_leg *legs)
{
    const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(&drive->rig.robot);
    unsigned ended = 0;
    uint16_t before = telemetry->segments_ended;

    if (jp_robot_drive_trajectory(&drive->rig.robot, &drive->trajectory) != JP_OK) {
        return false;
    }
    do {
        rig_tick(&drive->rig);
        if (telemetry->segments_ended != before) {
            before = telemetry->segments_ended;
            if (before != 0) {
                legs[ended].measured = joules(drive->kind == ENERGY_BATTERY ? telemetry->segment_energy_battery
                                                                            : telemetry->segment_energy_model);
                ended++;
            }
        }
    } while (telemetry->state == JP_ROBOT_DRIVING && ended < drive->trajectory.count);
    return ended == drive->trajectory.count;
}

/* The power of travel, of the first routes as a whole. */
static void learn(struct drive *drive, const struct driven_leg *legs)
{
    double travel = 0;
    double more = 0;

    for (unsigned i = 0; i < LEG_DRIVE_LEARNT; i++) {
        travel += (double)legs[i].expected.travel / JP_Q16_ONE;
        more += legs[i].measured - energy_unit_joules(drive->built_in, legs[i].expected.energy);
    }
    drive->model.b[0] += (jp_q16)lround(energy_unit_number(drive->built_in, more / travel));
}

static bool drive_routes(struct drive *drive, unsigned count, struct driven_leg *legs)
{
    bool is_driven = true;

    for (unsigned i = 0; i < count && is_driven; i += LEG_DRIVE_ROUTE) {
        stand(drive);
        is_driven = find_plan(drive);
        if (is_driven) {
            expect(drive, &legs[i]);
            is_driven = measure(drive, &legs[i]);
        }
    }
    return is_driven;
}

/** Why it did not drive its legs. */
static void complain(const struct drive *drive, const char *name)
{
    const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(&drive->rig.robot);
    const unsigned long long seed = drive->legs->seed;
    char faults[FAULTS_NAME_SIZE];

    faults_name(telemetry->faults, faults);
    if (telemetry->state == JP_ROBOT_FALLEN) {
        error_line("%s: the robot of seed %llu, with %.3g kg of payload, fell; give limits.payload_kg or slower limits",
                   name, seed, drive->legs->variation.payload_kg);
    } else if (telemetry->state == JP_ROBOT_FAULT) {
        error_line("%s: the robot of seed %llu stopped with the fault: %s; correct its sensors or lower its limits",
                   name, seed, faults);
    } else {
        error_line("%s: a route of the robot of seed %llu cannot be planned; correct its limits", name, seed);
    }
}

bool leg_drive_run(struct leg_drive *legs, const struct robot_entry *entry, enum energy_kind kind,
                   const struct robot_file *file, uint64_t seed)
{
    struct drive drive = {.legs = legs, .kind = kind, .built_in = rig_energy_model(entry, kind)};
    struct robot_file varied;

    if (drive.built_in == NULL) {
        return false;
    }
    *legs = (struct leg_drive){.seed = seed, .model = drive.built_in};
    random_init(&drive.random, seed + SEEDS_OF_LEGS);
    variation_draw(&drive.random, file, &legs->variation);
    variation_apply(&legs->variation, file, &varied);
    if (!rig_init(&drive.rig, entry, &varied, seed + SEEDS_OF_LEGS)) {
        return false;
    }
    rig_release(&drive.rig, 0);
    drive.model = *drive.built_in;

    bool is_driven = drive_routes(&drive, LEG_DRIVE_LEARNT, legs->legs);

    if (is_driven) {
        learn(&drive, legs->legs);
        is_driven = drive_routes(&drive, LEG_DRIVE_FORECAST, &legs->legs[LEG_DRIVE_LEARNT]);
    }
    if (!is_driven) {
        complain(&drive, entry->name);
        return false;
    }
    return true;
}
