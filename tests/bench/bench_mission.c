/* How fast the simulator runs, how good the optimiser's segment and predictions are when driven, and how the robot
 * that can be built masters random missions. Prints figures as JSON, progress on stderr. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "sim/balancer/experiment.h"
#include "sim/base/parallel.h"
#include "sim/missions/mission.h"
#include "tests/bench/figures.h"
#include "tests/support/trial.h"

/* The paper's search by hand: arc angles, rad, and durations, s. */
#define ARC_MIN       0.1
#define ARC_STEP      0.01
#define ARCS          91
#define DURATION_MIN  26.0
#define DURATION_STEP 0.05
#define DURATIONS     121

/* Its first segment, from rest along x. */
#define TARGET_X 10.0
#define TARGET_Y 10.0

#define TRIALS     1000
#define TRIAL_SEED 1
#define REPEATS    5

static void fail(const char *what)
{
    (void)fprintf(stderr, "bench_mission: %s\n", what);
    exit(1);
}

/* Figures. */

static json_t *figures;

static void add_figure(const char *name, double value, const char *unit, struct figure_bar bar)
{
    figures_add(figures, "make figures", value, unit, bar, "%s", name);
}

/* The mission: speed, prediction, comparison. */

static double speed_of_simulation(const struct scenario *scenario)
{
    double best = 0;

    for (int i = 0; i < REPEATS; i++) {
        struct mission mission;

        if (!mission_run(&mission, MISSION_OPTIMAL, scenario, NULL, NULL)) {
            mission_complain(&mission, scenario);
            fail("the mission failed");
        }
        best = fmax(best, (double)mission.ticks / scenario->robot.control.rate_hz / mission.wall_seconds);
    }
    return best;
}

static double worst_prediction(const struct mission *mission)
{
    double worst = 0;

    for (size_t i = 0; i < mission->leg_count; i++) {
        worst = fmax(worst, fabs(mission->legs[i].planned_energy / mission->legs[i].measured_energy - 1));
    }
    return worst;
}

static void bench_mission(const struct scenario *scenario)
{
    struct mission missions[MISSION_STRATEGIES];

    for (int i = 0; i < MISSION_STRATEGIES; i++) {
        if (!mission_run(&missions[i], (enum mission_strategy)i, scenario, missions, NULL)) {
            mission_complain(&missions[i], scenario);
            fail("the mission failed");
        }
    }

    double optimal = missions[MISSION_OPTIMAL].total.measured_energy;

    add_figure("closed-loop simulation, gao2018 at 1 kHz on one core", speed_of_simulation(scenario), "× real time",
               at_least(200));
    add_figure("mission, worst segment, predicted against driven energy", 100 * worst_prediction(missions), "%",
               at_most(1));
    add_figure("mission, energy driven (paper: 1115.7 J)", optimal, "J", no_bar);
    add_figure("mission, straight chords relative to ours (paper: 101.26 %)",
               100 * missions[MISSION_STRAIGHT].total.measured_energy / optimal, "%", at_least(100));
    add_figure("mission, Bézier curve by curve relative to ours (paper: 107.85 %)",
               100 * missions[MISSION_BEZIER].total.measured_energy / optimal, "%", at_least(100));
    add_figure("mission, Bézier curve by curve relative to straight chords (paper: 106.5 %)",
               100 * missions[MISSION_BEZIER].total.measured_energy / missions[MISSION_STRAIGHT].total.measured_energy,
               "%", at_least(100));
    add_figure("mission, Bézier, the whole route at once, relative to ours",
               100 * missions[MISSION_BEZIER_ROUTE].total.measured_energy / optimal, "%", no_bar);
}

/* The first segment against the grid. */

struct grid {
    const struct robot_entry *entry;
    const struct robot_file *file;
    double energy[ARCS * DURATIONS];
};

static double grid_arc(size_t index)
{
    return ARC_MIN + ARC_STEP * (double)(index / DURATIONS);
}

static double grid_duration(size_t index)
{
    return DURATION_MIN + DURATION_STEP * (double)(index % DURATIONS);
}

/** Drives one segment from rest; its energy by the robot's own meter, J. */
static double driven_energy(const struct grid *grid, const struct jp_segment_command *command)
{
    struct rig rig;

    if (!rig_init(&rig, grid->entry, grid->file, 1)) {
        fail("the robot was refused");
    }
    rig_release(&rig, 0);
    if (jp_robot_drive(&rig.robot, command) != JP_OK) {
        fail("a segment was refused");
    }
    do {
        rig_tick(&rig);
    } while (jp_robot_state_now(&rig.robot) == JP_ROBOT_DRIVING);
    if (jp_robot_last_tick(&rig.robot)->segments_ended != 1) {
        fail("the robot fell");
    }
    return (double)jp_robot_last_tick(&rig.robot)->segment_energy_model / 4294967296.0;
}

