/* Localisation on maps of others: drives between random places with wheels that err, walkers and boxes that the map
 * does not show, slippery ground and scans that fail; robots that are carried away; and a particle filter over the same
 * drives. Drives last 30 m, or --length M. Prints figures as JSON; maps (tools/design/import_map.py) are the arguments.
 */
#include <argp.h>
#include <string.h>
#include <time.h>

#include "sim/base/command_line.h"
#include "sim/base/parallel.h"
#include "sim/files/map_file.h"
#include "tests/bench/figures.h"
#include "tests/bench/particle_filter.h"
#include "tests/bench/statistics.h"

#define COMMAND "make bench-localise"

#define DISTANCE_BAR 0.05 /* m */
#define TURN_BAR     2.0  /* degrees */
#define DEGREES      (180 / M_PI)

enum { MAPS_MAX = 16, DRIVES = 5, CARRIED = 3, SLICE = 20000, CARRIED_SCANS_MAX = 2000, SAMPLES_MAX = 20000 };

static const struct condition {
    const char *name;
    struct drive_trouble trouble;
} conditions[] = {
    {"firm ground", {.slip = 0.03}},
    {"walkers and boxes", {.slip = 0.03, .has_walkers = true, .box_spacing = 2}},
    {"slippery ground", {.slip = 0.1}},
    {"scans that fail", {.slip = 0.03, .dropout = 0.3, .outage = 1}},
};
enum { CONDITIONS = sizeof conditions / sizeof conditions[0] };

enum carried { FOUND, AMBIGUOUS, NOT_FOUND, WRONG, CARRIED_ENDS };

/* A drive, and what came of it. */
struct run {
    const struct map_file *map;
    const struct condition *condition;
    uint64_t seed;
    double *errors; /* of all scans while it was not lost, m */
    size_t count;
    double turn;      /* worst, rad */
    double particles; /* worst of the particle filter, m */
    double particles_sum;
    size_t beyond; /* errors above three standard deviations */
    bool is_lost;
    double seconds[2]; /* of the localiser and of the particle filter */
};

static double length = 30;

/* ---- Drives ---- */

static void locate(struct jp_localiser *localiser, const struct drive *drive)
{
    const struct jp_localiser_input input = drive_input(drive);

    if (jp_localiser_update(localiser, &input) != JP_OK) {
        abort();
    }
    (void)jp_localiser_work(localiser, SLICE);
}

static void *begin(struct jp_localiser *localiser, struct drive *drive, const struct run *run)
{
    const struct jp_localiser_config config = drive_localiser(&run->map->terrain);
    const size_t size = jp_localiser_size(&config);
    void *const block = malloc(size);
    const char *field;

    drive_begin(drive, &run->map->terrain, run->seed, &run->condition->trouble);
    if (block == NULL || jp_localiser_init(localiser, &config, block, size, &field) != JP_OK) {
        abort();
    }

    const struct jp_plane_pose start = drive_plane(&drive->pose);

    (void)jp_localiser_start(localiser, &start);
    drive_step(drive, true);
    locate(localiser, drive);
    return block;
}

static double seconds_since(clock_t start)
{
    return (double)(clock() - start) / CLOCKS_PER_SEC;
}

static void keep(struct run *run, const struct jp_localiser *localiser, const struct drive *drive,
                 const struct particle_filter *filter)
{
    const double error = drive_distance(drive, &localiser->pose);
    const double particles = hypot(filter->pose.x - drive->pose.x, filter->pose.y - drive->pose.y);

    if (run->count < SAMPLES_MAX) {
        run->errors[run->count++] = error;
    }
    run->beyond += error > 3 * (double)localiser->position_deviation;
    run->turn = fmax(run->turn, drive_turn(drive, &localiser->pose));
    run->particles = fmax(run->particles, particles);
    run->particles_sum += particles;
}

