#include "sim/missions/ground_trips.h"

#include <joulepath/skid_tariff.h>
#include <math.h>
#include <stdlib.h>

#include "sim/base/error.h"
#include "sim/base/strict_math.h"
#include "sim/missions/navigation_sight.h"
#include "sim/missions/navigation_skid.h"
#include "sim/skid_steer/skid_drive.h"

#define Q16 65536.0
#define Q24 16777216.0

/** Until a motion is steady, and what is measured then, s. */
#define STEADY_SECONDS  4.0
#define MEASURE_SECONDS 10.0

#define SECONDS_MAX 3600

/* ---- What grounds take truly ---- */

static void drive_steadily(struct skid_drive *drive, double speed, double turn_rate, double seconds)
{
    const struct skid_steer_motion motion = {.speed = speed, .turn_rate = turn_rate};
    const struct skid_piece piece = {.start = motion, .end = motion, .seconds = seconds};

    skid_drive_piece(drive, &piece);
}

/* W */
static double true_power(const struct skid_steer_model *model, double speed, double turn_rate)
{
    static const struct skid_ground level = {NULL, NULL};
    static const struct planar_pose pose = {0, 0, 0};
    struct skid_drive steady;

    skid_drive_start(&steady, model, &level, &pose, 1);
    drive_steadily(&steady, speed, turn_rate, STEADY_SECONDS);
    const double before = skid_drive_energy(&steady);

    drive_steadily(&steady, speed, turn_rate, MEASURE_SECONDS);
    return (skid_drive_energy(&steady) - before) / MEASURE_SECONDS;
}

void ground_trips_truth(const struct lattice_robot *robot, const struct map_file *map,
                        struct ground_take truth[JP_GROUND_CLASSES])
{
    const struct skid_steer_model *model = &robot->skid_steer;

    for (unsigned k = 0; k < JP_GROUND_CLASSES; k++) {
        struct skid_steer_model there = *model;

        there.ground.rolling *= map->grounds[k].rolling;
        there.ground.friction *= map->grounds[k].friction;
        truth[k].straight = true_power(&there, model->lattice.speed_m_s, 0) / model->lattice.speed_m_s;
        truth[k].turning = true_power(&there, 0, model->lattice.turn_rate_rad_s) / model->lattice.turn_rate_rad_s;
    }
}

/* ---- What is known ---- */

static struct jp_motion usual_motion(const struct skid_steer_model *model)
{
    return (struct jp_motion){(jp_q24)lround(model->lattice.speed_m_s * Q24),
                              (jp_q24)lround(model->lattice.turn_rate_rad_s * Q24)};
}

static double power_by(const struct jp_skid_energy_model *model, jp_q24 speed, jp_q24 turn_rate)
{
    const struct jp_motion motion = {speed, turn_rate};
    jp_q16 power = 0;

    (void)jp_skid_energy_power(model, &motion, 0, &power);
    return power / Q16;
}

static void tell(const struct navigation_skid *skid, const struct skid_steer_model *model, struct ground_trip *trip)
{
    const struct jp_motion usual = usual_motion(model);

    for (uint8_t k = 0; k < JP_GROUND_CLASSES; k++) {
        const struct jp_skid_energy_model *learned = jp_skid_grounds_model(&skid->grounds, &skid->pilot.learner, k);
        struct ground_known *known = &trip->known[k];
        jp_q16 factor[JP_GROUND_FACTORS];
        jp_q16 deviation[JP_GROUND_FACTORS];

        jp_ground_learner_factors(&skid->grounds.learner, k, factor);
        jp_ground_learner_deviations(&skid->grounds.learner, k, deviation);
        for (int j = 0; j < (int)JP_GROUND_FACTORS; j++) {
            known->factor[j] = factor[j] / Q16;
            known->deviation[j] = deviation[j] / Q16;
        }
        known->take.straight = power_by(learned, usual.speed, 0) / model->lattice.speed_m_s;
        known->take.turning = power_by(learned, 0, usual.turn_rate) / model->lattice.turn_rate_rad_s;
        known->legs = k == 0 ? skid->pilot.learner.state.version : skid->grounds.learner.states[k].version;
    }
}

static bool recall(struct navigation_skid *skid, const struct ground_memory *memory)
{
    const char *field = "";
    bool is_sound = !memory->is_there || jp_skid_learner_restore(&skid->pilot.learner, &memory->robot, &field) == JP_OK;

    for (uint8_t k = 1; is_sound && memory->is_there && k < JP_GROUND_CLASSES; k++) {
        is_sound = jp_ground_learner_restore(&skid->grounds.learner, k, &memory->grounds[k], &field) == JP_OK;
    }
    jp_skid_grounds_follow(&skid->grounds, &skid->pilot.learner);
    return is_sound;
}

static void remember(const struct navigation_skid *skid, struct ground_memory *memory)
{
    memory->robot = skid->pilot.learner.state;
    for (unsigned k = 1; k < JP_GROUND_CLASSES; k++) {
        memory->grounds[k] = skid->grounds.learner.states[k];
    }
    memory->scale = navigation_skid_gyro_scale(skid);
    memory->is_there = true;
}

/* ---- Prices ---- */

/* To where its wheels may be, with what it may leave its path by; Q16. */
static jp_q16 half_track(const struct skid_steer_model *model)
{
    return (jp_q16)lround((model->body.width_m + model->navigation.margin_m) / 2 * Q16);
}

