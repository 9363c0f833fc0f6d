/* A day of patrol: two robots among people, 24 hours each. Prints figures as JSON. `day_drives [HOURS [FIRST_SEED]]`
 * lets others go round for another time. */
#include "sim/base/parallel.h"
#include "tests/bench/figures.h"
#include "tests/bench/patrol_rounds.h"

#define COMMAND "make drive-day"

#define FIRST_SEED 5001U
#define HOURS      24.0

enum { RUNS = 2 };

struct bench {
    struct four_wheel_file robot;
    double hours;
    uint64_t first;
    struct patrol_rounds_outcome outcomes[RUNS];
};

static void run_one(void *context, size_t index)
{
    struct bench *bench = context;

    if (!patrol_rounds_run(&bench->robot, bench->first + index, bench->hours, &bench->outcomes[index])) {
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

    bench.hours = argc > 1 ? strtod(argv[1], NULL) : HOURS;
    bench.first = argc > 2 ? strtoull(argv[2], NULL, 10) : FIRST_SEED;
    if (!(bench.hours > 0) || !four_wheel_file_load("sim/robots/patrol.cfg", &bench.robot)) {
        error_line("usage: day_drives [HOURS [FIRST_SEED]]");
        return ERROR_EXIT;
    }
    in_parallel("days", run_one, &bench, RUNS);

    const struct patrol_rounds_outcome sum = patrol_rounds_sum(bench.outcomes, RUNS);

    figures_print(figures_of(&sum));
    return 0;
}
