/*
 * The learner on the simulated robots: they drive chains of segments of 0.5 s to 10 s back to back, learn from their
 * own meter and forecast what the next 20 segments take; friction or payload change in mid-drive. And 10⁷ updates on
 * random segments, hours of them without excitation. Prints figures as JSON, progress on stderr.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "sim/balancer/variation.h"
#include "sim/base/parallel.h"
#include "sim/base/progress.h"
#include "tests/bench/figures.h"
#include "tests/support/chain.h"

enum {
    BEFORE = 40,   /* segments until the change */
    TAUGHT = 20,   /* after it, from which it is learned */
    FORECAST = 20, /* forecast then */
    SEGMENTS = BEFORE + TAUGHT + FORECAST,
    DRIVES = 20, /* of each scenario */
    SEED = 20180917,
    UPDATES = 10000000,
    STRETCHES = 20, /* of the updates, see enum stretch */
    CHECK_EVERY = 1000,
};

#define COMMAND "make figures"

#define CHANGE_BAR 1.0 /* % */

/** One-sided confidence of a reserve. */
#define CONFIDENCE 0.95

#define P_MAX (1 + 1e-5)

static const char *const robot_names[] = {"gao2018", "courier24"};
#define ROBOTS (sizeof robot_names / sizeof robot_names[0])

static const char *const kind_names[] = {"motors", "battery"};
#define KINDS (sizeof kind_names / sizeof kind_names[0])

static const struct scenario {
    const char *name;
    const char *change; /* NULL: every drive has another robot, from its first segment on */
    enum jp_cause cause;
} scenarios[] = {
    {"friction x 1.5", "friction=1.5", JP_CAUSE_GROUND},
    {"payload + 1 kg", "payload=1", JP_CAUSE_PAYLOAD},
    {"another robot of the kind", NULL, JP_CAUSE_NONE},
};
#define SCENARIOS (sizeof scenarios / sizeof scenarios[0])

/** Of one drive, for one kind of energy. Shares of the measured energy. */
struct result {
    double untaught; /* of the chain, with what was known before the change */
    double chain;    /* of the chain, predicted before it is driven */
    double segment;  /* mean of its segments, with the same knowledge */
    bool is_enough;  /* the reserve covers it */
    bool right_cause;
    uint32_t changes;
};

struct drive {
    const struct robot_entry *entry;
    const struct robot_file *file;
    const struct scenario *scenario;
    uint64_t seed;
    uint64_t aborted; /* chains that the robot did not drive to their end: others were drawn */
    struct result results[KINDS];
};

static struct robot_file files[ROBOTS];
static struct drive drives[ROBOTS * SCENARIOS * DRIVES];

static double joules(jp_q16 energy)
{
    return energy / 65536.0;
}

/* ---- Driving ---- */

/** One kind of energy of a driven chain. */
struct lesson {
    struct jp_learner learner;
    struct jp_energy_start start;
    const struct chain_record *records;
    enum energy_kind kind;
    double tick_seconds;
};

static struct jp_segment_command command_of(const struct lesson *lesson, size_t i)
{
    const struct chain_record *record = &lesson->records[i];

    return experiment_command(&record->command, record->commanded_ticks * lesson->tick_seconds);
}

static double measured(const struct lesson *lesson, size_t i)
{
    return lesson->kind == ENERGY_MOTOR ? lesson->records[i].model : lesson->records[i].battery;
}

static void fail(const char *what)
{
    error_line("bench_learner: %s", what);
    exit(1);
}

/** Learns from the next segment. */
static void learn(struct lesson *lesson, size_t i)
{
    const struct jp_segment_command command = command_of(lesson, i);
    const struct jp_learner *learner = &lesson->learner;
    enum jp_learned learned = JP_LEARNED_NOTHING;
    jp_q16 energy = 0;

    if (jp_learner_update(&lesson->learner, &lesson->start, &command, (jp_q16)lround(measured(lesson, i) * 65536),
                          &learned) != JP_OK ||
        jp_energy_forecast(learner->built_in, learner->horizon, &lesson->start, &command, &energy, &lesson->start) !=
            JP_OK) {
        fail("a segment was refused");
    }
}

/** Forecasts the last segments one by one and together. */
static struct jp_forecast forecast(const struct lesson *lesson, double *mean_error)
{
    struct jp_energy_start start = lesson->start;
    struct jp_forecast_sum whole = {0};
    struct jp_forecast total;

