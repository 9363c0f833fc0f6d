/* The navigator in closed loop on dense maps with boxes that they do not show: what it touches, whether it arrives
 * where it can and says so where it cannot, and what it takes beside its forecast. Seeds that nobody tuned on. Maps as
 * tests/support/dense_map.h draws them, all robots alike in cells; those of the skid-steered robot lie on hills whose
 * slopes add up to an angle up to its limit, evenly drawn. What a drive has taught of its gyro's scale is kept for the
 * next one. Prints figures as JSON, progress on stderr. */
#include "sim/base/progress.h"
#include "tests/bench/figures.h"
#include "tests/bench/statistics.h"
#include "tests/support/navigate_trial.h"

#define COMMAND "make bench-navigate"

#define VIEW 25 /* cells */

enum { DRIVES = 1000, FIRST_SEED = 900001 };

static const struct {
    const char *robot;
    const char *label;
    size_t memory; /* of the planner */
    bool is_ample;
} cases[] = {
    {"courier24", "navigator, 1000 dense maps, block of 4 MiB", (size_t)4 << 20, true},
    {"courier24", "navigator, 1000 dense maps, block of 80 KiB", (size_t)80 << 10, false},
    {"burger", "navigator of burger, 1000 dense maps, block of 4 MiB", (size_t)4 << 20, true},
    {"zhang2018", "navigator of zhang2018, 1000 dense maps on hills, block of 4 MiB", (size_t)4 << 20, true},
};

struct counts {
    unsigned touched;
    unsigned wrong;
    unsigned beside; /* of these, that arrived by what they know of their place */
    unsigned short_of_memory;
    unsigned arrived;
    unsigned unreachable;
    unsigned replans;
    double clearance;
    double goal_error;
    double errors[DRIVES]; /* of the forecasts of drives by one course, % */
    size_t error_count;
};

static void count(struct counts *counts, const struct navigate_trial *trial)
{
    const struct navigation_result *result = &trial->result;
    const bool is_short = result->state == JP_NAVIGATOR_FAILED && result->reason == JP_NAVIGATOR_MEMORY;
    const bool has_arrived = result->state == JP_NAVIGATOR_ARRIVED;

    counts->touched += result->is_touched;
    counts->short_of_memory += is_short;
    counts->wrong += !trial->is_right && !result->is_touched && !is_short;
    counts->beside += !trial->is_right && !result->is_touched && has_arrived;
    counts->arrived += has_arrived;
    counts->unreachable += result->state == JP_NAVIGATOR_UNREACHABLE;
    counts->replans += result->replans;
    counts->clearance = fmin(counts->clearance, result->clearance_m);
    counts->goal_error = fmax(counts->goal_error, has_arrived ? result->goal_error_m : 0);
    if (has_arrived && result->replans == 0 && result->forecast_joules > 0) {
        counts->errors[counts->error_count] = 100 * fabs(result->joules / result->forecast_joules - 1);
        counts->error_count++;
    }
}

static void add(json_t *figures, const char *label, const char *what, double value, const char *unit,
                struct figure_bar bar)
{
    figures_add(figures, COMMAND, value, unit, bar, "%s: %s", label, what);
}

static void bench(json_t *figures, size_t index)
{
    static struct counts counts;
    static struct navigate_robot robot;
    const char *name = cases[index].label;

    if (!navigate_robot_load(&robot, cases[index].robot)) {
        exit(ERROR_EXIT);
    }
    const double view = VIEW * round(robot.lattice->resolution / 65.536) / 1000; /* m */

    counts = (struct counts){.clearance = 1};
    for (uint64_t i = 0; i < DRIVES; i++) {
        struct navigate_trial trial;

        if (!navigate_trial_run(&trial, &robot, FIRST_SEED + i, view, cases[index].memory)) {
            error_line("bench_navigate: seed %llu was not driven", (unsigned long long)(FIRST_SEED + i));
            exit(ERROR_EXIT);
        }
        count(&counts, &trial);
        robot.scale = trial.scale;
        progress_show("drives", i + 1, DRIVES);
    }
    progress_end();
    add(figures, name, "drives that touched something", counts.touched, "", equal_to(0));
    add(figures, name, "goals that can be reached and were not, or that cannot and nobody said so", counts.wrong, "",
        equal_to(0));
    add(figures, name, "of these, arrived by their own odometry, and more than 10 cm beside the goal", counts.beside,
        "", no_bar);
    add(figures, name, "drives that ended for want of memory", counts.short_of_memory, "",
        cases[index].is_ample ? equal_to(0) : no_bar);
    add(figures, name, "arrived", counts.arrived, "", no_bar);
    add(figures, name, "proved unreachable", counts.unreachable, "", no_bar);
    add(figures, name, "planned anew, all drives", counts.replans, "", no_bar);
    add(figures, name, "least clearance", 100 * counts.clearance, "cm", no_bar);
    add(figures, name, "stand farthest from its goal", 100 * counts.goal_error, "cm", no_bar);
    add(figures, name,
        "energy, waiting and planning included, against the forecast of the drive alone, drives by one course, median",
        median(counts.errors, counts.error_count), "%", no_bar);
}

int main(void)
{
    json_t *figures = json_array();

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bench(figures, i);
    }
    figures_print(figures);
    return 0;
}