static void drive_grid_point(void *context, size_t index)
{
    struct grid *grid = context;
    double arc = grid_arc(index);
    double duration = grid_duration(index);
    double length = hypot(TARGET_X, TARGET_Y) * (arc / 2) / sin(arc / 2);
    struct experiment_segment segment = {
        .speed = length / duration, .turn_rate = arc / duration, .turn = atan2(TARGET_Y, TARGET_X) - arc / 2};
    struct jp_segment_command command = experiment_command(&segment, duration);

    grid->energy[index] = driven_energy(grid, &command);
}

static size_t best_of(const struct grid *grid)
{
    size_t best = 0;

    for (size_t i = 1; i < ARCS * DURATIONS; i++) {
        best = grid->energy[i] < grid->energy[best] ? i : best;
    }
    return best;
}

static void bench_segment(const struct robot_entry *entry, const struct robot_file *file)
{
    static struct grid grid;
    const struct jp_motion rest = {0, 0};
    const struct jp_point origin = {0, 0};
    const struct jp_point target = {JP_Q16(TARGET_X), JP_Q16(TARGET_Y)};
    struct jp_segment planned;

    grid.entry = entry;
    grid.file = file;
    if (jp_segment_optimise(entry->energy, &entry->config->limits, &rest, &origin, 0, &target, &planned) != JP_OK) {
        fail("no plan");
    }
    in_parallel("grid", drive_grid_point, &grid, ARCS * DURATIONS);

    size_t best = best_of(&grid);
    double ours = driven_energy(&grid, &planned.command);

    add_figure("first segment, driven energy of the plan above the best of 11011 driven",
               100 * (ours / grid.energy[best] - 1), "%", at_most(0.1));
    add_figure("first segment, plan: energy driven", ours, "J", no_bar);
    add_figure("first segment, plan: arc angle", planned.arc / 16777216.0, "rad", no_bar);
    add_figure("first segment, plan: duration", planned.command.duration / 65536.0, "s", no_bar);
    add_figure("first segment, best of the grid: energy driven", grid.energy[best], "J", no_bar);
    add_figure("first segment, best of the grid: arc angle", grid_arc(best), "rad", no_bar);
    add_figure("first segment, best of the grid: duration", grid_duration(best), "s", no_bar);
}

/* Random missions. */

struct trials {
    enum trial_strategy strategy;
    const struct robot_entry *entry;
    struct robot_file file;
    struct trial all[TRIALS];
};

static void drive_trial(void *context, size_t index)
{
    struct trials *trials = context;

    if (!trial_run(&trials->all[index], trials->strategy, trials->entry, &trials->file, TRIAL_SEED + index)) {
        fail("the robot was refused");
    }
}

/** A figure of the missions of `how`. */
static void add_trials(const char *how, const char *what, double value, const char *unit, struct figure_bar bar)
{
    char name[128];

    (void)snprintf(name, sizeof name, "random missions%s, %s", how, what);
    add_figure(name, value, unit, bar);
}

static void bench_trials(enum trial_strategy strategy, const char *how)
{
    static struct trials trials;
    double done = 0;
    double falls = 0;
    double saturated = 0;
    double peak = 0;
    double hours = 0;

    trials.strategy = strategy;
    trials.entry = rig_find_robot("courier24");
    if (trials.entry == NULL || !robot_file_load("sim/robots/courier24.cfg", &trials.file)) {
        fail("no courier24");
    }
    in_parallel("random missions", drive_trial, &trials, TRIALS);
    for (size_t i = 0; i < TRIALS; i++) {
        const struct trial *trial = &trials.all[i];

        done += trial->end == TRIAL_DONE ? 1 : 0;
        falls += trial->end == TRIAL_FELL ? 1 : 0;
        saturated += (double)trial->normal_saturated_ticks;
        peak = fmax(peak, trial->peak_voltage);
        hours += (double)trial->ticks / trials.file.control.rate_hz / 3600;
    }
    add_trials(how, "driven to the end", done, "", equal_to(1000));
    add_trials(how, "falls", falls, "", equal_to(0));
    add_trials(how, "saturated ticks in normal driving", saturated, "", equal_to(0));
    add_trials(how, "peak voltage in normal driving", peak, "V", no_bar);
    add_trials(how, "driving time", hours, "h", no_bar);
}

int main(void)
{
    struct scenario scenario;
    const struct robot_entry *entry = rig_find_robot("gao2018");

    if (entry == NULL || !scenario_load("sim/scenarios/gao2018_mission.cfg", &scenario)) {
        return 1;
    }
    figures = json_array();
    bench_mission(&scenario);
    bench_segment(entry, &scenario.robot);
    bench_trials(TRIAL_SEGMENTS, " of courier24");
    bench_trials(TRIAL_CRUISE, " of courier24 by cruise and transients");
    figures_print(figures);
    return 0;
}
