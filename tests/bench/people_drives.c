/* The patrol robot among people who walk, stop and turn round, alone and in groups, and do not look where it is: how
 * often it collides with one of them by the rule of sim/scenes/contact.h, how near it drives to people and things, and
 * whether it arrives. Prints figures as JSON; drives that were not as they should be, and progress, on stderr.
 * `people_drives [DRIVES [FIRST_SEED]]` drives another number of them from another seed on. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include "sim/base/parallel.h"
#include "sim/missions/patrol_mission.h"
#include "tests/bench/figures.h"

#define COMMAND    "make drive-people"
#define ROBOT_PATH "sim/robots/patrol.cfg"

#define DRIVES     10000
#define FIRST_SEED 100001

/* m */
#define THING_CLEARANCE  0.1
#define PERSON_CLEARANCE 0.3
#define BACKWARDS_MIN    0.02 /* what slip and noise at a stand explain */

struct campaign {
    struct four_wheel_file robot;
    size_t drives;
    uint64_t first;
    struct patrol_result *results;
};

static void drive(void *context, size_t index)
{
    struct campaign *campaign = context;
    struct patrol_scene scene;
    const struct patrol_task task = {.robot = &campaign->robot,
                                     .scene = &scene,
                                     .method = PATROL_IMPROVED,
                                     .seed = campaign->first + index,
                                     .faults = {.jump_at = -1}};

    patrol_scene_make(PATROL_PEOPLE, campaign->first + index, &scene);
    if (!patrol_mission_run(&task, &campaign->results[index])) {
        abort();
    }
    patrol_scene_free(&scene);
}

struct summary {
    unsigned arrived;
    unsigned collided; /* drives, with people */
    unsigned moved_into;
    unsigned avoidable;
    unsigned walked_into; /* touches that are no collisions */
    unsigned things;      /* drives that collided with things */
    unsigned backwards;
    unsigned near_things;
    unsigned near_people;
    double things_min; /* m */
    double people_min;
    double time; /* s, mean of those that arrived */
};

static bool is_bad(const struct patrol_result *result)
{
    return result->outcome != PATROL_ARRIVED || result->clearance_min < THING_CLEARANCE ||
           result->person_clearance_min < PERSON_CLEARANCE || result->reversed > BACKWARDS_MIN;
}

static struct summary summarise(const struct campaign *campaign)
{
    struct summary sum = {.things_min = INFINITY, .people_min = INFINITY};

    for (size_t i = 0; i < campaign->drives; i++) {
        const struct patrol_result *result = &campaign->results[i];
        const bool has_arrived = result->outcome == PATROL_ARRIVED;

        sum.arrived += has_arrived;
        sum.collided += result->contacts.collisions > 0;
        sum.moved_into += result->contacts.moved_into;
        sum.avoidable += result->contacts.avoidable;
        sum.walked_into += result->contacts.touches - result->contacts.collisions;
        sum.things += result->outcome == PATROL_COLLIDED && result->contacts.collisions == 0;
        sum.backwards += result->reversed > BACKWARDS_MIN;
        sum.near_things += result->clearance_min < THING_CLEARANCE;
        sum.near_people += result->person_clearance_min < PERSON_CLEARANCE;
        sum.things_min = fmin(sum.things_min, result->clearance_min);
        sum.people_min = fmin(sum.people_min, result->person_clearance_min);
        sum.time += has_arrived ? result->time : 0;
        if (is_bad(result)) {
            (void)fprintf(stderr,
                          "seed %" PRIu64 ": %s %s after %.1f s, %u touches, %u collisions (%u into, %u avoidable), "
                          "%.3f m from things, %.3f m from people, %.2f m backwards\n",
                          campaign->first + i, patrol_outcome_names[result->outcome],
                          patrol_reason_names[result->reason], result->time, result->contacts.touches,
                          result->contacts.collisions, result->contacts.moved_into, result->contacts.avoidable,
                          result->clearance_min, result->person_clearance_min, result->reversed);
        }
    }
    sum.time /= sum.arrived;
    return sum;
}

static void add(json_t *figures, const struct campaign *campaign, const char *what, double value, const char *unit,
                struct figure_bar bar)
{
    figures_add(figures, COMMAND, value, unit, bar, "patrol robot among people, %zu drives: %s", campaign->drives,
                what);
}

static void add_figures(json_t *figures, const struct campaign *campaign, const struct summary *sum)
{
    add(figures, campaign, "arrived", sum->arrived, "", equal_to((double)campaign->drives));
    add(figures, campaign, "drives with a collision with people", sum->collided, "", equal_to(0));
    add(figures, campaign, "collisions in which it moved into somebody", sum->moved_into, "", equal_to(0));
    add(figures, campaign, "collisions that braking would have avoided", sum->avoidable, "", equal_to(0));
    add(figures, campaign, "walked into while it stood", sum->walked_into, "", no_bar);
    add(figures, campaign, "collided with things", sum->things, "", equal_to(0));
    add(figures, campaign, "least clearance to things", sum->things_min, "m", at_least(THING_CLEARANCE));
    add(figures, campaign, "came nearer than 10 cm to something", sum->near_things, "", no_bar);
    add(figures, campaign, "least clearance to people", sum->people_min, "m", at_least(PERSON_CLEARANCE));
    add(figures, campaign, "came nearer than 30 cm to somebody", sum->near_people, "", no_bar);
    add(figures, campaign, "drove backwards", sum->backwards, "", no_bar);
    add(figures, campaign, "time, mean", sum->time, "s", no_bar);
}

int main(int argc, char **argv)
{
    struct campaign campaign = {.drives = argc > 1 ? strtoul(argv[1], NULL, 10) : DRIVES,
                                .first = argc > 2 ? strtoul(argv[2], NULL, 10) : FIRST_SEED};
    json_t *figures = json_array();

    campaign.results = calloc(campaign.drives, sizeof *campaign.results);
    if (campaign.drives == 0 || campaign.results == NULL || !four_wheel_file_load(ROBOT_PATH, &campaign.robot)) {
        error_line("usage: people_drives [DRIVES [FIRST_SEED]]");
        return ERROR_EXIT;
    }
    in_parallel("patrol robot among people", drive, &campaign, campaign.drives);

    const struct summary sum = summarise(&campaign);

    add_figures(figures, &campaign, &sum);
    free(campaign.results);
    figures_print(figures);
    return 0;
}
