/* A day of patrol: two robots, 24 hours each, of the seeds from 5001 on. Prints figures as JSON. */
#include "sim/base/parallel.h"
#include "tests/bench/figures.h"
#include "tests/bench/patrol_rounds.h"

#define COMMAND "make bench-patrol-day"

#define FIRST_SEED 5001U
#define HOURS      24.0

enum { RUNS = 2 };

struct bench {
    struct four_wheel_file robot;
    struct patrol_rounds_outcome outcomes[RUNS];
};

static void run_one(void *context, size_t index)
{
    struct bench *bench = context;

    if (!patrol_rounds_run(&bench->robot, FIRST_SEED + index, HOURS, &bench->outcomes[index])) {
        error_line("a robot on its round: no memory");
        exit(1);
    }
}

static json_t *figures_of(const struct patrol_rounds_outcome *sum)
{
    json_t *figures = json_array();

    figures_add(figures, COMMAND, sum->failed + sum->stranded, "", equal_to(0),
                "patrol day: robots that somebody had to help");
    figures_add(figures, COMMAND, sum->collisions, "", equal_to(0), "patrol day: collisions");
    figures_add(figures, COMMAND, sum->worst.position, "m", at_most(0.05), "patrol day: from the place, worst");
    figures_add(figures, COMMAND, sum->worst.heading, "°", at_most(2), "patrol day: from the heading there, worst");
    figures_add(figures, COMMAND, sum->worst_of_last_hour.position, "m", at_most(0.05),
                "patrol day: from the place, worst of the last hour");
    figures_add(figures, COMMAND, sum->worst_of_last_hour.heading, "°", at_most(2),
                "patrol day: from the heading there, worst of the last hour");
    figures_add(figures, COMMAND, sum->below_reserve, "", no_bar, "patrol day: homecomings with less than the reserve");
    figures_add(figures, COMMAND, sum->charges, "", no_bar, "patrol day: homecomings");
    figures_add(figures, COMMAND, sum->visits, "", no_bar, "patrol day: places visited");
    figures_add(figures, COMMAND, sum->skipped, "", no_bar, "patrol day: places left out");
    figures_add(figures, COMMAND, sum->walked_into, "", no_bar, "patrol day: walked into");
    figures_add(figures, COMMAND, sum->length / 1000, "km", no_bar, "patrol day: driven");
    return figures;
}

int main(int argc, char **argv)
{
    static struct bench bench;
    const char *rows_path = figures_rows_path(argc, argv, "Measures a day of patrol.");
    json_t *rows = json_array();

    if (!four_wheel_file_load("sim/robots/patrol.cfg", &bench.robot)) {
        return ERROR_EXIT;
    }
    in_parallel("days", run_one, &bench, RUNS);
    for (unsigned i = 0; i < RUNS; i++) {
        (void)json_array_append_new(rows, patrol_rounds_row(&bench.outcomes[i], FIRST_SEED + i));
    }
    const struct patrol_rounds_outcome sum = patrol_rounds_sum(bench.outcomes, RUNS);

    figures_write_rows(rows, rows_path);
    figures_print(figures_of(&sum));
    return 0;
}