/* Of the lattice by what is known. False after one line on stderr. */
static bool price(const struct ground_trips_task *task, const struct navigation_skid *skid, struct jp_tariff *tariff)
{
    const struct skid_robot_entry *entry = skid_robot_find(task->robot->name);
    const struct jp_motion usual = usual_motion(&task->robot->skid_steer);
    struct jp_tariff_factors factors[JP_GROUND_CLASSES];
    enum jp_status status = JP_OK;
    const char *field = "";

    for (uint8_t k = 0; k < JP_GROUND_CLASSES && status == JP_OK; k++) {
        status = jp_skid_tariff_factors(entry->priced, jp_skid_grounds_model(&skid->grounds, &skid->pilot.learner, k),
                                        &usual, skid->pilot.learner.state.version, &factors[k]);
    }
    const struct jp_tariff_grounds grounds = {
        .factors = factors, .classes = JP_GROUND_CLASSES, .half_track = half_track(&task->robot->skid_steer)};

    if (status == JP_OK) {
        status = jp_tariff_by_grounds(tariff, task->lattice, &grounds, &field);
    }
    if (status != JP_OK) {
        error_line("%s: what it has learned is no price of its lattice: %s", task->robot->name, field);
    }
    return status == JP_OK;
}

/* ---- The robot's map ---- */

struct robot_map {
    struct jp_terrain terrain;
    void *block;
};

/* What the map shows, with its classes or without. False after one line on stderr. */
static bool copy_map(const struct jp_terrain *map, bool has_classes, struct robot_map *copy)
{
    struct jp_terrain_config config = map->config;
    const char *field;

    config.has_classes = has_classes && map->config.has_classes;
    const size_t size = jp_terrain_size(&config);

    copy->block = aligned_alloc(8, (size + 7) / 8 * 8);
    if (copy->block == NULL || jp_terrain_init(&copy->terrain, &config, copy->block, size, &field) != JP_OK) {
        error_line("no memory for a map of %u × %u cells; import a smaller window", config.width, config.height);
        return false;
    }
    for (int32_t y = 0; y < config.height; y++) {
        for (int32_t x = 0; x < config.width; x++) {
            (void)jp_terrain_set_cell(&copy->terrain, x, y, jp_terrain_cell(map, x, y));
            (void)jp_terrain_set_elevation(&copy->terrain, x, y, jp_terrain_elevation(map, x, y));
            (void)jp_terrain_set_cost(&copy->terrain, x, y, jp_terrain_cost(map, x, y));
            (void)jp_terrain_set_class(&copy->terrain, x, y, jp_terrain_class(map, x, y));
        }
    }
    return true;
}

/* ---- A trip ---- */

struct observer {
    const struct jp_terrain *world;
    struct ground_trip *trip;
    struct clearance_pose before;
    bool has_begun;
    void (*watch)(void *context, const struct navigation_frame *frame);
    void *context;
};

static void observe(void *context, const struct navigation_frame *frame)
{
    struct observer *observer = context;
    const double side = observer->world->config.resolution / Q16;
    const uint8_t ground =
        jp_terrain_class(observer->world, (int32_t)(frame->pose.x / side), (int32_t)(frame->pose.y / side));

    if (observer->has_begun) {
        observer->trip->metres_on[ground] +=
            strict_hypot(frame->pose.x - observer->before.x, frame->pose.y - observer->before.y);
    }
    observer->before = frame->pose;
    observer->has_begun = true;
    if (observer->watch != NULL) {
        observer->watch(observer->context, frame);
    }
}

static bool drive(const struct ground_trips_task *task, struct ground_memory *memory, struct robot_map *map,
                  struct observer *observer)
{
    static struct navigation_skid skid;
    const struct jp_terrain *world = &task->map->terrain;
    struct skid_classes classes;
    const struct skid_surface surface = navigation_skid_surface(world, task->map->grounds, &classes);
    struct navigation_robot driven;
    struct navigation_task way = {.map = &map->terrain,
                                  .world = world,
                                  .solid = world,
                                  .start = task->places.start,
                                  .goal = task->places.goal,
                                  .view_m = 1,
                                  .memory = task->memory,
                                  .patience = SECONDS_MAX,
                                  .seed = task->seed,
                                  .watch = observe,
                                  .context = observer};
    struct jp_tariff tariff = {.primitives_max = task->lattice->first_from[JP_HEADINGS]};

    way.lattice = task->lattice;
    const struct clearance_pose start = navigation_start(&way);

    tariff.primitives = calloc(tariff.primitives_max, sizeof tariff.primitives[0]);
    way.lattice = &tariff.lattice;
    const bool is_done = tariff.primitives != NULL &&
                         navigation_skid_init_again(&skid, skid_robot_find(task->robot->name), &task->robot->skid_steer,
                                                    world, &surface, &start, task->seed, &memory->scale, &driven) &&
                         recall(&skid, memory) && price(task, &skid, &tariff) &&
                         navigation_run(&way, &driven, &observer->trip->result);

    free(tariff.primitives);
    if (is_done) {
        tell(&skid, &task->robot->skid_steer, observer->trip);
        remember(&skid, memory);
    }
    return is_done;
}

bool ground_trip_drive(const struct ground_trips_task *task, struct ground_memory *memory,
                       void (*watch)(void *context, const struct navigation_frame *frame), void *context,
                       struct ground_trip *trip)
{
    struct robot_map map = {.block = NULL};
    struct observer observer = {.world = &task->map->terrain, .trip = trip, .watch = watch, .context = context};

    *trip = (struct ground_trip){.metres_on = {0}};
    const bool is_done = copy_map(&task->map->terrain, task->keeps, &map) && drive(task, memory, &map, &observer);

    free(map.block);
    return is_done;
}
