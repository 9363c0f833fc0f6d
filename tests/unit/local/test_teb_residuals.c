/*
 * Residuals of the TEB: their sum against the formulas of joulepath/teb.h in double, and every analytic derivative of
 * every single residual against central differences, over random bands.
 *
 * The functions of teb_solve.h are those of this file: they record the residuals instead of summing them up.
 */
#include <string.h>

#include "src/local/teb_residuals.h"

#include "src/local/teb_band.h"
#include "src/local/teb_solve.h"
#include "tests/support/teb_formulas.h"
#include "tests/support/teb_rig.h"

/* Half the way of a central difference, m, rad and s. Of residuals of 1, rounding and the sines' 2⁻²¹ leave 1.2e-4 of a
 * derivative, the third derivatives about as much. */
#define DIFFERENCE 0x1p-8f

/* Of a derivative's own size, and of the residual's largest derivative. */
#define TOLERANCE       0.004f
#define TOLERANCE_LEAST 0.002f

/* Of a cost. */
#define COST_TOLERANCE 2.0e-4

enum { POSES = 7, BANDS = 12, RECORDS_MAX = 256 };

struct record {
    unsigned first;
    unsigned width;
    float derivatives[JP_TEB_BAND];
    float residual;
};

static struct recording {
    struct record records[RECORDS_MAX];
    unsigned count;
} recording, before, after;

static struct recording *current;
static bool is_fixed[JP_TEB_ROWS];
static unsigned compared;

void jp_teb_clear_equations(struct jp_teb *band)
{
    (void)band;
    current->count = 0;
    memset(is_fixed, 0, sizeof is_fixed);
}

void jp_teb_add_residual(struct jp_teb *band, unsigned first, unsigned width, const float *derivatives, float residual)
{
    struct record *const record = &current->records[current->count++];

    (void)band;
    TEST_ASSERT_TRUE(current->count <= RECORDS_MAX);
    TEST_ASSERT_TRUE(width <= JP_TEB_BAND);
    *record = (struct record){.first = first, .width = width, .residual = residual};
    memcpy(record->derivatives, derivatives, width * sizeof derivatives[0]);
}

void jp_teb_fix(struct jp_teb *band, unsigned row)
{
    (void)band;
    is_fixed[row] = true;
}

bool jp_teb_solve(struct jp_teb *band)
{
    (void)band;
    return false;
}

void setUp(void)
{
    rig_reset();
    compared = 0;
}

void tearDown(void)
{
}

/* ---- Random bands ---- */

static const struct {
    const char *name;
    size_t offset;
} terms[] = {
    {"nonholonomic", offsetof(struct jp_teb_weights, nonholonomic)},
    {"speed", offsetof(struct jp_teb_weights, speed)},
    {"turn rate", offsetof(struct jp_teb_weights, turn_rate)},
    {"turn radius", offsetof(struct jp_teb_weights, turn_radius)},
    {"acceleration", offsetof(struct jp_teb_weights, acceleration)},
    {"turn acceleration", offsetof(struct jp_teb_weights, turn_acceleration)},
    {"obstacle", offsetof(struct jp_teb_weights, obstacle)},
    {"path", offsetof(struct jp_teb_weights, path)},
    {"time", offsetof(struct jp_teb_weights, time)},
    {"slowness", offsetof(struct jp_teb_weights, slowness)},
    {"no reversing", offsetof(struct jp_teb_weights, no_reversing)},
    {"wheel odometry", offsetof(struct jp_teb_weights, wheel_odometry)},
    {"laser odometry", offsetof(struct jp_teb_weights, laser_odometry)},
};

enum { TERMS = sizeof terms / sizeof terms[0] };

static float *weight(struct jp_teb_config *config, unsigned term)
{
    return (float *)(void *)((char *)&config->weights + terms[term].offset);
}

static void set_pose(unsigned i, float x, float y, float heading, float interval)
{
    const struct jp_plane_pose pose = {x, y, jp_plane_wrap(heading)};

    jp_teb_set_pose(&teb.poses[i], &pose);
    teb.poses[i].interval = interval;
}

/* Forward, backward and sideways steps, turns to both sides; `scale` of about 1 keeps about half of the limits. */
static void random_band(float scale)
{
    float x = 1.0f;
    float y = -1.0f;
    float heading = rig_random(JP_PLANE_PI);

    teb.count = POSES;
    for (unsigned i = 0; i < POSES; i++) {
        set_pose(i, x, y, heading, 0.25f + rig_random(0.1f));
        x += scale * rig_random(0.4f);
        y += scale * rig_random(0.4f);
        heading += scale * rig_random(0.5f);
    }
}