static void drive_run(void *context, size_t index)
{
    struct run *const run = &((struct run *)context)[index];
    struct jp_localiser *const localiser = malloc(sizeof *localiser);
    struct drive *const drive = malloc(sizeof *drive);
    struct particle_filter *const filter = malloc(sizeof *filter);
    void *const block = begin(localiser, drive, run);

    run->errors = malloc(SAMPLES_MAX * sizeof *run->errors);
    particle_begin(filter, &localiser->internal.field, &drive->pose, &drive->wheels, run->seed);
    while (drive->length < length && !run->is_lost) {
        drive_step(drive, false);

        const clock_t start = clock();

        locate(localiser, drive);
        run->seconds[0] += seconds_since(start);

        const clock_t other = clock();

        particle_move(filter, &drive->wheels);
        if (drive->has_scan) {
            particle_correct(filter, &drive->scan);
        }
        run->seconds[1] += seconds_since(other);
        run->is_lost = localiser->state == JP_LOCALISER_LOST;
        if (!run->is_lost) {
            keep(run, localiser, drive, filter);
        }
    }
    drive_end(drive);
    free(block);
    free(filter);
    free(drive);
    free(localiser);
}

/* ---- Carried away ---- */

struct carried_run {
    struct run run;
    enum carried end;
    double seconds; /* until it was lost */
};

static bool has_ended(const struct jp_localiser *localiser, unsigned losses)
{
    return losses > 0 && (localiser->state == JP_LOCALISER_TRACKING || localiser->reason == JP_LOCALISER_AMBIGUOUS ||
                          (localiser->reason == JP_LOCALISER_NOWHERE && localiser->internal.is_near));
}

static enum carried end_of(const struct jp_localiser *localiser, const struct drive *drive)
{
    if (localiser->state != JP_LOCALISER_TRACKING) {
        return localiser->reason == JP_LOCALISER_AMBIGUOUS ? AMBIGUOUS : NOT_FOUND;
    }
    return drive_distance(drive, &localiser->pose) < 0.2 ? FOUND : WRONG;
}

/* Drives some metres, is carried to another place, and stands there. */
static void carry_run(void *context, size_t index)
{
    struct carried_run *const carried = &((struct carried_run *)context)[index];
    struct jp_localiser *const localiser = malloc(sizeof *localiser);
    struct drive *const drive = malloc(sizeof *drive);
    void *const block = begin(localiser, drive, &carried->run);
    int scans = 0;

    while (drive->length < 5 && localiser->state != JP_LOCALISER_LOST) {
        drive_step(drive, false);
        locate(localiser, drive);
    }
    drive_kidnap(drive);
    while (scans < CARRIED_SCANS_MAX && !has_ended(localiser, localiser->counts.losses)) {
        drive_step(drive, true);
        locate(localiser, drive);
        carried->seconds += localiser->counts.losses == 0 ? DRIVE_PERIOD : 0;
        scans++;
    }
    carried->end = end_of(localiser, drive);
    drive_end(drive);
    free(block);
    free(drive);
    free(localiser);
}

/* ---- Figures ---- */

static void add(json_t *figures, const struct run *run, const char *what, double value, const char *unit,
                struct figure_bar bar)
{
    figures_add(figures, COMMAND, value, unit, bar, "localisation, %s, %s, %d drives of %.0f m: %s", run->map->name,
                run->condition->name, DRIVES, length, what);
}

/* Of the drives over a map under a condition. */
static void add_group(json_t *figures, struct run *runs)
{
    double *const errors = malloc(DRIVES * SAMPLES_MAX * sizeof *errors);
    size_t count = 0;
    size_t beyond = 0;
    double turn = 0;
    double lost = 0;
    double particles = 0;
    double particles_sum = 0;

    for (int i = 0; i < DRIVES; i++) {
        memcpy(&errors[count], runs[i].errors, runs[i].count * sizeof *errors);
        count += runs[i].count;
        beyond += runs[i].beyond;
        turn = fmax(turn, runs[i].turn);
        lost += runs[i].is_lost;
        particles = fmax(particles, runs[i].particles);
        particles_sum += runs[i].particles_sum;
        free(runs[i].errors);
    }
    qsort(errors, count, sizeof *errors, statistics_compare);
    add(figures, runs, "error of the position, mean", mean(errors, count), "m", no_bar);
    add(figures, runs, "error of the position, 95 % below", errors[(size_t)(0.95 * (double)(count - 1))], "m", no_bar);
    add(figures, runs, "error of the position, worst", errors[count - 1], "m", at_most(DISTANCE_BAR));
    add(figures, runs, "error of the heading, worst", turn * DEGREES, "°", at_most(TURN_BAR));
    add(figures, runs, "errors above three standard deviations", 100 * (double)beyond / (double)count, "%", at_most(1));
    add(figures, runs, "lost", lost, "", equal_to(0));
    add(figures, runs, "error of a particle filter, mean", particles_sum / (double)count, "m", no_bar);
    add(figures, runs, "error of a particle filter, worst", particles, "m", no_bar);
    free(errors);
}

