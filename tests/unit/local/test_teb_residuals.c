/*
 * Residuals of the TEB over random bands: their sum, and the normal equations of the poses, which teb_solve.h puts
 * together from the terms, against the formulas of joulepath/teb.h in double and their central differences.
 */
#include <string.h>

#include "src/local/teb_residuals.h"

#include "src/local/teb_band.h"
#include "src/local/teb_solve.h"
#include "tests/support/teb_formulas.h"
#include "tests/support/teb_rig.h"

/* Half the way of a central difference, m, rad and s. Of residuals of 1, rounding and the sines' 2⁻²¹ leave 1.2e-4 of a
 * derivative, the third derivatives about as much. */
#define DIFFERENCE 0x1p-8

/* Of a derivative: where the differences to both sides are farther apart, there is a kink between them. */
#define KINK 0.01

/* Of the equations, against the roots of their diagonals. */
#define TOLERANCE 0.01

/* Of a cost. */
#define COST_TOLERANCE 2.0e-4

enum { POSES = 7, BANDS = 12, ROWS = POSES * JP_TEB_BLOCK, RESIDUALS_MAX = 16 * POSES };

static struct exact_residuals low, middle, high;
static double jacobian[RESIDUALS_MAX][ROWS];
static bool is_smooth[ROWS];
static struct jp_teb_factor equations[POSES];
static unsigned compared;

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
    {"second", offsetof(struct jp_teb_weights, second)},
    {"metre", offsetof(struct jp_teb_weights, metre)},
    {"drag", offsetof(struct jp_teb_weights, drag)},
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

static void find_neighbours(void)
{
    teb.internal.work = 0;
    jp_teb_find_feet(&teb);
    jp_teb_find_obstacles(&teb);
}

