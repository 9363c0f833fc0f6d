/* Hours of patrol on a battery: twelve robots, a quarter of an hour each, of the seeds from 4001 on. Prints figures as
 * JSON. */
#include "sim/base/parallel.h"
#include "tests/bench/figures.h"
#include "tests/bench/patrol_rounds.h"

#define COMMAND "make bench-patrol-round"

#define FIRST_SEED 4001U
#define HOURS      0.25

enum { RUNS = 12 };

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
    const double homecomings = sum->charges + sum->stranded;

    figures_add(figures, COMMAND, 100.0 * (sum->charges - sum->below_reserve) / homecomings, "%", at_least(95),
                "patrol round: homecomings with the reserve or more");
    figures_add(figures, COMMAND, sum->stranded, "", equal_to(0), "patrol round: robots whose battery ran out");
    figures_add(figures, COMMAND, sum->failed, "", equal_to(0), "patrol round: robots that gave up");
    figures_add(figures, COMMAND, sum->collisions, "", equal_to(0), "patrol round: collisions");
    figures_add(figures, COMMAND, sum->walked_into, "", no_bar, "patrol round: walked into");
    figures_add(figures, COMMAND, sum->charges, "", no_bar, "patrol round: homecomings");
    figures_add(figures, COMMAND, sum->visits, "", no_bar, "patrol round: places visited");
    figures_add(figures, COMMAND, sum->skipped, "", no_bar, "patrol round: places left out");
    figures_add(figures, COMMAND, sum->length, "m", no_bar, "patrol round: driven");
    return figures;
}

int main(int argc, char **argv)
{
    static struct bench bench;
    const char *rows_path = figures_rows_path(argc, argv, "Measures hours of patrol on a battery.");
    json_t *rows = json_array();

    if (!four_wheel_file_load("sim/robots/patrol.cfg", &bench.robot)) {
        return ERROR_EXIT;
    }
    in_parallel("rounds", run_one, &bench, RUNS);
    for (unsigned i = 0; i < RUNS; i++) {
        (void)json_array_append_new(rows, patrol_rounds_row(&bench.outcomes[i], FIRST_SEED + i));
    }
    const struct patrol_rounds_outcome sum = patrol_rounds_sum(bench.outcomes, RUNS);

    figures_write_rows(rows, rows_path);
    figures_print(figures_of(&sum));
    return 0;
}