static void random_task(void)
{
    const struct jp_plane_pose *const first = &teb.poses[0].pose;

    task.start = (struct jp_plane_pose){first->x + rig_random(0.1f), first->y + rig_random(0.1f),
                                        first->heading + rig_random(0.2f)};
    task.measured = (struct jp_plane_pose){first->x + rig_random(0.1f), first->y + rig_random(0.1f),
                                           first->heading + rig_random(0.2f)};
    task.is_measured = true;
    task.speed = (struct jp_plane_speed){rig_random(1.0f), rig_random(1.0f)};
    task.goal_speed = 0.3f;
    teb.internal.task = task;
}

/* Discs and odd boxes, whose sides are parallel to none of the footprint's. */
static void random_obstacles(void)
{
    const struct jp_plane_point centre = {1.0f, -1.0f};

    jp_obstacles_clear(&obstacles, &centre);
    for (unsigned i = 0; i < 8U; i++) {
        const float x = 1.0f + rig_random(1.2f);
        const float y = -1.0f + rig_random(1.2f);

        if (i % 2U == 0U) {
            rig_disc(x, y, 0.1f);
        } else {
            const struct jp_obstacle odd = {.vertices = {{x, y}, {x + 0.23f, y + 0.09f}, {x + 0.11f, y + 0.27f}},
                                            .vertex_count = 3};

            TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add(&obstacles, &odd));
        }
    }
    for (unsigned i = 0; i < obstacles.count; i++) {
        obstacles.shapes[i].velocity = (struct jp_plane_point){rig_random(0.2f), rig_random(0.2f)};
    }
    teb.internal.obstacles = &obstacles;
}

static void random_problem(const struct jp_teb_config *config)
{
    rig_init(config);
    random_band(1.0f);
    random_task();
    random_obstacles();
    jp_teb_associate(&teb);
}

static struct jp_teb_config config_of_term(unsigned term)
{
    struct jp_teb_config config = rig_band();

    config.weights = (struct jp_teb_weights){0};
    *weight(&config, term) = 3.0f;
    return config;
}

/* All of them about as strong. */
static struct jp_teb_config config_of_all_terms(void)
{
    struct jp_teb_config config = rig_band();

    for (unsigned term = 0; term < TERMS; term++) {
        *weight(&config, term) = 1.0f + 0.25f * (float)term;
    }
    return config;
}

/* ---- Comparisons ---- */

static double cost_of_formulas(void)
{
    struct exact_pose poses[POSES];

    for (unsigned i = 0; i < teb.count; i++) {
        const struct jp_teb_pose *const pose = &teb.poses[i];

        poses[i] = (struct exact_pose){(double)pose->pose.x,   (double)pose->pose.y, (double)pose->pose.heading,
                                       (double)pose->interval, (double)pose->cosine, (double)pose->sine};
    }
    return exact_cost(&teb, poses);
}

static float linearise(struct recording *into)
{
    current = into;
    return jp_teb_linearise(&teb, FLT_MAX);
}

static void assert_cost(void)
{
    const double exact = cost_of_formulas();

    TEST_ASSERT_NEAR((float)(COST_TOLERANCE * (1.0 + exact)), (float)exact, linearise(&recording));
}

static float *variable(unsigned row)
{
    struct jp_teb_pose *const pose = &teb.poses[row / JP_TEB_BLOCK];
    float *const variables[JP_TEB_BLOCK] = {&pose->pose.x, &pose->pose.y, &pose->pose.heading, &pose->interval};

    return variables[row % JP_TEB_BLOCK];
}

static void move(unsigned row, float way)
{
    struct jp_teb_pose *const pose = &teb.poses[row / JP_TEB_BLOCK];

    *variable(row) += way;
    jp_teb_set_pose(pose, &(struct jp_plane_pose){pose->pose.x, pose->pose.y, pose->pose.heading});
}

/* Whether the same residuals act, so that one can be subtracted from the other. */
static bool are_alike(const struct recording *a, const struct recording *b)
{
    bool alike = a->count == b->count;

    for (unsigned i = 0; alike && i < a->count; i++) {
        alike = a->records[i].first == b->records[i].first && a->records[i].width == b->records[i].width;
    }
    return alike;
}

static float derivative_of(const struct record *record, unsigned row)
{
    const unsigned first = record->first * JP_TEB_BLOCK;

    return row >= first && row < first + record->width ? record->derivatives[row - first] : 0.0f;
}

static float largest_derivative(const struct record *record)
{
    float largest = 0.0f;

    for (unsigned i = 0; i < record->width; i++) {
        const float size = jp_plane_magnitude(record->derivatives[i]);

        largest = size > largest ? size : largest;
    }
    return largest;
}