static void random_problem(const struct jp_teb_config *config)
{
    rig_init(config);
    random_band(1.0f);
    random_task();
    random_obstacles();
    find_neighbours();
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

static void residuals_now(struct exact_residuals *residuals)
{
    struct exact_pose poses[POSES];

    for (unsigned i = 0; i < teb.count; i++) {
        const struct jp_teb_pose *const pose = &teb.poses[i];

        poses[i] = (struct exact_pose){(double)pose->pose.x,   (double)pose->pose.y, (double)pose->pose.heading,
                                       (double)pose->interval, (double)pose->cosine, (double)pose->sine};
    }
    exact_residuals(&teb, poses, residuals);
}

static double cost_of_formulas(void)
{
    double cost = 0.0;

    residuals_now(&middle);
    for (unsigned i = 0; i < middle.count; i++) {
        cost += middle.all[i].weight * exact_square(middle.all[i].value) / 2.0;
    }
    return cost;
}

static float linearise(void)
{
    return jp_teb_linearise(&teb, FLT_MAX);
}

static void assert_cost(void)
{
    const double exact = cost_of_formulas();
    const double size = 1.0 + exact;

    TEST_ASSERT_NEAR((float)COST_TOLERANCE, (float)(exact / size), (float)((double)linearise() / size));
}

static float *variable(unsigned row)
{
    struct jp_teb_pose *const pose = &teb.poses[row / JP_TEB_BLOCK];
    float *const variables[JP_TEB_BLOCK] = {&pose->pose.x, &pose->pose.y, &pose->pose.heading, &pose->interval};

    return variables[row % JP_TEB_BLOCK];
}

static void move_to(unsigned row, float value)
{
    struct jp_teb_pose *const pose = &teb.poses[row / JP_TEB_BLOCK];

    *variable(row) = value;
    jp_teb_set_pose(pose, &(struct jp_plane_pose){pose->pose.x, pose->pose.y, pose->pose.heading});
}

/* A column of the Jacobian; without kinks within the difference: a limit that begins to act, a way that changes its
 * sign, another feature of an obstacle. */
static void differentiate(unsigned row)
{
    const float at = *variable(row);

    move_to(row, at - (float)DIFFERENCE);
    residuals_now(&low);
    move_to(row, at + (float)DIFFERENCE);
    residuals_now(&high);
    move_to(row, at);
    is_smooth[row] = true;
    for (unsigned i = 0; i < middle.count; i++) {
        const double forward = (high.all[i].value - middle.all[i].value) / DIFFERENCE;
        const double backward = (middle.all[i].value - low.all[i].value) / DIFFERENCE;

        jacobian[i][row] = (forward + backward) / 2.0;
        is_smooth[row] =
            is_smooth[row] && exact_magnitude(forward - backward) <= KINK * (1.0 + exact_magnitude(jacobian[i][row]));
    }
}

/* Sum of the products of the derivatives by two variables, weighted. */
static double product(unsigned row, unsigned column)
{
    double sum = 0.0;

    for (unsigned i = 0; i < middle.count; i++) {
        sum += middle.all[i].weight * jacobian[i][row] * jacobian[i][column];
    }
    return sum;
}

static double gradient(unsigned row)
{
    double sum = 0.0;

    for (unsigned i = 0; i < middle.count; i++) {
        sum += middle.all[i].weight * jacobian[i][row] * middle.all[i].value;
    }
    return sum;
}

static double larger(double a, double b)
{
    return a > b ? a : b;
}

static void assert_near(double expected, float actual, double size)
{
    const double scale = size + 0.05;

    TEST_ASSERT_NEAR((float)TOLERANCE, (float)(expected / scale), (float)((double)actual / scale));
    compared++;
}

static float of_row(const struct jp_teb_row *row, unsigned variable_of)
{
    const float values[JP_TEB_BLOCK] = {row->x, row->y, row->heading, row->interval};

    return values[variable_of];
}

/* The entry of the equations; in the lower triangle of the band. */
static float entry(unsigned row, unsigned column)
{
    const struct jp_teb_factor *const rows = &equations[row / JP_TEB_BLOCK];
    const struct jp_teb_triangle *const own = &rows->own;
    const float triangle[JP_TEB_BLOCK][JP_TEB_BLOCK] = {
        {own->xx},
        {own->yx, own->yy},
        {own->heading_x, own->heading_y, own->heading_heading},
        {own->interval_x, own->interval_y, own->interval_heading, own->interval_interval}};
    const unsigned apart = row / JP_TEB_BLOCK - column / JP_TEB_BLOCK;
    const unsigned i = row % JP_TEB_BLOCK;
    const unsigned k = column % JP_TEB_BLOCK;

    if (apart == 0U) {
        return triangle[i][k];
    }
    if (apart == 1U) {
        return of_row(&rows->near[i], k);
    }
    return apart == 2U && i < 3U ? of_row(&rows->far[i], k) : 0.0f;
}

static void compare_row(unsigned row)
{
    assert_near(-gradient(row), of_row(&equations[row / JP_TEB_BLOCK].step, row % JP_TEB_BLOCK),
                larger(product(row, row), exact_magnitude(gradient(row))));
    for (unsigned column = 0; column <= row; column++) {
        if (is_smooth[column]) {
            assert_near(product(row, column), entry(row, column), larger(product(row, row), product(column, column)));
        }
    }
}

/* Those of the start and the goal, which are fixed at times, apart. */
static void assert_equations(void)
{
    const unsigned end = JP_TEB_BLOCK * (teb.count - 1U);

    (void)linearise();
    teb.internal.kept_terms ^= 1U;
    residuals_now(&middle);
    TEST_ASSERT_TRUE(middle.count <= RESIDUALS_MAX);
    for (unsigned row = 0; row < end; row++) {
        differentiate(row);
    }
    for (unsigned i = 0; i < teb.count; i++) {
        jp_teb_assemble(&teb, i, &equations[i]);
    }
    for (unsigned row = 0; row < end; row++) {
        if (is_smooth[row]) {
            compare_row(row);
        }
    }
}

static bool is_wheels(unsigned term)
{
    /* Alone they are no residual but where the band begins. */
    return terms[term].offset == offsetof(struct jp_teb_weights, wheel_odometry);
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
        if (!is_wheels(term)) {
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

static void test_equations_of_each_term(void)
{
    for (unsigned term = 0; term < TERMS; term++) {
        struct jp_teb_config config = config_of_term(term);

        /* Otherwise the start is fixed. */
        config.weights.laser_odometry += 1e-3f;
        compared = 0;
        for (unsigned band = 0; band < BANDS; band++) {
            random_problem(&config);
            assert_equations();
        }
        TEST_ASSERT_TRUE_MESSAGE(compared > 500U, terms[term].name);
    }
}

static void test_equations_of_all_terms(void)
{
    const struct jp_teb_config config = config_of_all_terms();

    for (unsigned band = 0; band < 4U * BANDS; band++) {
        random_problem(&config);
        assert_equations();
    }
    TEST_ASSERT_TRUE(compared > 2000U);
}

/* ---- What is left out ---- */

static void test_cost_that_reaches_the_limit_is_not_completed(void)
{
    const struct jp_teb_config config = config_of_all_terms();

    random_problem(&config);

    const float whole = linearise();

    for (unsigned share = 1; share <= 20U; share++) {
        const float limit = 0.05f * (float)share * whole;
        const float part = jp_teb_linearise(&teb, limit);

        TEST_ASSERT_TRUE(part >= limit && part <= whole);
    }
    TEST_ASSERT_TRUE(jp_teb_linearise(&teb, 1.01f * whole) == whole);
    TEST_ASSERT_TRUE(jp_teb_linearise(&teb, 0.05f * whole) < whole);
}

/* Half a metre in a second, at 0.5 m/s: what a second, a metre and drag cost, and the smoothing of four steps. */
static void test_band_within_all_limits_costs_its_energy(void)
{
    struct jp_teb_config config = config_of_all_terms();

    config.weights.second = 2.0f;
    config.weights.metre = 3.0f;
    config.weights.drag = 5.0f;
    rig_init(&config);
    teb.internal.task = task;
    teb.internal.task.speed.forward = 0.5f;
    teb.internal.task.goal_speed = 0.5f;
    teb.internal.obstacles = &obstacles;
    teb.count = 5;
    for (unsigned i = 0; i < teb.count; i++) {
        set_pose(i, 0.125f * (float)i, 0.0f, 0.0f, 0.25f);
    }
    find_neighbours();
    TEST_ASSERT_NEAR(1e-5f, 2.0f * 1.0f + 3.0f * 4.0f * 0.1253994f + 5.0f * 0.5f * 0.5f, linearise());
}

/* Nothing ties it to others, and nothing pulls it. */
static bool is_fixed(unsigned row)
{
    bool is_alone = entry(row, row) == 1.0f;

    for (unsigned other = 0; other < JP_TEB_BLOCK * teb.count; other++) {
        is_alone = is_alone && (other == row || entry(row > other ? row : other, row > other ? other : row) == 0.0f);
    }
    return is_alone && of_row(&equations[row / JP_TEB_BLOCK].step, row % JP_TEB_BLOCK) == 0.0f;
}

static void assert_fixed(bool start, bool goal_heading)
{
    const unsigned last = JP_TEB_BLOCK * (teb.count - 1U);

    (void)linearise();
    teb.internal.kept_terms ^= 1U;
    for (unsigned i = 0; i < teb.count; i++) {
        jp_teb_assemble(&teb, i, &equations[i]);
    }
    for (unsigned row = 0; row < last; row++) {
        TEST_ASSERT_TRUE(is_fixed(row) == (start && row < 3U));
    }
    TEST_ASSERT_TRUE(is_fixed(last) && is_fixed(last + 1U));
    TEST_ASSERT_TRUE(is_fixed(last + 2U) == goal_heading);
    /* No interval begins there. */
    TEST_ASSERT_TRUE(equations[teb.count - 1U].own.interval_interval == 0.0f);
}

static void test_with_both_odometries_only_the_goal_is_fixed(void)
{
    const struct jp_teb_config config = config_of_all_terms();

    random_problem(&config);
    assert_fixed(false, true);
}

static void test_heading_of_the_goal_can_be_free(void)
{
    const struct jp_teb_config config = config_of_all_terms();

    random_problem(&config);
    teb.internal.task.is_heading_free = true;
    assert_fixed(false, false);
}

static void test_without_a_measurement_the_start_is_fixed(void)
{
    struct jp_teb_config config = config_of_all_terms();

    random_problem(&config);
    teb.internal.task.is_measured = false;
    assert_fixed(true, true);

    config.weights.laser_odometry = 0.0f;
    random_problem(&config);
    assert_fixed(true, true);
}

static void test_obstacles_out_of_reach_cost_nothing(void)
{
    const struct jp_teb_config config = config_of_term(6);

    random_problem(&config);

    const struct jp_plane_pose *const pose = &teb.poses[3].pose;

    jp_obstacles_clear(&obstacles, &(struct jp_plane_point){0.0f, 0.0f});
    rig_disc(pose->x + 5.0f, pose->y, 0.1f);
    find_neighbours();
    TEST_ASSERT_TRUE(linearise() == 0.0f);
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
    find_neighbours();
    TEST_ASSERT_TRUE(linearise() == 0.0f);
    set_pose(1, 0.0f, 0.3f, 0.0f, 0.25f);
    /* ½ · 3 · (0.1 − 0.05)² */
    TEST_ASSERT_NEAR(1e-5f, 0.00375f, linearise());
}
