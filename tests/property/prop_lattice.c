/*
 * The tables of all lattices against an oracle of their own, without libccd: the footprint is sampled densely along
 * each primitive, and the distance of a rectangle from a cell is taken by projection on their four axes, that of a disc
 * from its middle. The paths come from the generator; that they obey the robot's motion and end where the tables say is
 * checked too.
 */
#include <joulepath/lattice.h>
#include <joulepath/tables.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "sim/lattice/lattice_generate.h"
#include "unity.h"

/* Cells between the samples of the footprint, both ways. */
#define SPACING 0.08

/* How far from the footprint a swept cell may be, cells: what the sweep grows it by. */
#define MARGIN 0.01

/* Between the poses of a path, in equal parts. */
enum { PARTS = 3 };

/* The third is a disc. */
enum { LATTICES = 3 };

static const char *const files[LATTICES] = {"sim/robots/zhang2018.cfg", "sim/robots/gao2018.cfg",
                                            "sim/robots/courier24.cfg"};
static struct lattice_robot robots[LATTICES];
static struct lattice lattices[LATTICES];
static const struct jp_lattice *const tables[LATTICES] = {&jp_lattice_zhang2018, &jp_lattice_gao2018,
                                                          &jp_lattice_courier24};

void setUp(void)
{
}

void tearDown(void)
{
}

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

static bool has_cell(const struct jp_lattice *table, unsigned first, unsigned count, int x, int y)
{
    for (unsigned i = first; i < first + count; i++) {
        const struct jp_span span = table->spans[i];
        if (span.y == y && span.first <= x && x <= span.last) {
            return true;
        }
    }
    return false;
}

/* Pose between two of a path. */
static struct lattice_pose between(const struct lattice_pose *from, const struct lattice_pose *to, double share)
{
    return (struct lattice_pose){from->x + (to->x - from->x) * share, from->y + (to->y - from->y) * share,
                                 from->heading + (to->heading - from->heading) * share};
}

/* Of a side of the footprint, cells. */
static double half_of(const struct lattice_robot *robot, double side)
{
    return (robot->radius_m > 0 ? robot->radius_m : side / 2) / robot->cell_m;
}

/* Points of the footprint that fall on cells which are not in the table. */
static unsigned missed_at(const struct jp_lattice *table, const struct jp_primitive *entry,
                          const struct lattice_robot *robot, const struct lattice_pose *pose)
{
    const double half_length = half_of(robot, robot->length_m);
    const double half_width = half_of(robot, robot->width_m);
    const int along = (int)ceil(2 * half_length / SPACING);
    const int across = (int)ceil(2 * half_width / SPACING);
    const double cosine = cos(pose->heading);
    const double sine = sin(pose->heading);
    unsigned missed = 0;

    for (int i = 0; i <= along; i++) {
        for (int j = 0; j <= across; j++) {
            const double u = half_length * (2.0 * i / along - 1);
            /* A disc's widths shrink to its ends. */
            const double widest = robot->radius_m > 0 ? sqrt(half_width * half_width - u * u) : half_width;
            const double v = widest * (2.0 * j / across - 1);
            const int x = (int)floor(pose->x + cosine * u - sine * v + 0.5);
            const int y = (int)floor(pose->y + sine * u + cosine * v + 0.5);
            missed += !has_cell(table, entry->first_span, entry->span_count, x, y);
        }
    }
    return missed;
}

static void expect_all_points_swept(size_t robot)
{
    const struct lattice *lattice = &lattices[robot];
    unsigned long poses = 0;

    for (size_t i = 0; i < lattice->count; i++) {
        const struct lattice_primitive *primitive = &lattice->primitives[i];
        const struct jp_primitive *entry = entry_of(tables[robot], primitive);
        TEST_ASSERT_NOT_NULL(entry);
        for (size_t p = 1; p < primitive->path.count; p++) {
            for (int part = p == 1 ? 0 : 1; part <= PARTS; part++) {
                const struct lattice_pose pose =
                    between(&primitive->path.poses[p - 1], &primitive->path.poses[p], (double)part / PARTS);
                TEST_ASSERT_EQUAL_UINT(0, missed_at(tables[robot], entry, lattice->robot, &pose));
                poses++;
            }
        }
    }
    printf("%s: no cell missed at %lu poses\n", lattice->robot->name, poses);
}

