/* A controller that is killed in mid-drive, in real time, and started again by a supervisor: how long the robot is
 * without commands, and how it ends.
 *
 * The body of courier24 and its operator run in this process, jp-ecu --real-time in another one, over SLCAN on a
 * pseudo-terminal. The supervisor starts jp-ecu again at once, or later. A trial in which the machine was too busy, so
 * that the body was late or the new controller fell silent, is repeated. Prints figures as JSON, a table on stderr;
 * --rows FILE writes each restart. */
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "hal/linux/periodic.h"
#include "sim/balancer/robot_file.h"
#include "sim/base/progress.h"
#include "sim/base/real_time.h"
#include "sim/bus/bus_drive.h"
#include "sim/bus/bus_open.h"
#include "tests/bench/figures.h"
#include "tests/bench/statistics.h"
#include "tests/support/random.h"

#define ROBOT      "courier24"
#define ROBOT_FILE "sim/robots/" ROBOT ".cfg"
#define COMMAND    "make bench-restart"
#define DEGREES    (180 / M_PI)
#define PERIOD_NS  1000000U

enum { SEED = 1, TRIALS = 10, ATTEMPTS_MAX = 30, PATH_SIZE = 128 };

/* Ticks of 1 ms. */
enum { DRIVE_MIN = 1000, DRIVE_SPAN = 2000, WATCHED = 6000 };

/* A robot stands when it is upright and at rest so nearly. */
#define STAND_DEGREES 3.0
#define STAND_M_S     0.05

/** The body is not later than this while the robot is watched. */
#define LATENESS_MAX_US 10000U

/** What the supervisor waits before it starts the controller again, ms. */
static const unsigned delays[] = {0, 20, 100, 300};
enum { DELAYS = sizeof delays / sizeof delays[0] };

enum end { STANDS, SWITCHED_OFF, UNSAFE, ENDS };
static const char *const end_names[ENDS] = {"stands", "switched off", "unsafe"};

struct trial {
    unsigned delay_ms;
    uint32_t outage_ms;      /**< without a valid command, until the new controller sends one */
    uint32_t driven_down_ms; /**< time with the bridges on after the robot hit the ground */
    double peak_pitch_deg;
    enum end end;
};

static char program[PATH_SIZE];
static char folder[] = "/tmp/bench_restart.XXXXXX";
static char line[PATH_SIZE];
static char record[PATH_SIZE];
static struct trial trials[DELAYS * TRIALS];
static unsigned repeated;

static void fail(const char *what)
{
    error_line("bench_restart: %s: %s", what, strerror(errno));
    exit(ERROR_EXIT);
}

/* ---- The supervisor ---- */

struct supervisor {
    pthread_t thread;
    unsigned delay_ms;
    _Atomic pid_t controller;
    atomic_bool ended;
};

static pid_t start_controller(void)
{
    char bus[PATH_SIZE + 8];
    char *const arguments[] = {program, "--bus", bus, "--robot", ROBOT, "--real-time", "--retained", record, NULL};
    posix_spawn_file_actions_t actions;
    pid_t controller;

    (void)snprintf(bus, sizeof bus, "slcan:%s", line);
    (void)posix_spawn_file_actions_init(&actions);
    (void)posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    errno = posix_spawn(&controller, program, &actions, NULL, arguments, NULL);
    if (errno != 0) {
        fail(program);
    }
    (void)posix_spawn_file_actions_destroy(&actions);
    return controller;
}

static void *supervise(void *argument)
{
    struct supervisor *self = argument;
    const struct timespec delay = {.tv_nsec = (long)self->delay_ms * 1000000L};

    while (!atomic_load(&self->ended)) {
        const pid_t controller = start_controller();

        atomic_store(&self->controller, controller);
        if (waitpid(controller, NULL, 0) != controller) {
            fail("waitpid");
        }
        (void)nanosleep(&delay, NULL);
    }
    return NULL;
}

static void start_supervisor(struct supervisor *self, unsigned delay_ms)
{
    self->delay_ms = delay_ms;
    atomic_init(&self->controller, 0);
    atomic_init(&self->ended, false);
    errno = pthread_create(&self->thread, NULL, supervise, self);
    if (errno != 0) {
        fail("supervisor");
    }
}

static void kill_controller(struct supervisor *self)
{
    const pid_t controller = atomic_load(&self->controller);

    if (controller > 0) {
        (void)kill(controller, SIGKILL);
    }
}

static void end_supervisor(struct supervisor *self)
{
    atomic_store(&self->ended, true);
    kill_controller(self);
    (void)pthread_join(self->thread, NULL);
}

/* ---- A drive ---- */

struct run {
    struct bus_drive drive;
    struct jp_periodic timer;
    struct trial *trial;
};