    *mean_error = 0;
    for (size_t i = BEFORE + TAUGHT; i < SEGMENTS; i++) {
        const struct jp_segment_command command = command_of(lesson, i);
        struct jp_energy_start own_start = start;
        struct jp_forecast_sum one = {0};
        struct jp_forecast part;

        if (jp_forecast_add(&lesson->learner, &one, &own_start, &command) != JP_OK ||
            jp_forecast_total(&lesson->learner, &one, &part) != JP_OK ||
            jp_forecast_add(&lesson->learner, &whole, &start, &command) != JP_OK) {
            fail("a forecast was refused");
        }
        *mean_error += fabs(joules(part.energy) / measured(lesson, i) - 1) / FORECAST;
    }
    if (jp_forecast_total(&lesson->learner, &whole, &total) != JP_OK) {
        fail("a forecast was refused");
    }
    return total;
}

static struct result judge(struct lesson *lesson, enum jp_cause cause)
{
    struct jp_learned_state before = lesson->learner.state;
    struct result result = {0};
    double taken = 0, each;

    for (size_t i = 0; i < BEFORE + TAUGHT; i++) {
        if (i == BEFORE) {
            before = lesson->learner.state;
            lesson->learner.changes = 0;
        }
        learn(lesson, i);
    }
    for (size_t i = BEFORE + TAUGHT; i < SEGMENTS; i++) {
        taken += measured(lesson, i);
    }

    const struct jp_forecast total = forecast(lesson, &result.segment);

    jp_q16 spare = 0;
    (void)jp_forecast_reserve(&total, (jp_q16)lround(taken * 65536), (jp_q31)(CONFIDENCE * 2147483648.0), &spare);
    result.chain = fabs(joules(total.energy) / taken - 1);
    result.is_enough = joules(spare) <= 0;
    result.right_cause = lesson->learner.cause == cause;
    result.changes = lesson->learner.changes;
    lesson->learner.state = before;
    result.untaught = fabs(joules(forecast(lesson, &each).energy) / taken - 1);
    return result;
}

/** False: the robot switched off. */
static bool drive_chain(const struct drive *drive, uint64_t seed, struct chain_record records[SEGMENTS])
{
    static const struct chain_ranges ranges = {0, 1, 1, 1, 0.5, 10};
    struct robot_file robot, changed;
    struct variation variation = variation_none;
    struct random random;
    struct rig rig;

    random_init(&random, seed);
    if (drive->scenario->change == NULL) {
        variation_draw(&random, drive->file, &variation);
    }
    variation_apply(&variation, drive->file, &robot);
    if (drive->scenario->change != NULL && !variation_parse("bench_learner", drive->scenario->change, &variation)) {
        exit(ERROR_EXIT);
    }
    variation_apply(&variation, drive->file, &changed);
    chain_draw(records, SEGMENTS, drive->file, &ranges, &random);

    const struct chain_change change = {.at = BEFORE, .robot = &changed};

    if (!rig_init(&rig, drive->entry, &robot, seed)) {
        exit(1);
    }
    return chain_run(&rig, records, SEGMENTS, &change) == SEGMENTS && records[SEGMENTS - 1].end == CHAIN_DRIVEN;
}

static void drive_and_judge(void *context, size_t index)
{
    struct drive *drive = &((struct drive *)context)[index];
    const struct robot_entry *entry = drive->entry;
    struct chain_record records[SEGMENTS];

    while (!drive_chain(drive, drive->seed + drive->aborted * DRIVES, records)) {
        drive->aborted++;
    }
    for (size_t k = 0; k < KINDS; k++) {
        struct lesson lesson = {
            .records = records, .kind = (enum energy_kind)k, .tick_seconds = 1.0 / drive->file->control.rate_hz};

        jp_learner_start(&lesson.learner, k == ENERGY_MOTOR ? entry->learning : entry->learning_battery,
                         k == ENERGY_MOTOR ? entry->energy : entry->energy_battery,
                         k == ENERGY_MOTOR ? entry->horizon : entry->horizon_battery);
        drive->results[k] = judge(&lesson, drive->scenario->cause);
    }
}

static void prepare(void)
{
    char path[64];

    for (size_t r = 0; r < ROBOTS; r++) {
        (void)snprintf(path, sizeof path, "sim/robots/%s.cfg", robot_names[r]);
        if (!robot_file_load(path, &files[r])) {
            exit(ERROR_EXIT);
        }
        for (size_t s = 0; s < SCENARIOS; s++) {
            for (size_t i = 0; i < DRIVES; i++) {
                drives[(r * SCENARIOS + s) * DRIVES + i] = (struct drive){.entry = rig_find_robot(robot_names[r]),
                                                                          .file = &files[r],
                                                                          .scenario = &scenarios[s],
                                                                          .seed = SEED + i};
            }
        }
    }
}

/* ---- Ten million updates ---- */