static void add_carried(json_t *figures, const struct carried_run *runs)
{
    static const char *const names[CARRIED_ENDS] = {"found themselves", "stay lost: places are alike",
                                                    "stay lost: no place", "took another place for theirs"};
    int ends[CARRIED_ENDS] = {0};
    double worst = 0;

    for (int i = 0; i < CARRIED; i++) {
        ends[runs[i].end]++;
        worst = fmax(worst, runs[i].seconds);
    }
    for (int i = 0; i < CARRIED_ENDS; i++) {
        figures_add(figures, COMMAND, ends[i], "", i == WRONG ? equal_to(0) : no_bar,
                    "localisation, %s, %d robots carried away: %s", runs->run.map->name, CARRIED, names[i]);
    }
    figures_add(figures, COMMAND, worst, "s", no_bar, "localisation, %s, %d robots carried away: lost after, worst",
                runs->run.map->name, CARRIED);
}

static void add_speed(json_t *figures, const struct run *runs, size_t count)
{
    double seconds[2] = {0};
    size_t scans = 0;

    for (size_t i = 0; i < count; i++) {
        seconds[0] += runs[i].seconds[0];
        seconds[1] += runs[i].seconds[1];
        scans += runs[i].count;
    }
    figures_add(figures, COMMAND, seconds[1] / seconds[0], "", no_bar,
                "localisation: a particle filter of %d particles, times the localiser's time", PARTICLES);
    (void)fprintf(stderr, "%zu scans: %.1f us by the localiser, %.1f us by the particle filter\n", scans,
                  1e6 * seconds[0] / (double)scans, 1e6 * seconds[1] / (double)scans);
}

/* ---- Program ---- */

static size_t read_maps(int argc, char **argv, struct map_file *maps)
{
    size_t count = 0;

    for (int i = 1; i < argc && count < MAPS_MAX; i++) {
        if (strcmp(argv[i], "--length") == 0 && i + 1 < argc) {
            length = strtod(argv[++i], NULL);
        } else if (!map_file_load(argv[i], &maps[count++])) {
            exit(ERROR_EXIT);
        }
    }
    if (count == 0 || !(length > 0)) {
        error_line("usage: bench_localise [--length M] MAP.json…");
        exit(ERROR_EXIT);
    }
    return count;
}

int main(int argc, char **argv)
{
    static struct map_file maps[MAPS_MAX];
    static struct run runs[MAPS_MAX * CONDITIONS * DRIVES];
    static struct carried_run carried[MAPS_MAX * CARRIED];
    const size_t map_count = read_maps(argc, argv, maps);
    const size_t group_count = map_count * CONDITIONS;
    json_t *figures = json_array();

    for (size_t i = 0; i < group_count * DRIVES; i++) {
        runs[i] = (struct run){.map = &maps[i / (CONDITIONS * DRIVES)],
                               .condition = &conditions[i / DRIVES % CONDITIONS],
                               .seed = 1 + i % DRIVES};
    }
    for (size_t i = 0; i < map_count * CARRIED; i++) {
        carried[i].run =
            (struct run){.map = &maps[i / CARRIED], .condition = &conditions[0], .seed = 1001 + i % CARRIED};
    }
    in_parallel("localisation", drive_run, runs, group_count * DRIVES);
    in_parallel("carried away", carry_run, carried, map_count * CARRIED);
    add_speed(figures, runs, group_count * DRIVES);
    for (size_t i = 0; i < group_count; i++) {
        add_group(figures, &runs[i * DRIVES]);
    }
    for (size_t i = 0; i < map_count; i++) {
        add_carried(figures, &carried[i * CARRIED]);
        map_file_free(&maps[i]);
    }
    figures_print(figures);
    return 0;
}