static void tick(struct run *run)
{
    (void)jp_periodic_wait(&run->timer);
    bus_drive_real_time(&run->drive);
}

/** Until it has driven for a while. False: it has not, because samples or commands came too late. */
static bool drive_for(struct run *run, uint32_t ticks)
{
    uint32_t driven = 0;

    while (driven < ticks && run->drive.commander.phase != JP_OPERATOR_FAILED) {
        tick(run);
        driven += run->drive.commander.phase == JP_OPERATOR_DRIVING;
    }
    return driven == ticks;
}

/** False: the bridges had to switch off although the new controller had commanded them before. */
static bool watch(struct run *run)
{
    const struct plant *plant = &run->drive.plant.world.plant;
    struct trial *trial = run->trial;
    bool commanded = false;
    bool steady = true;

    for (int i = 0; i < WATCHED; i++) {
        const uint32_t silence = run->drive.plant.silence;

        tick(run);
        if (commanded) {
            steady = steady && silence <= PLANT_HOLD_MS;
        } else {
            commanded = silence == 0U && trial->outage_ms > 1U; /* the last commands of the old one come at once */
            trial->outage_ms = silence > trial->outage_ms ? silence : trial->outage_ms;
        }
        trial->peak_pitch_deg = fmax(trial->peak_pitch_deg, fabs(plant->state.pitch) * DEGREES);
        trial->driven_down_ms += plant->fallen && run->drive.plant.actuation.enabled != 0U;
    }
    return steady;
}

static enum end end_of(const struct run *run)
{
    const struct plant_node *node = &run->drive.plant;
    const struct plant_state *state = &node->world.plant.state;
    const double speed = state->wheel_rate * node->world.robot.wheel.radius_m;

    if (node->actuation.enabled == 0U) {
        return SWITCHED_OFF;
    }
    return fabs(state->pitch) * DEGREES < STAND_DEGREES && fabs(speed) < STAND_M_S ? STANDS : UNSAFE;
}

/** False: the machine was too busy. */
static bool try_restart(struct trial *trial, const struct robot_file *robot, uint64_t number)
{
    static const struct jp_point route[] = {{JP_Q16(20), JP_Q16(5)}};
    static struct supervisor supervisor;
    static struct run run;
    char bus[PATH_SIZE + 8];
    struct jp_can_link link;
    bool driving;
    bool steady = false;
    bool in_time;

    *trial = (struct trial){.delay_ms = trial->delay_ms};
    begin_random(SEED, number);
    (void)unlink(record);
    (void)snprintf(bus, sizeof bus, "pty:%s", line);
    if (!bus_open(&link, bus)) {
        exit(ERROR_EXIT);
    }
    run.trial = trial;
    bus_drive_init(&run.drive, robot, number + 1, &link);
    start_supervisor(&supervisor, trial->delay_ms);
    (void)jp_operator_route(&run.drive.commander, route, 1);
    jp_periodic_start(&run.timer, PERIOD_NS);
    driving = drive_for(&run, DRIVE_MIN + below(DRIVE_SPAN));
    if (driving) {
        run.timer.worst_lateness_us = 0;
        kill_controller(&supervisor);
        steady = watch(&run);
        trial->end = end_of(&run);
    }
    in_time = run.timer.worst_lateness_us <= LATENESS_MAX_US;
    end_supervisor(&supervisor);
    link.close(link.port.context);
    return driving && steady && in_time;
}

static void measure(const struct robot_file *robot)
{
    for (size_t i = 0; i < DELAYS * (size_t)TRIALS; i++) {
        unsigned attempts = 1;

        trials[i].delay_ms = delays[i / TRIALS];
        while (!try_restart(&trials[i], robot, i)) {
            repeated++;
            if (attempts++ == ATTEMPTS_MAX) {
                error_line("bench_restart: no trial in time; the machine is too busy for real time");
                exit(ERROR_EXIT);
            }
        }
        progress_show("restarts", i + 1, DELAYS * (size_t)TRIALS);
    }
    progress_end();
}

/* ---- What came of it ---- */

struct tally {
    double outages[DELAYS * TRIALS];
    size_t count;
    unsigned short_outages; /**< that the bridges ride out */
    unsigned short_ends[ENDS];
    unsigned long_ends[ENDS];
    uint32_t driven_down_ms; /**< the longest */
};

static void add(struct tally *tally, const struct trial *trial)
{
    const bool is_short = trial->outage_ms <= PLANT_HOLD_MS;

    tally->outages[tally->count++] = trial->outage_ms;
    tally->short_outages += is_short;
    (is_short ? tally->short_ends : tally->long_ends)[trial->end]++;
    tally->driven_down_ms =
        trial->driven_down_ms > tally->driven_down_ms ? trial->driven_down_ms : tally->driven_down_ms;
}