/* Central; one-sided where the residual has a kink within the difference: the nearest feature of an obstacle changes,
 * a way changes its sign. */
static bool is_derivative(float analytic, float low, float middle, float high, float tolerance)
{
    const float central = (high - low) / (2.0f * DIFFERENCE);
    const float forward = (high - middle) / DIFFERENCE;
    const float backward = (middle - low) / DIFFERENCE;

    return jp_plane_is_within(analytic - central, tolerance) || jp_plane_is_within(analytic - forward, tolerance) ||
           jp_plane_is_within(analytic - backward, tolerance);
}

static void compare_derivatives(unsigned row)
{
    for (unsigned i = 0; i < recording.count; i++) {
        const struct record *const record = &recording.records[i];
        const float analytic = derivative_of(record, row);
        const float tolerance =
            TOLERANCE * jp_plane_magnitude(analytic) + TOLERANCE_LEAST * (1.0f + largest_derivative(record));

        TEST_ASSERT_TRUE(is_derivative(analytic, before.records[i].residual, record->residual,
                                       after.records[i].residual, tolerance));
        compared++;
    }
}

/* Where a limit begins to act within the difference, the rows are left out; so few that enough remain. */
static void assert_derivatives(void)
{
    (void)linearise(&recording);
    for (unsigned row = 0; row < (unsigned)JP_TEB_BLOCK * teb.count; row++) {
        const float at = *variable(row);

        move(row, DIFFERENCE);
        (void)linearise(&after);
        move(row, -2.0f * DIFFERENCE);
        (void)linearise(&before);
        *variable(row) = at;
        move(row, 0.0f);
        if (are_alike(&recording, &before) && are_alike(&recording, &after)) {
            compare_derivatives(row);
        }
    }
}

static void test_cost_of_each_term_is_the_formula(void)
{
    for (unsigned term = 0; term < TERMS; term++) {
        const struct jp_teb_config config = config_of_term(term);
        double sum = 0.0;

        for (unsigned band = 0; band < BANDS; band++) {
            random_problem(&config);
            assert_cost();
            sum += cost_of_formulas();
        }
        /* The wheels alone are no residual but where the band begins. */
        if (terms[term].offset != offsetof(struct jp_teb_weights, wheel_odometry)) {
            TEST_ASSERT_TRUE_MESSAGE(sum > 0.0, terms[term].name);
        }
    }
}

static void test_cost_of_all_terms_is_the_formula(void)
{
    const struct jp_teb_config config = config_of_all_terms();

    for (unsigned band = 0; band < BANDS; band++) {
        random_problem(&config);
        assert_cost();
    }
}

static void test_cost_is_half_the_sum_of_the_squares(void)
{
    const struct jp_teb_config config = config_of_all_terms();

    for (unsigned band = 0; band < BANDS; band++) {
        random_problem(&config);

        const float cost = linearise(&recording);
        double sum = 0.0;

        for (unsigned i = 0; i < recording.count; i++) {
            sum += exact_square((double)recording.records[i].residual) / 2.0;
        }
        TEST_ASSERT_NEAR((float)(COST_TOLERANCE * (1.0 + sum)), (float)sum, cost);
    }
}

static void test_derivatives_of_each_term(void)
{
    for (unsigned term = 0; term < TERMS; term++) {
        const struct jp_teb_config config = config_of_term(term);

        compared = 0;
        for (unsigned band = 0; band < BANDS; band++) {
            random_problem(&config);
            assert_derivatives();
        }
        if (terms[term].offset != offsetof(struct jp_teb_weights, wheel_odometry)) {
            TEST_ASSERT_TRUE_MESSAGE(compared > 50U, terms[term].name);
        }
    }
}

static void test_derivatives_of_all_terms(void)
{
    const struct jp_teb_config config = config_of_all_terms();

    for (unsigned band = 0; band < BANDS; band++) {
        random_problem(&config);
        assert_derivatives();
    }
    TEST_ASSERT_TRUE(compared > 1000U);
}

/* ---- What is left out ---- */

static void test_cost_that_reaches_the_limit_is_not_completed(void)
{
    const struct jp_teb_config config = config_of_all_terms();

    random_problem(&config);

    const float whole = linearise(&recording);
    const unsigned residuals = recording.count;

    for (unsigned share = 1; share <= 20U; share++) {
        const float limit = 0.05f * (float)share * whole;
        const float part = jp_teb_linearise(&teb, limit);

        TEST_ASSERT_TRUE(part >= limit && part <= whole);
        TEST_ASSERT_TRUE(recording.count <= residuals);
    }
    TEST_ASSERT_TRUE(jp_teb_linearise(&teb, 1.01f * whole) == whole);
    (void)jp_teb_linearise(&teb, 0.05f * whole);
    TEST_ASSERT_TRUE(recording.count < residuals);
}