/** What a stretch of the updates is like. */
enum stretch { STRETCH_DRIVING, STRETCH_STANDING, STRETCH_STRAIGHT, STRETCH_WILD, STRETCH_KINDS };

struct endurance {
    double p_max;   /* largest eigenvalue of P */
    double det_min; /* smallest determinant of P */
};

static struct jp_segment_command random_segment(struct random *random, enum stretch stretch)
{
    const bool turns = stretch == STRETCH_DRIVING || stretch == STRETCH_WILD;

    if (stretch == STRETCH_STANDING) {
        return (struct jp_segment_command){.duration = JP_Q16(10)};
    }
    return (struct jp_segment_command){
        .motion = {turns ? (jp_q24)(random_uniform(random, 0, 1) * JP_Q24_ONE) : JP_Q24(0.7),
                   turns ? (jp_q24)(random_uniform(random, -0.35, 0.35) * JP_Q24_ONE) : 0},
        .turn = turns ? (jp_q24)(random_uniform(random, -1.4, 1.4) * JP_Q24_ONE) : 0,
        .duration = (jp_q16)(random_uniform(random, 0.5, 10) * JP_Q16_ONE),
    };
}

/** Of a wild stretch any measurement at all. */
static jp_q16 random_measurement(struct random *random, enum stretch stretch, jp_q16 energy)
{
    return stretch == STRETCH_WILD ? (jp_q16)random_uniform(random, INT32_MIN, INT32_MAX)
                                   : (jp_q16)(energy * (1.2 + random_gaussian(random, 0.01)));
}

static double determinant(const struct jp_learned_state *state)
{
    double m[JP_LEARNING_DIRECTIONS][JP_LEARNING_DIRECTIONS], product = 1;

    for (int i = 0; i < JP_LEARNING_DIRECTIONS; i++) {
        for (int j = 0; j < JP_LEARNING_DIRECTIONS; j++) {
            m[i][j] = state->s[i][j] / 1073741824.0;
        }
    }
    for (int k = 0; k < JP_LEARNING_DIRECTIONS; k++) {
        int pivot = k;
        for (int i = k + 1; i < JP_LEARNING_DIRECTIONS; i++) {
            pivot = fabs(m[i][k]) > fabs(m[pivot][k]) ? i : pivot;
        }
        for (int j = 0; j < JP_LEARNING_DIRECTIONS; j++) {
            const double swapped = m[k][j];
            m[k][j] = m[pivot][j];
            m[pivot][j] = swapped;
        }
        product *= m[k][k];
        for (int i = k + 1; i < JP_LEARNING_DIRECTIONS && m[k][k] != 0; i++) {
            const double factor = m[i][k] / m[k][k];
            for (int j = k; j < JP_LEARNING_DIRECTIONS; j++) {
                m[i][j] -= factor * m[k][j];
            }
        }
    }
    return product * product;
}

/** Of P = S Sᵀ, by the power method. */
static double largest_eigenvalue(const struct jp_learned_state *state)
{
    double v[JP_LEARNING_DIRECTIONS] = {1, 0.7, -0.4, 0.2}, value = 0;

    for (int step = 0; step < 100; step++) {
        double u[JP_LEARNING_DIRECTIONS] = {0}, w[JP_LEARNING_DIRECTIONS] = {0}, norm = 0;
        for (int j = 0; j < JP_LEARNING_DIRECTIONS; j++) {
            for (int i = 0; i < JP_LEARNING_DIRECTIONS; i++) {
                u[j] += state->s[i][j] / 1073741824.0 * v[i];
            }
        }
        for (int i = 0; i < JP_LEARNING_DIRECTIONS; i++) {
            for (int j = 0; j < JP_LEARNING_DIRECTIONS; j++) {
                w[i] += state->s[i][j] / 1073741824.0 * u[j];
            }
            norm += w[i] * w[i];
        }
        value = sqrt(norm);
        for (int i = 0; i < JP_LEARNING_DIRECTIONS; i++) {
            v[i] = w[i] / value;
        }
    }
    return value;
}

static struct endurance endure(const struct robot_entry *entry)
{
    struct endurance endurance = {.p_max = 0, .det_min = DBL_MAX};
    struct jp_energy_start start = {0};
    struct jp_learner learner;
    struct random random;
    const char *field;

