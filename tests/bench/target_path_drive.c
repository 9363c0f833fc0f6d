/** Instructions of a set-point of a path and of the law that follows it, and of the plan of the path and its speeds:
 * over all primitives of a lattice, one after the other from heading to heading. */
#include <joulepath/path_drive.h>
#include <joulepath/path_speed.h>
#include <joulepath/skid_steer.h>
#include <joulepath/tables.h>
#include <stddef.h>

#include "tests/target/cycles.h"
#include "tests/target/figure.h"
#include "tests/target/random.h"

enum { PIECES = 24, SIDE = 8, EVERY = 16, TURN_SHIFT = 6 };

/* Of a tick: a set-point serves for JP_TICKS_PER_SET_POINT. */
#ifdef __ARM_ARCH_7EM__
#define BAR "350"
#else
#define BAR NULL
#endif

static const struct jp_motion_price price = {.power = jp_skid_steer_power_of, .model = &jp_skid_steer_zhang2018};

static const struct jp_lattice *const lattice = &jp_lattice_zhang2018;
static uint64_t block[SIDE * SIDE];
static struct jp_terrain terrain;
static struct jp_path_piece pieces[PIECES];
static struct jp_lattice_path path;
static struct jp_path_cost cost;
static struct jp_path_drive drive;
static struct jp_path_set_point at;
static struct jp_path_pose pose;
static struct jp_motion motion;
static enum jp_status status;

/* A different primitive of each heading on the way. */
static void make_path(void *unused)
{
    struct jp_lattice_pose from = {SIDE / 2, SIDE / 2, 0};

    (void)unused;
    (void)jp_lattice_path_start(&path, pieces, PIECES);
    status = JP_OK;
    for (unsigned i = 0; status == JP_OK && path.count < PIECES; i++) {
        const unsigned first = lattice->first_from[from.heading];
        const unsigned count = lattice->first_from[from.heading + 1U] - first;
        const struct jp_primitive *primitive = &lattice->primitives[first + i % count];

        status = jp_lattice_path_add(&path, lattice, &terrain, &from, primitive);
        from.heading = primitive->end;
    }
}

/* On a slope to the left. */
static const struct jp_path_slide slide = {0,        JP_Q24(0.2), JP_Q24(1.2), JP_Q24(0.7), JP_Q24(0.25), JP_Q24(0.08),
                                           JP_Q24(4)};

static void plan_speeds(void *unused)
{
    (void)unused;
    status = jp_path_plan_speeds(&path, &jp_path_limits_zhang2018, &price, &cost);
}

static void step(void *argument)
{
    struct jp_path_drive *copy = argument;

    *copy = drive;
    (void)jp_path_drive_advance(copy, &at);
    jp_path_drive_look_ahead(copy, &slide);
    jp_path_drive_track(copy, &at, &pose, &motion);
}

static void restore(void *argument)
{
    *(struct jp_path_drive *)argument = drive;
}

/* A robot somewhat beside every set-point of the whole path: the mean and the worst of those looked at. */
static bool count_steps(uint32_t *mean, uint32_t *worst)
{
    static struct jp_path_drive copy;
    const uint32_t restoring = target_count_instructions(restore, &copy);
    uint32_t random_state = 1;
    uint32_t sum = 0;
    uint32_t count = 0;

    *worst = 0;
    jp_path_drive_begin(&drive, &path);
    for (uint32_t i = 0; jp_path_drive_piece(&drive) < path.count; i++) {
        if (i % EVERY == 0U) {
            const uint32_t instructions = target_count_instructions(step, &copy) - restoring;

            *worst = instructions > *worst ? instructions : *worst;
            sum += instructions;
            count++;
        }
        (void)jp_path_drive_advance(&drive, &at);
        jp_path_drive_look_ahead(&drive, &slide);
        pose = at.pose;
        pose.position.x += (jp_q16)(target_random(&random_state) >> 20);
        pose.heading += (jp_angle)((int32_t)target_random(&random_state) >> TURN_SHIFT);
    }
    *mean = count == 0U ? 0U : sum / count / JP_TICKS_PER_PATH_POINT;
    return count != 0U;
}

int main(void)
{
    const struct jp_terrain_config map = {.width = SIDE, .height = SIDE, .resolution = JP_Q16(0.2)};
    const char *field = NULL;
    uint32_t mean = 0;
    uint32_t worst = 0;

    if (jp_terrain_init(&terrain, &map, block, sizeof block, &field) != JP_OK ||
        jp_path_drive_init(&drive, &jp_path_drive_zhang2018, &field) != JP_OK) {
        return 1;
    }
    const uint32_t making = target_count_once(make_path, NULL);
    const uint32_t planning = target_count_once(plan_speeds, NULL);

    if (status != JP_OK || !count_steps(&mean, &worst)) {
        target_print("no path to drive\n");
        return 1;
    }
    target_print("[\n");
    target_print_figure("path of a lattice plan: set-point and law, a tick of three, mean", mean, "instructions", BAR);
    target_print(",\n");
    target_print_figure("path of a lattice plan: set-point and law, in the tick that does it, worst", worst,
                        "instructions", NULL);
    target_print(",\n");
    target_print_figure("path of a lattice plan: a piece of it", making / PIECES, "instructions", NULL);
    target_print(",\n");
    target_print_figure("path of a lattice plan: the speeds of a piece", planning / PIECES, "instructions", NULL);
    target_print("\n]\n");
    return 0;
}