static void test_every_point_under_the_robot_is_swept(void)
{
    for (size_t robot = 0; robot < LATTICES; robot++) {
        expect_all_points_swept(robot);
    }
}

static double gap(double centre, double half, double other_centre, double other_half)
{
    return fabs(centre - other_centre) - half - other_half;
}

/* Largest gap between the footprint and a cell along the axes of either; at most 0 when they overlap. */
static double gap_to_cell(const struct lattice_robot *robot, const struct lattice_pose *pose, int x, int y)
{
    const double half_length = half_of(robot, robot->length_m);
    const double half_width = half_of(robot, robot->width_m);
    const double cosine = fabs(cos(pose->heading));
    const double sine = fabs(sin(pose->heading));
    const double cell_half = (cosine + sine) / 2; /* along either axis of the robot */
    const double dx = x - pose->x;
    const double dy = y - pose->y;
    const double along = cos(pose->heading) * dx + sin(pose->heading) * dy;
    const double across = cos(pose->heading) * dy - sin(pose->heading) * dx;

    if (robot->radius_m > 0) {
        return hypot(fmax(fabs(dx) - 0.5, 0), fmax(fabs(dy) - 0.5, 0)) - half_length;
    }
    const double on_x = gap(dx, 0.5, 0, cosine * half_length + sine * half_width);
    const double on_y = gap(dy, 0.5, 0, sine * half_length + cosine * half_width);

    return fmax(fmax(on_x, on_y), fmax(gap(along, cell_half, 0, half_length), gap(across, cell_half, 0, half_width)));
}

static double nearest_gap(const struct lattice_robot *robot, const struct lattice_path *path, int x, int y)
{
    double least = INFINITY;

    for (size_t p = 0; p < path->count; p++) {
        least = fmin(least, gap_to_cell(robot, &path->poses[p], x, y));
    }
    return least;
}

static void test_no_cell_beside_the_robot_is_swept(void)
{
    double widest = -INFINITY;

    for (size_t robot = 0; robot < LATTICES; robot++) {
        for (size_t i = 0; i < lattices[robot].count; i++) {
            const struct lattice_primitive *primitive = &lattices[robot].primitives[i];
            const struct jp_primitive *entry = entry_of(tables[robot], primitive);
            TEST_ASSERT_NOT_NULL(entry);
            for (unsigned s = entry->first_span; s < entry->first_span + entry->span_count; s++) {
                const struct jp_span span = tables[robot]->spans[s];
                for (int x = span.first; x <= span.last; x++) {
                    widest = fmax(widest, nearest_gap(&robots[robot], &primitive->path, x, span.y));
                }
            }
        }
    }
    printf("the swept cell that is touched least: %.4f cells from the robot\n", widest);
    TEST_ASSERT_TRUE(widest <= MARGIN);
}

static void test_footprints(void)
{
    for (size_t robot = 0; robot < LATTICES; robot++) {
        for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
            const struct jp_cells cells = tables[robot]->footprint[heading];
            const struct lattice_pose pose = {0, 0, lattices[robot].headings[heading]};
            for (int cell = 0; cell < 81; cell++) {
                const int x = cell % 9 - 4;
                const int y = cell / 9 - 4;
                const double distance = gap_to_cell(&robots[robot], &pose, x, y);
                if (fabs(distance) > 1e-3) {
                    TEST_ASSERT_EQUAL(distance < 0, has_cell(tables[robot], cells.first_span, cells.span_count, x, y));
                }
            }
        }
    }
}