static struct tally tally_of(size_t first, size_t count)
{
    struct tally tally = {.count = 0};

    for (size_t i = first; i < first + count; i++) {
        add(&tally, &trials[i]);
    }
    return tally;
}

static void print_table(void)
{
    (void)fprintf(stderr,
                  "started again            without commands, ms      up to 40 ms           longer\n"
                  "after, ms      restarts  least  median  longest   all  stand   stand  switched off   neither\n");
    for (size_t i = 0; i < DELAYS; i++) {
        struct tally tally = tally_of(i * TRIALS, TRIALS);

        (void)fprintf(stderr, "%9u  %12zu  %5.0f  %6.0f  %7.0f  %4u  %5u  %6u  %12u  %8u\n", delays[i], tally.count,
                      least(tally.outages, tally.count), median(tally.outages, tally.count),
                      greatest(tally.outages, tally.count), tally.short_outages, tally.short_ends[STANDS],
                      tally.long_ends[STANDS], tally.long_ends[SWITCHED_OFF],
                      tally.short_ends[UNSAFE] + tally.long_ends[UNSAFE]);
    }
}

static json_t *figures_of(void)
{
    struct tally prompt = tally_of(0, TRIALS);
    const struct tally all = tally_of(0, DELAYS * (size_t)TRIALS);
    const unsigned short_falls = all.short_ends[SWITCHED_OFF] + all.short_ends[UNSAFE];
    json_t *figures = json_array();

    figures_add(figures, COMMAND, (double)all.count, "", no_bar, "ECU killed in mid-drive, real time: restarts");
    figures_add(figures, COMMAND, repeated, "", no_bar,
                "ECU killed in mid-drive, real time: trials repeated, because the machine was too busy");
    figures_add(figures, COMMAND, median(prompt.outages, prompt.count), "ms", no_bar,
                "ECU killed in mid-drive, real time: without commands when it is started again at once, median");
    figures_add(figures, COMMAND, greatest(prompt.outages, prompt.count), "ms", no_bar,
                "ECU killed in mid-drive, real time: without commands when it is started again at once, longest");
    figures_add(figures, COMMAND, all.short_outages, "", no_bar,
                "ECU killed in mid-drive, real time: outages of at most %u ms", PLANT_HOLD_MS);
    figures_add(figures, COMMAND, short_falls, "", equal_to(0),
                "ECU killed in mid-drive, real time: of these, robots that do not stand");
    figures_add(figures, COMMAND, all.long_ends[UNSAFE], "", equal_to(0),
                "ECU killed in mid-drive, real time: longer outages after which the robot neither stands nor is off");
    figures_add(figures, COMMAND, all.driven_down_ms, "ms", no_bar,
                "ECU killed in mid-drive, real time: longest time with motors on after a fall");
    return figures;
}

static json_t *rows_of(void)
{
    json_t *rows = json_array();

    for (size_t i = 0; i < DELAYS * (size_t)TRIALS; i++) {
        const struct trial *trial = &trials[i];

        (void)json_array_append_new(rows, json_pack("{s:i, s:i, s:i, s:f, s:s}", "started_again_after_ms",
                                                    (int)trial->delay_ms, "outage_ms", (int)trial->outage_ms,
                                                    "driven_down_ms", (int)trial->driven_down_ms, "peak_pitch_deg",
                                                    trial->peak_pitch_deg, "end", end_names[trial->end]));
    }
    return rows;
}

/** jp-ecu stands beside the folder of the benches. */
static void name_files(const char *self)
{
    const char *slash = strrchr(self, '/');

    (void)snprintf(program, sizeof program, "%.*s/../bin/jp-ecu", slash == NULL ? 1 : (int)(slash - self),
                   slash == NULL ? "." : self);
    if (mkdtemp(folder) == NULL) {
        fail(folder);
    }
    (void)snprintf(line, sizeof line, "%s/line", folder);
    (void)snprintf(record, sizeof record, "%s/record", folder);
}

int main(int argc, char **argv)
{
    const char *rows_path =
        figures_rows_path(argc, argv, "Kills the controller of a driving robot and starts it again, in real time.");
    struct robot_file robot;

    if (!robot_file_load(ROBOT_FILE, &robot)) {
        return ERROR_EXIT;
    }
    name_files(argv[0]);
    (void)real_time_claim();
    measure(&robot);
    (void)unlink(record);
    (void)rmdir(folder);
    print_table();
    figures_write_rows(rows_of(), rows_path);
    figures_print(figures_of());
    return EXIT_SUCCESS;
}
