/* The controller's figures: 1 000 000 states against floating point; 30 days of driving, every tick of them. */
#include <joulepath/tables.h>

#include <pthread.h>
#include <stdio.h>

#include "tests/bench/figures.h"
#include "tests/support/lqr_oracle.h"
#include "tests/support/wrap_drive.h"

enum { STATES = 1000000, SEED = 20180917, DAYS = 30, THREADS = 2 };

#define BAR_MILLIVOLTS  5.0
#define BAR_MILLIMETRES 0.1
#define BAR_DEGREES     0.01

static const struct wrap_geometry courier24 = {&jp_robot_courier24, 5, 3, 19200};

static json_t *figures;

static void add_figure(const char *name, double value, const char *unit, double bar)
{
    figures_add(figures, "make figures", value, unit, at_most(bar), "%s", name);
}

static void *run(void *drive)
{
    wrap_run(drive);
    return NULL;
}

/** The month in parts, each of which goes on where the one before it ends. */
static int drive_month(struct wrap_drive parts[THREADS])
{
    const uint64_t ticks = (uint64_t)DAYS * 86400 * courier24.config->estimator.tick_rate / THREADS;
    pthread_t threads[THREADS];

    for (uint64_t i = 0; i < THREADS; i++) {
        parts[i] = (struct wrap_drive){
            .geometry = &courier24, .motion = {JP_Q24(1), JP_Q24(0.35)}, .first = i * ticks, .ticks = ticks};
        if (pthread_create(&threads[i], NULL, run, &parts[i]) != 0) {
            fprintf(stderr, "no thread\n");
            return 1;
        }
    }
    for (int i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
        if (!parts[i].exact) {
            fprintf(stderr, "part %d: the target left its exact angle\n", i);
            return 1;
        }
    }
    return 0;
}

int main(void)
{
    struct wrap_drive parts[THREADS];
    const double millimetres = lqr_turns(jp_robot_courier24.metres_per_turn) * 1000;
    double jump = 0, yaw_jump = 0, drift = 0, yaw_drift = 0;

    if (drive_month(parts) != 0) {
        return 1;
    }
    for (int i = 0; i < THREADS; i++) {
        jump = fmax(jump, parts[i].wheel_jump);
        yaw_jump = fmax(yaw_jump, parts[i].yaw_jump);
        drift += fabs(parts[i].wheel_drift);
        yaw_drift += fabs(parts[i].yaw_drift);
    }
    figures = json_array();
    add_figure("controller: fixed against double, worst of 1 000 000 states, gao2018",
               lqr_worst_millivolts(&jp_robot_gao2018.lqr, STATES, SEED), "mV", BAR_MILLIVOLTS);
    add_figure("controller: fixed against double, worst of 1 000 000 states, courier24",
               lqr_worst_millivolts(&jp_robot_courier24.lqr, STATES, SEED), "mV", BAR_MILLIVOLTS);
    add_figure("30 days of driving: largest jump of the way's error in a tick", jump * millimetres, "mm",
               BAR_MILLIMETRES);
    add_figure("30 days of driving: largest jump of the heading's error in a tick", yaw_jump * 360, "°", BAR_DEGREES);
    add_figure("30 days of driving: drift of the way, reference - measured", drift * millimetres, "mm",
               BAR_MILLIMETRES);
    add_figure("30 days of driving: drift of the heading, reference - measured", yaw_drift * 360, "°", BAR_DEGREES);
    figures_print(figures);
    return 0;
}
