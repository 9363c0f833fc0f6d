/* The path along a lattice plan: every primitive of the lattices against the curve that the generator solved for, and
 * random sequences of them, integrated in double. */
#include <joulepath/tables.h>
#include <stdlib.h>

#include "sim/lattice/lattice_generate.h"
#include "tests/support/check.h"
#include "tests/support/options.h"
#include "tests/support/random_path.h"

/* Farthest that a curve is from the one that the lattice's cells were swept along, m. */
#define CURVE_ERROR 1e-4

/* Where a piece ends, against where the next one begins: of the points' format too. */
#define JOINT_ERROR   4e-5
#define HEADING_ERROR 1e-5

#define Q16   65536.0
#define Q24   16777216.0
#define ANGLE (2 * M_PI / 4294967296.0)

enum { PARTS = 2000, STEPS = 60, LATTICES = 3 };

static const struct options defaults = {.count = 200, .seed = 19};
static struct options options;
static struct random noise;
static struct jp_terrain terrain;
static struct random_path walk;
static double worst_curve;
static double worst_joint;

static const struct {
    const char *file;
    const struct jp_lattice *lattice;
} lattices[LATTICES] = {
    {"sim/robots/zhang2018.cfg", &jp_lattice_zhang2018},
    {"sim/robots/courier24.cfg", &jp_lattice_courier24},
    {"sim/robots/gao2018.cfg", &jp_lattice_gao2018},
};

void setUp(void)
{
    random_init(&noise, options.seed);
}

void tearDown(void)
{
}

static struct lattice_pose pose_of(const struct jp_path_pose *pose)
{
    return (struct lattice_pose){pose->position.x / Q16, pose->position.y / Q16, pose->heading * ANGLE};
}

/* The pose on a piece, by the midpoint rule. */
static struct lattice_pose pose_at(const struct jp_path_piece *piece, double way)
{
    struct lattice_pose pose = {piece->begin.x / Q16, piece->begin.y / Q16, piece->heading * ANGLE};

    if (piece->kind != JP_PIECE_CURVE) {
        pose.heading += piece->kind == JP_PIECE_TURN_LEFT ? way : -way;
        return pose;
    }
    const double start = pose.heading;
    const double part = way / PARTS;
    for (int i = 0; i < PARTS; i++) {
        const double s = (i + 0.5) * part;
        const double heading = start + (piece->bend / Q24 + piece->bend_rate / Q16 * s / 2) * s;
        pose.x += part * cos(heading);
        pose.y += part * sin(heading);
    }
    pose.heading = start + (piece->bend / Q24 + piece->bend_rate / Q16 * way / 2) * way;
    return pose;
}

static double turn_between(double a, double b)
{
    return fabs(remainder(a - b, 2 * M_PI));
}

/* ---- Curves ---- */

static const struct jp_primitive *entry_of(const struct jp_lattice *table, const struct lattice_primitive *primitive)
{
    for (unsigned i = table->first_from[primitive->start]; i < table->first_from[primitive->start + 1]; i++) {
        const struct jp_primitive *entry = &table->primitives[i];
        if (entry->end == primitive->end && entry->dx == primitive->dx && entry->dy == primitive->dy) {
            return entry;
        }
    }
    return NULL;
}

/* The poses of the generator's path, in order, at the same share of the length. */
static void check_curve(const struct jp_path_piece *piece, const struct lattice_primitive *primitive, double cell)
{
    const struct lattice_path *path = &primitive->path;

    for (size_t i = 0; i < path->count; i++) {
        const double share = (double)i / (double)(path->count - 1);
        const struct lattice_pose pose = pose_at(piece, share * piece->length / Q24);
        const double x = piece->begin.x / Q16 + cell * path->poses[i].x;
        const double y = piece->begin.y / Q16 + cell * path->poses[i].y;
        const double distance = hypot(pose.x - x, pose.y - y);

        worst_curve = fmax(worst_curve, distance);
        check_below(distance, CURVE_ERROR, "m off the lattice's curve");
        check_below(turn_between(pose.heading, path->poses[i].heading), 10 * HEADING_ERROR, "rad off it");
    }
}