/* The robot drives where it looks, forwards, and no faster than it may; the path ends on the end state. */
static void expect_drivable(const struct lattice *lattice, const struct lattice_primitive *primitive)
{
    const struct lattice_path *path = &primitive->path;
    const struct lattice_pose *last = &path->poses[path->count - 1];
    const double speed = primitive->length_m / primitive->duration_s;

    TEST_ASSERT_DOUBLE_WITHIN(1e-9, primitive->dx, last->x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, primitive->dy, last->y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, remainder(last->heading - lattice->headings[primitive->end], 2 * LATTICE_PI));
    TEST_ASSERT_TRUE(speed <= lattice->robot->speed_max * (1 + 1e-9));
    for (size_t i = 1; i < path->count; i++) {
        const struct lattice_pose *from = &path->poses[i - 1];
        const struct lattice_pose *to = &path->poses[i];
        const double middle = (from->heading + to->heading) / 2;
        const double dx = to->x - from->x;
        const double dy = to->y - from->y;
        const double step = hypot(dx, dy) * lattice->resolution_m;
        const double seconds =
            primitive->length_m > 0 ? step / speed : primitive->duration_s / (double)(path->count - 1);
        TEST_ASSERT_TRUE(fabs(to->heading - from->heading) <= lattice->robot->turn_rate_max * seconds * (1 + 1e-6));
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, dy * cos(middle) - dx * sin(middle));
        TEST_ASSERT_TRUE(dx * cos(middle) + dy * sin(middle) >= 0);
    }
}

static void test_primitives_are_drivable(void)
{
    for (size_t robot = 0; robot < LATTICES; robot++) {
        for (size_t i = 0; i < lattices[robot].count; i++) {
            expect_drivable(&lattices[robot], &lattices[robot].primitives[i]);
        }
    }
}

/* The chain of unit steps stays near the path, and is hardly longer. */
static void test_moves_follow_the_path(void)
{
    double farthest = 0;
    double longest = 0;

    for (size_t robot = 0; robot < LATTICES; robot++) {
        for (size_t i = 0; i < lattices[robot].count; i++) {
            const struct lattice_primitive *primitive = &lattices[robot].primitives[i];
            double length = 0;
            int x = 0;
            int y = 0;
            for (size_t m = 0; m < primitive->move_count; m++) {
                const struct jp_cell_offset offset = jp_move_offsets[primitive->moves[m]];
                double nearest = INFINITY;
                x += offset.dx;
                y += offset.dy;
                length += hypot(offset.dx, offset.dy);
                for (size_t p = 0; p < primitive->path.count; p++) {
                    nearest = fmin(nearest, hypot(primitive->path.poses[p].x - x, primitive->path.poses[p].y - y));
                }
                farthest = fmax(farthest, nearest);
            }
            if (primitive->move_count > 0) {
                longest = fmax(longest, length * lattices[robot].resolution_m / primitive->length_m);
            }
        }
    }
    printf("unit steps: at most %.3f cells from the path, %.4f of its length\n", farthest, longest);
    TEST_ASSERT_TRUE(farthest <= 0.5);
    TEST_ASSERT_TRUE(longest <= 1.028); /* what a 16-neighbour way is at most longer than a straight one */
}

int main(void)
{
    UNITY_BEGIN();
    for (size_t robot = 0; robot < LATTICES; robot++) {
        TEST_ASSERT_TRUE(lattice_robot_load(files[robot], &robots[robot]));
        lattices[robot] = (struct lattice){.robot = &robots[robot], .resolution_m = robots[robot].cell_m};
        TEST_ASSERT_TRUE(lattice_generate(&lattices[robot]));
    }
    run_tests();
    for (size_t robot = 0; robot < LATTICES; robot++) {
        free(lattices[robot].primitives);
    }
    return UNITY_END();
}