    random_init(&random, SEED);
    jp_learner_start(&learner, entry->learning_battery, entry->energy_battery, entry->horizon_battery);
    for (long i = 0; i < UPDATES; i++) {
        const enum stretch stretch = (enum stretch)(i / (UPDATES / STRETCHES) % STRETCH_KINDS);
        const struct jp_segment_command command = random_segment(&random, stretch);
        enum jp_learned learned;
        struct jp_energy_start end;
        jp_q16 energy = 0;

        (void)jp_energy_forecast(learner.built_in, learner.horizon, &start, &command, &energy, &end);
        if (jp_learner_update(&learner, &start, &command, random_measurement(&random, stretch, energy), &learned) !=
                JP_OK ||
            jp_learned_state_check(&learner.state, &field) != JP_OK) {
            fail("an update left the learner's ranges");
        }
        start = end;
        if (i % CHECK_EVERY == 0) {
            endurance.p_max = fmax(endurance.p_max, largest_eigenvalue(&learner.state));
            endurance.det_min = fmin(endurance.det_min, determinant(&learner.state));
            progress_show("updates", (size_t)i, UPDATES);
        }
    }
    progress_end();
    return endurance;
}

/* ---- Figures ---- */

/** Mean over the drives of a scenario, of a member of their results. */
static double mean_of(const struct drive *of, size_t kind, double (*value)(const struct result *))
{
    double sum = 0;

    for (size_t i = 0; i < DRIVES; i++) {
        sum += value(&of[i].results[kind]) / DRIVES;
    }
    return sum;
}

static double worst_chain(const struct drive *of, size_t kind)
{
    double worst = 0;

    for (size_t i = 0; i < DRIVES; i++) {
        worst = fmax(worst, 100 * of[i].results[kind].chain);
    }
    return worst;
}

static double untaught(const struct result *result)
{
    return 100 * result->untaught;
}

static double chain(const struct result *result)
{
    return 100 * result->chain;
}

static double segment(const struct result *result)
{
    return 100 * result->segment;
}

static double enough(const struct result *result)
{
    return 100.0 * result->is_enough;
}

static double right_cause(const struct result *result)
{
    return 100.0 * result->right_cause;
}

static double changes(const struct result *result)
{
    return result->changes;
}

static void add_figures(json_t *figures, const struct drive *of, size_t kind)
{
    const bool is_change = of->scenario->change != NULL;
    const char *name = of->scenario->name;
    const char *robot = of->entry->name;
    const char *energy = kind_names[kind];

    if (is_change) {
        figures_add(figures, COMMAND, mean_of(of, kind, untaught), "%", no_bar,
                    "learner: %s, %s, energy of the %s: error of 20 segments with what was known before", robot, name,
                    energy);
    }
    figures_add(figures, COMMAND, mean_of(of, kind, chain), "%", at_most(CHANGE_BAR),
                "learner: %s, %s, energy of the %s: error of 20 segments after %d, mean of %d drives", robot, name,
                energy, is_change ? TAUGHT : BEFORE + TAUGHT, DRIVES);
    figures_add(figures, COMMAND, worst_chain(of, kind), "%", no_bar,
                "learner: %s, %s, energy of the %s: worst of these drives", robot, name, energy);
    figures_add(figures, COMMAND, mean_of(of, kind, segment), "%", no_bar,
                "learner: %s, %s, energy of the %s: error of one segment", robot, name, energy);
    figures_add(figures, COMMAND, mean_of(of, kind, enough), "%", no_bar,
                "learner: %s, %s, energy of the %s: a reserve for 95 %% is enough", robot, name, energy);
    if (is_change) {
        figures_add(figures, COMMAND, mean_of(of, kind, right_cause), "%", no_bar,
                    "learner: %s, %s, energy of the %s: cause rightly told", robot, name, energy);
    } else {
        figures_add(figures, COMMAND, mean_of(of, kind, changes), "", no_bar,
                    "learner: %s, %s, energy of the %s: false changes in %d segments", robot, name, energy, TAUGHT);
    }
}

static void add_endurance(json_t *figures, const struct robot_entry *entry)
{
    const struct endurance endurance = endure(entry);

    figures_add(figures, COMMAND, endurance.p_max, "", at_most(P_MAX),
                "learner: %s: largest eigenvalue of P in 10⁷ updates", entry->name);
    figures_add(figures, COMMAND, endurance.det_min > 0, "", equal_to(1),
                "learner: %s: P positive definite in 10⁷ updates", entry->name);
}

int main(void)
{
    json_t *figures = json_array();

    prepare();
    in_parallel("drives", drive_and_judge, drives, sizeof drives / sizeof drives[0]);
    for (size_t i = 0; i < ROBOTS * SCENARIOS; i++) {
        for (size_t k = 0; k < KINDS; k++) {
            add_figures(figures, &drives[i * DRIVES], k);
        }
    }
    for (size_t r = 0; r < ROBOTS; r++) {
        add_endurance(figures, rig_find_robot(robot_names[r]));
    }
    figures_print(figures);
    return 0;
}
