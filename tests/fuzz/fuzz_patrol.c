/**
 * The patrol's behaviour, its elastic band and its scan matcher with any configuration that they accept, on scans,
 * poses and paths of any numbers, also those that are none: twists are 0 unless it drives, and within the wheels'
 * limits.
 */
#include <joulepath/patrol.h>
#include <joulepath/scan_match.h>
#include <joulepath/tables.h>
#include <math.h>

#include "tests/fuzz/fuzz_config.h"
#include "tests/fuzz/fuzz_plane.h"

#define BEAMS  120U
#define POINTS 16U
#define CYCLES 24U

static struct jp_patrol patrol;
static struct jp_patrol_config config;
static struct jp_patrol_input seen;
static struct jp_scan_matcher matcher;
static uint64_t block[65536 / sizeof(uint64_t)];
static float ranges[BEAMS];
static struct jp_point path[POINTS];

static bool start(struct fuzz_input *input)
{
    const char *field = NULL;
    uint8_t turns;
    uint8_t *const place = (uint8_t *)&config.turns_in_place;

    config = jp_patrol_config_patrol;
    config.teb.rounds = 1;
    config.teb.steps = 2;
    FUZZ_CHANGE(input, config);
    memcpy(&turns, place, sizeof turns);
    *place = turns & 1U;

    const enum jp_status status = jp_patrol_init(&patrol, &config, &field);

    return fuzz_accepted(status, field);
}

static void draw_scan(struct fuzz_input *input)
{
    const float everywhere = fuzz_float(input, 8.0f);

    for (unsigned i = 0; i < BEAMS; i++) {
        ranges[i] = everywhere;
    }
    for (unsigned left = fuzz_below(input, 8); left > 0U; left--) {
        const float range = fuzz_float(input, 6.0f);
        const uint32_t from = fuzz_below(input, BEAMS);
        const uint32_t count = fuzz_below(input, 32);

        for (uint32_t i = from; i < from + count && i < BEAMS; i++) {
            ranges[i] = range;
        }
    }
    seen.scan =
        (struct jp_scan){.ranges = fuzz_below(input, 8) == 7U ? NULL : ranges,
                         .count = (uint16_t)(fuzz_below(input, 16) == 15U ? fuzz_below(input, BEAMS + 1U) : BEAMS),
                         .first_angle = -3.1f,
                         .angle_step = 0.05f};
    if (fuzz_below(input, 16) == 15U) {
        seen.scan.first_angle = fuzz_float(input, 7.0f);
        seen.scan.angle_step = fuzz_float(input, 0.1f);
    }
}

static void follow(struct fuzz_input *input)
{
    struct jp_patrol_goal goal = {.is_heading_free = fuzz_bool(input)};
    struct jp_point point = {(int32_t)(patrol.pose.x * 1024.0f) * 64, (int32_t)(patrol.pose.y * 1024.0f) * 64};
    const uint16_t count = (uint16_t)fuzz_below(input, POINTS + 1U);

    for (unsigned i = 0; i < count; i++) {
        path[i] = point;
        point.x += fuzz_range(input, -JP_Q16(1), JP_Q16(1));
        point.y += fuzz_range(input, -JP_Q16(1), JP_Q16(1));
        if (fuzz_below(input, 64) == 63U) {
            point.x = (int32_t)fuzz_u16(input) << 12;
        }
    }
    if (count > 0U) {
        goal.pose.x = (float)path[count - 1U].x / 65536.0f;
        goal.pose.y = (float)path[count - 1U].y / 65536.0f;
    }
    goal.pose.heading = fuzz_float(input, 3.2f);
    if (fuzz_below(input, 16) == 15U) {
        goal.pose = fuzz_pose(input, 8.0f);
    }
    (void)jp_patrol_follow(&patrol, path, count, &goal);
}

static void check_twist(enum jp_status status, const struct jp_twist *twist)
{
    const bool drives = patrol.state == JP_PATROL_TURNING || patrol.state == JP_PATROL_DRIVING ||
                        patrol.state == JP_PATROL_STEPPING || patrol.state == JP_PATROL_GLIDING;
    const jp_q24 most = JP_Q24(16);

    fuzz_require(status == JP_OK || (status == JP_ERR_ARGUMENT && patrol.state == JP_PATROL_STOPPED),
                 "a status of a cycle");
    fuzz_require(patrol.state <= JP_PATROL_STOPPED && patrol.reason <= JP_PATROL_INFEASIBLE, "a state that is none");
    fuzz_require(drives || (twist->x == 0 && twist->y == 0 && twist->turn_rate == 0), "a twist of a robot that waits");
    fuzz_require(twist->x <= most && twist->x >= -most && twist->y <= most && twist->y >= -most &&
                     twist->turn_rate <= most && twist->turn_rate >= -most,
                 "a twist beyond what wheels can be asked for");
}

static void match(struct fuzz_input *input)
{
    const struct jp_plane_pose guess = fuzz_pose(input, 0.2f);
    struct jp_match_result result;

    if (jp_scan_match(&matcher, &seen.scan, fuzz_bool(input) ? &guess : NULL, &result) == JP_OK) {
        fuzz_require(isfinite(matcher.pose.x) && isfinite(matcher.pose.y) && isfinite(matcher.pose.heading) &&
                         isfinite(matcher.motion.x) && isfinite(matcher.motion.y) && isfinite(matcher.motion.heading),
                     "a match that is nowhere");
    }
}

static void cycle(struct fuzz_input *input)
{
    struct jp_twist twist;

    seen.speed = (struct jp_plane_speed){fuzz_float(input, 1.0f), fuzz_float(input, 1.0f)};
    if (fuzz_bool(input)) {
        seen.wheels.x += fuzz_float(input, 0.1f);
        seen.wheels.y += fuzz_float(input, 0.1f);
        seen.wheels.heading += fuzz_float(input, 0.1f);
        seen.laser = seen.wheels;
    }
    if (fuzz_below(input, 8) == 7U) {
        seen.laser = fuzz_pose(input, 8.0f);
        seen.sensor = fuzz_pose(input, 0.5f);
        seen.deviation = fuzz_float(input, 1.0f);
    }
    seen.has_laser = fuzz_below(input, 8) != 7U;
    seen.is_lost = fuzz_below(input, 32) == 31U;
    seen.is_new_place = fuzz_below(input, 32) == 31U;
    if (fuzz_bool(input)) {
        draw_scan(input);
    }
    match(input);
    check_twist(jp_patrol_cycle(&patrol, &seen, &twist), &twist);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};

    memset(&seen, 0, sizeof seen);
    if (!start(&input)) {
        return 0;
    }
    fuzz_require(jp_scan_matcher_init(&matcher, BEAMS, block, sizeof block) == JP_OK, "a matcher");
    draw_scan(&input);
    for (unsigned left = CYCLES; left > 0U && fuzz_more(&input); left--) {
        switch (fuzz_below(&input, 16)) {
        case 0:
            jp_patrol_hold(&patrol);
            break;
        case 1:
            jp_patrol_pause(&patrol);
            break;
        case 2:
            seen.wheels = fuzz_pose(&input, 8.0f);
            (void)jp_patrol_set_pose(&patrol, &seen.wheels);
            break;
        case 3:
        case 4:
        case 5:
            follow(&input);
            break;
        default:
            break;
        }
        cycle(&input);
    }
    return 0;
}