static void check_lattice(const char *file, const struct jp_lattice *table)
{
    static struct lattice_robot robot;
    struct lattice lattice = {.robot = &robot};
    const double cell = table->resolution / Q16;

    TEST_ASSERT_TRUE(lattice_robot_load(file, &robot));
    lattice.resolution_m = robot.cell_m;
    TEST_ASSERT_TRUE(lattice_generate(&lattice));
    random_path_slope(&terrain, cell, 0, 0);
    for (size_t i = 0; i < lattice.count; i++) {
        const struct jp_lattice_pose from = {RANDOM_PATH_SIDE / 2, RANDOM_PATH_SIDE / 2,
                                             (uint8_t)lattice.primitives[i].start};
        const struct jp_primitive *entry = entry_of(table, &lattice.primitives[i]);

        TEST_ASSERT_NOT_NULL(entry);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_path_start(&walk.path, walk.pieces, RANDOM_PATH_PIECES));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_path_add(&walk.path, table, &terrain, &from, entry));
        TEST_ASSERT_EQUAL_UINT(1, walk.path.count);
        check_curve(&walk.pieces[0], &lattice.primitives[i], cell);
    }
    free(lattice.primitives);
}

static void test_every_primitive_is_the_curve_that_its_cells_were_swept_along(void)
{
    for (size_t i = 0; i < LATTICES; i++) {
        check_lattice(lattices[i].file, lattices[i].lattice);
    }
    (void)printf("at most %.2g m off a lattice's curve\n", worst_curve);
}

/* ---- Sequences ---- */

static void check_joint(const struct jp_path_piece *piece, const struct jp_path_pose *next)
{
    const struct lattice_pose end = pose_at(piece, piece->length / Q24);
    const struct lattice_pose begin = pose_of(next);
    const double distance = hypot(end.x - begin.x, end.y - begin.y);

    worst_joint = fmax(worst_joint, distance);
    check_below(distance, JOINT_ERROR + 1e-6 * piece->length / Q24, "m from a piece's end to the next one's begin");
    check_below(turn_between(end.heading, begin.heading), HEADING_ERROR, "rad between them");
}

static bool is_straight(const struct jp_path_piece *piece)
{
    return piece->kind == JP_PIECE_CURVE && piece->bend == 0 && piece->bend_rate == 0;
}

/* What could have become one piece has. */
static void check_merged(const struct jp_path_piece *last, const struct jp_path_piece *next, bool is_level)
{
    TEST_ASSERT_FALSE(last->kind != JP_PIECE_CURVE && last->kind == next->kind);
    TEST_ASSERT_FALSE(is_level && is_straight(last) && is_straight(next));
}

static void check_walk(const struct jp_lattice *lattice, bool is_level)
{
    const struct jp_path_piece *pieces = walk.path.pieces;
    double rise = 0;
    double length = 0;
    double tables = 0;

    for (unsigned i = 0; i + 1 < walk.path.count; i++) {
        const struct jp_path_pose next = {pieces[i + 1].begin, pieces[i + 1].heading};
        check_joint(&pieces[i], &next);
        check_merged(&pieces[i], &pieces[i + 1], is_level);
    }
    check_joint(&pieces[walk.path.count - 1], &walk.path.end);
    for (unsigned i = 0; i < walk.path.count; i++) {
        rise += pieces[i].rise / Q16;
        length += pieces[i].kind == JP_PIECE_CURVE ? pieces[i].length / Q24 : 0;
    }
    for (unsigned i = 0; i < walk.step_count; i++) {
        tables += walk.steps[i]->length / 1000.0;
    }
    const struct jp_lattice_pose *last = &walk.from[walk.step_count - 1];
    const int32_t x = last->x + walk.steps[walk.step_count - 1]->dx;
    const int32_t y = last->y + walk.steps[walk.step_count - 1]->dy;
    check_near((jp_terrain_elevation(&terrain, x, y) - jp_terrain_elevation(&terrain, walk.from[0].x, walk.from[0].y)) /
                   (double)JP_ELEVATION_ONE,
               rise, 1e-9, "m of rise");
    check_near(tables, length, 0.0006 * walk.step_count, "m of length by the lattice's tables");
    TEST_ASSERT_EQUAL_UINT32(lattice->heading[walk.steps[walk.step_count - 1]->end], walk.path.end.heading);
}

static void test_random_sequences(void)
{
    for (unsigned long i = 0; i < options.count; i++) {
        const struct jp_lattice *lattice = lattices[i % LATTICES].lattice;
        const bool is_level = i % 2 == 0;
        const double steepest = is_level ? 0 : 0.25;

        random_path_slope(&terrain, lattice->resolution / Q16, random_uniform(&noise, -steepest, steepest),
                          random_uniform(&noise, -steepest, steepest));
        random_path_walk(&walk, &noise, lattice, &terrain, STEPS);
        check_walk(lattice, is_level);
    }
    (void)printf("%lu paths: at most %.2g m from a piece's end to the next one's begin\n", options.count, worst_joint);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, defaults);
    return RUN_PROPERTY(options, NULL);
}
