/**
 * Paths along any points, on ground of any shape: their speeds are within the limits, corners are rounded without
 * leaving their lines' ends, and a drive along one follows set-points that stay finite until it stands at its end.
 */
#include <joulepath/line_path.h>
#include <joulepath/path_corner.h>
#include <joulepath/path_drive.h>
#include <joulepath/path_speed.h>
#include <joulepath/skid_path_energy.h>
#include <joulepath/tables.h>

#include "tests/fuzz/fuzz_config.h"
#include "tests/fuzz/fuzz_input.h"

#define TARGETS    8U
#define PIECES     40U
#define SET_POINTS 5000U

static struct jp_point targets[TARGETS];
static struct jp_path_piece pieces[PIECES];
static struct jp_path_limits limits;
static struct jp_path_drive_config config;
static struct jp_skid_energy_model model;
static uint32_t shape;

static jp_q16 elevation(const void *context, const struct jp_point *point)
{
    const uint32_t *bits = (const uint32_t *)context;

    return (jp_q16)((((uint32_t)point->x >> (*bits & 15U)) * (*bits >> 16)) & 0x3FFFFU);
}

static uint8_t class_at(const void *context, const struct jp_point *point)
{
    const uint32_t *bits = (const uint32_t *)context;

    return (uint8_t)(((uint32_t)point->y >> (*bits & 15U)) % JP_GROUND_CLASSES);
}

static jp_q16 power(const void *context, const struct jp_motion *motion, jp_q24 grade)
{
    jp_q16 watts = 0;

    (void)jp_skid_energy_power((const struct jp_skid_energy_model *)context, motion, grade, &watts);
    return watts;
}

static struct jp_point draw_point(struct fuzz_input *input)
{
    const int32_t most = fuzz_bool(input) ? JP_Q16(4) : fuzz_bool(input) ? JP_Q16(64) : INT32_MAX;

    return (struct jp_point){fuzz_range(input, -most, most), fuzz_range(input, -most, most)};
}

static void check_speeds(const struct jp_lattice_path *path)
{
    for (unsigned i = 0; i < path->count; i++) {
        const struct jp_path_piece *piece = &path->pieces[i];
        const bool turns = piece->kind != JP_PIECE_CURVE;
        const jp_q24 most = turns ? limits.turn_rate : limits.speed;

        fuzz_require(piece->length > 0 && piece->length <= JP_PIECE_LENGTH_MAX, "the length of a piece");
        fuzz_require(piece->speed.cruise > 0 && piece->speed.cruise <= most, "a cruise beyond the limit");
        fuzz_require(piece->speed.end >= 0 && piece->speed.end <= most, "an end beyond the limit");
        fuzz_require(piece->speed.acceleration > 0 &&
                         piece->speed.acceleration <= (turns ? limits.turn_acceleration : limits.acceleration),
                     "an acceleration beyond the limit");
        fuzz_require(!turns || piece->speed.end == 0, "a turn on the spot that does not stop");
    }
    fuzz_require(path->pieces[path->count - 1U].speed.end == 0, "an end that is not a stand");
}

static void drive(struct fuzz_input *input, const struct jp_lattice_path *path)
{
    struct jp_path_drive drive;
    struct jp_path_set_point at;
    struct jp_path_slide slide = {.by_turn = fuzz_range(input, 0, JP_Q24(64)), .most = fuzz_range(input, 0, JP_Q24(4))};
    struct jp_motion motion;
    const char *field = NULL;
    uint16_t piece = 0;

    if (!fuzz_accepted(jp_path_drive_init(&drive, &config, &field), field)) {
        return;
    }
    slide.ahead = fuzz_range(input, -JP_Q24_ONE, JP_Q24_ONE);
    slide.left = fuzz_range(input, -JP_Q24_ONE, JP_Q24_ONE);
    slide.by_left = fuzz_range(input, 0, JP_Q24(8));
    slide.by_way = fuzz_range(input, 0, JP_Q24_ONE);
    slide.per_most = fuzz_range(input, 0, INT32_MAX);
    jp_path_drive_begin(&drive, path);
    for (unsigned left = SET_POINTS; left > 0U && jp_path_drive_advance(&drive, &at); left--) {
        struct jp_path_pose pose = at.pose;

        fuzz_require(jp_path_drive_piece(&drive) >= piece && jp_path_drive_piece(&drive) <= path->count,
                     "a piece out of turn");
        piece = jp_path_drive_piece(&drive);
        if (fuzz_more(input)) {
            FUZZ_CHANGE(input, pose);
        }
        jp_path_drive_look_ahead(&drive, &slide);
        jp_path_drive_track(&drive, &at, &pose, &motion);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};
    struct jp_motion_price price = {.power = power, .model = &model};
    const char *field = NULL;

    limits = fuzz_bool(&input) ? jp_path_limits_zhang2018 : jp_path_limits_burger;
    config = fuzz_bool(&input) ? jp_path_drive_zhang2018 : jp_path_drive_burger;
    model = fuzz_bool(&input) ? jp_skid_energy_zhang2018 : jp_skid_energy_burger;
    FUZZ_CHANGE(&input, limits);
    FUZZ_CHANGE(&input, config);
    FUZZ_CHANGE(&input, model);
    if (!fuzz_accepted(jp_path_limits_check(&limits, &field), field) ||
        !fuzz_accepted(jp_skid_energy_check(&model, &field), field)) {
        return 0;
    }
    price.time = fuzz_range(&input, 0, JP_Q16(16384));
    price.gain = fuzz_range(&input, 0, JP_Q16(16384));
    price.recovery = fuzz_range(&input, 0, JP_Q16(16384));
    for (unsigned left = 6; left > 0U && fuzz_more(&input); left--) {
        const struct jp_ground ground = {elevation, fuzz_bool(&input) ? class_at : NULL, &shape,
                                         fuzz_range(&input, JP_Q16(0.05), JP_Q16(4)), fuzz_range(&input, 0, JP_Q16(2))};
        struct jp_line_route route = {.start = draw_point(&input),
                                      .heading = fuzz_u32(&input),
                                      .targets = targets,
                                      .count = (uint16_t)fuzz_below(&input, TARGETS + 1U),
                                      .ground = fuzz_bool(&input) ? &ground : NULL,
                                      .half_track = fuzz_range(&input, 0, JP_Q16(2))};
        struct jp_lattice_path path;
        struct jp_path_cost cost;

        shape = fuzz_u32(&input);
        for (unsigned i = 0; i < TARGETS; i++) {
            targets[i] = draw_point(&input);
        }
        if (jp_line_path(&path, pieces, (uint16_t)fuzz_below(&input, PIECES + 1U), &route) != JP_OK) {
            continue;
        }
        for (unsigned corners = fuzz_below(&input, 8); corners > 0U; corners--) {
            const struct jp_corner_room room = {fuzz_range(&input, 0, JP_Q24(8)), (jp_q24)fuzz_u32(&input)};

            (void)jp_path_round_corner(&path, (uint16_t)fuzz_below(&input, PIECES), &room, &limits, &price);
        }

        const enum jp_status status = jp_path_plan_speeds(&path, &limits, &price, &cost);

        fuzz_require(status == JP_OK || status == JP_ERR_OVERFLOW, "speeds of a path that are not to be had");
        fuzz_require(cost.duration > 0, "a path in no time");
        check_speeds(&path);
        drive(&input, &path);
    }
    return 0;
}