static void test_band_within_all_limits_costs_its_time(void)
{
    struct jp_teb_config config = config_of_all_terms();

    config.weights.time = 2.0f;
    config.weights.slowness = 0.0f;
    rig_init(&config);
    teb.internal.task = task;
    teb.internal.task.speed.forward = 0.5f;
    teb.internal.task.goal_speed = 0.5f;
    teb.internal.obstacles = &obstacles;
    teb.count = 5;
    for (unsigned i = 0; i < teb.count; i++) {
        set_pose(i, 0.125f * (float)i, 0.0f, 0.0f, 0.25f);
    }
    jp_teb_associate(&teb);
    /* Four intervals of 0.25 s: ½ · 2 · 4 · 0.25². */
    TEST_ASSERT_NEAR(1e-5f, 0.25f, linearise(&recording));
}

static unsigned count_fixed(void)
{
    unsigned count = 0;

    for (unsigned i = 0; i < JP_TEB_ROWS; i++) {
        count += is_fixed[i] ? 1U : 0U;
    }
    return count;
}

static void assert_fixed(unsigned pose, bool position, bool heading, bool interval)
{
    const unsigned row = pose * JP_TEB_BLOCK;

    TEST_ASSERT_TRUE(is_fixed[row] == position);
    TEST_ASSERT_TRUE(is_fixed[row + 1U] == position);
    TEST_ASSERT_TRUE(is_fixed[row + 2U] == heading);
    TEST_ASSERT_TRUE(is_fixed[row + 3U] == interval);
}

static void test_with_both_odometries_only_the_goal_is_fixed(void)
{
    const struct jp_teb_config config = config_of_all_terms();

    random_problem(&config);
    (void)linearise(&recording);
    assert_fixed(0, false, false, false);
    assert_fixed(POSES - 1, true, true, true);
    TEST_ASSERT_EQUAL_UINT(4, count_fixed());
}

static void test_heading_of_the_goal_can_be_free(void)
{
    const struct jp_teb_config config = config_of_all_terms();

    random_problem(&config);
    teb.internal.task.is_heading_free = true;
    (void)linearise(&recording);
    assert_fixed(POSES - 1, true, false, true);
    TEST_ASSERT_EQUAL_UINT(3, count_fixed());
}

static void test_without_a_measurement_the_start_is_fixed(void)
{
    struct jp_teb_config config = config_of_all_terms();

    random_problem(&config);
    teb.internal.task.is_measured = false;
    (void)linearise(&recording);
    assert_fixed(0, true, true, false);
    TEST_ASSERT_EQUAL_UINT(7, count_fixed());

    config.weights.laser_odometry = 0.0f;
    random_problem(&config);
    (void)linearise(&recording);
    assert_fixed(0, true, true, false);
    TEST_ASSERT_EQUAL_UINT(7, count_fixed());
}

static void test_obstacles_out_of_reach_cost_nothing(void)
{
    const struct jp_teb_config config = config_of_term(6);

    random_problem(&config);

    const struct jp_plane_pose *const pose = &teb.poses[3].pose;

    jp_obstacles_clear(&obstacles, &(struct jp_plane_point){0.0f, 0.0f});
    rig_disc(pose->x + 5.0f, pose->y, 0.1f);
    jp_teb_associate(&teb);
    TEST_ASSERT_TRUE(linearise(&recording) == 0.0f);
}

/* What was found far away acts when the band has come near. */
static void test_obstacle_acts_when_the_band_has_come_near(void)
{
    const struct jp_teb_config config = config_of_term(6);

    rig_init(&config);
    teb.internal.task = task;
    teb.internal.obstacles = &obstacles;
    teb.count = 3;
    rig_disc(0.0f, 0.65f, 0.0f); /* 0.35 m from the footprint */
    for (unsigned i = 0; i < teb.count; i++) {
        set_pose(i, 0.0f, 0.0f, 0.0f, 0.25f);
    }
    jp_teb_associate(&teb);
    TEST_ASSERT_TRUE(linearise(&recording) == 0.0f);
    set_pose(1, 0.0f, 0.3f, 0.0f, 0.25f);
    /* ½ · 3 · (0.1 − 0.05)² */
    TEST_ASSERT_NEAR(1e-5f, 0.00375f, linearise(&recording));
}
