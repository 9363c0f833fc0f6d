/* What the patrol takes beside plain path following: energy and time of the improved band over those of pure pursuit on
 * the same scenes, where pure pursuit arrives. It does not turn to the goal's heading: beside that stands what it takes
 * with the turn that it leaves out, as the robot turns in place there with nobody around, "to the same pose". The
 * figures are of seeds that no part of the robot was designed on. Prints figures as JSON; on stderr, where both take
 * time and energy: by states, of the energy the part of electronics, and of the time that at a stand.
 *
 * bench_joules [--seed FIRST] [--count N]
 * --count is the number of drives a scene. */
#include <math.h>
#include <stdlib.h>

#include "sim/base/parallel.h"
#include "sim/missions/patrol_mission.h"
#include "tests/bench/drive_options.h"
#include "tests/bench/figures.h"

#define COMMAND    "make bench-patrol"
#define ROBOT_PATH "sim/robots/patrol.cfg"

/* Of the mean over all drives. */
#define ENERGY_BAR 1.10
#define TIME_BAR   1.15

enum { DRIVES_MAX = 400, STATES = JP_PATROL_STOPPED + 1 };

/* Slower than this the robot stands, m/s and rad/s. */
#define STANDING 0.03

/* What a state took. */
struct share {
    double seconds;
    double standing; /* of them */
    double joules;
    double metres;
};

/* How a drive went. */
struct drive {
    struct patrol_result result;
    struct share shares[STATES];
    double time; /* of the last cycle */
    double energy;
    struct jp_plane_pose pose;
};

struct pair {
    struct drive band;
    struct drive pursuit;
    struct drive turn; /* after pursuit, to the goal's heading */
};

struct campaign {
    struct four_wheel_file robot;
    struct pair pairs[PATROL_SCENES][DRIVES_MAX];
};

static struct drive_options options = {.seed = 1101, .count = DRIVES_MAX, .count_max = DRIVES_MAX};

/* ---- Driving ---- */

static void note(void *context, const struct patrol_view *view)
{
    struct drive *drive = context;
    struct share *const share = &drive->shares[view->state];
    const double seconds = view->time - drive->time;
    const bool is_standing =
        fabs((double)view->true_speed.forward) < STANDING && fabs((double)view->true_speed.turn_rate) < STANDING;

    if (view->time > 0) {
        share->seconds += seconds;
        share->standing += is_standing ? seconds : 0;
        share->joules += view->energy_j - drive->energy;
        share->metres +=
            hypot((double)(view->true_pose.x - drive->pose.x), (double)(view->true_pose.y - drive->pose.y));
    }
    drive->time = view->time;
    drive->energy = view->energy_j;
    drive->pose = view->true_pose;
}

static void run(const struct four_wheel_file *robot, const struct patrol_scene *scene, enum patrol_method method,
                uint64_t seed, struct drive *drive)
{
    const struct patrol_task task = {.robot = robot,
                                     .scene = scene,
                                     .method = method,
                                     .seed = seed,
                                     .faults = {.jump_at = -1},
                                     .observe = note,
                                     .context = drive};

    if (!patrol_mission_run(&task, &drive->result)) {
        abort();
    }
}

/* From where pursuit has ended. */
static void turn(const struct four_wheel_file *robot, const struct patrol_scene *scene, uint64_t seed,
                 struct pair *pair)
{
    struct patrol_scene end = *scene;

    end.start = pair->pursuit.pose;
    end.goal.x = end.start.x;
    end.goal.y = end.start.y;
    end.people_count = 0;
    run(robot, &end, PATROL_IMPROVED, seed, &pair->turn);
}

static void drive_index(void *context, size_t index)
{
    struct campaign *campaign = context;
    const enum patrol_scene_kind kind = (enum patrol_scene_kind)(index % PATROL_SCENES);
    const size_t number = index / PATROL_SCENES;
    struct pair *pair = &campaign->pairs[kind][number];
    struct patrol_scene scene;

    patrol_scene_make(kind, options.seed + number, &scene);
    run(&campaign->robot, &scene, PATROL_PURSUIT, options.seed + number, &pair->pursuit);
    if (pair->pursuit.result.outcome == PATROL_ARRIVED) {
        run(&campaign->robot, &scene, PATROL_IMPROVED, options.seed + number, &pair->band);
        turn(&campaign->robot, &scene, options.seed + number, pair);
    }
    patrol_scene_free(&scene);
}

/* ---- What came of them ---- */

/* Sums over the drives in which pursuit arrived, and the band too. */
struct summary {
    double pairs;
    double failed; /* in which only pursuit arrived */
    double energy; /* of the ratios */
    double time;
    double length;
    double turned; /* of the pairs, those in which the robot could turn where pursuit ended */
    double energy_turned;
    double time_turned;
    struct share band[STATES];
    struct share pursuit[STATES];
};

static void add_shares(struct share sums[STATES], const struct drive *drive)
{
    for (size_t i = 0; i < STATES; i++) {
        sums[i].seconds += drive->shares[i].seconds;
        sums[i].standing += drive->shares[i].standing;
        sums[i].joules += drive->shares[i].joules;
        sums[i].metres += drive->shares[i].metres;
    }
}

static void add_pair(struct summary *summary, const struct pair *pair)
{
    const struct patrol_result *const band = &pair->band.result;
    const struct patrol_result *const pursuit = &pair->pursuit.result;

    if (pursuit->outcome != PATROL_ARRIVED) {
        return;
    }
    if (band->outcome != PATROL_ARRIVED) {
        summary->failed++;
        return;
    }
    summary->pairs++;
    summary->energy += band->energy_j / pursuit->energy_j;
    summary->time += band->time / pursuit->time;
    summary->length += band->length / pursuit->length;
    if (pair->turn.result.outcome == PATROL_ARRIVED) {
        summary->turned++;
        summary->energy_turned += band->energy_j / (pursuit->energy_j + pair->turn.result.energy_j);
        summary->time_turned += band->time / (pursuit->time + pair->turn.result.time);
    }
    add_shares(summary->band, &pair->band);
    add_shares(summary->pursuit, &pair->pursuit);
}

/* Of a pair. */
static void print_shares(const char *name, const struct share shares[STATES], double pairs, double electronics_w)
{
    for (size_t i = 0; i < STATES; i++) {
        const struct share *const share = &shares[i];

        if (share->seconds > 0) {
            const double electronics = electronics_w * share->seconds;

            (void)fprintf(
                stderr, "    %-8s %-9s %6.2f s (%5.2f s stand) %7.1f J = %6.1f J electronics + %6.1f J; %5.2f m\n",
                name, patrol_state_names[i], share->seconds / pairs, share->standing / pairs, share->joules / pairs,
                electronics / pairs, (share->joules - electronics) / pairs, share->metres / pairs);
        }
    }
}

static void print_summary(const char *name, const struct summary *summary, double electronics_w)
{
    const double pairs = summary->pairs;

    (void)fprintf(stderr,
                  "%s: %.0f pairs, %.0f failed; energy %.3f, time %.3f, way %.3f; to the same pose energy %.3f, time "
                  "%.3f\n",
                  name, pairs, summary->failed, summary->energy / pairs, summary->time / pairs, summary->length / pairs,
                  summary->energy_turned / summary->turned, summary->time_turned / summary->turned);
    print_shares(patrol_method_names[PATROL_IMPROVED], summary->band, pairs, electronics_w);
    print_shares(patrol_method_names[PATROL_PURSUIT], summary->pursuit, pairs, electronics_w);
}

static void add_figures(json_t *figures, const char *name, const struct summary *summary, bool has_bars)
{
    const double pairs = summary->pairs;

    if (pairs + summary->failed > 0) {
        figures_add(figures, COMMAND, summary->failed, "", has_bars ? equal_to(0) : no_bar,
                    "patrol robot beside path following, %s, %zu drives a scene: following arrived and it did not",
                    name, options.count);
    }
    if (pairs > 0) {
        figures_add(figures, COMMAND, summary->energy / pairs, "×", has_bars ? at_most(ENERGY_BAR) : no_bar,
                    "patrol robot beside path following, %s, %zu drives a scene: energy, mean", name, options.count);
        figures_add(figures, COMMAND, summary->time / pairs, "×", has_bars ? at_most(TIME_BAR) : no_bar,
                    "patrol robot beside path following, %s, %zu drives a scene: time, mean", name, options.count);
    }
    if (summary->turned > 0) {
        figures_add(figures, COMMAND, summary->energy_turned / summary->turned, "×", no_bar,
                    "patrol robot beside path following, %s, %zu drives a scene: energy to the same pose, mean", name,
                    options.count);
        figures_add(figures, COMMAND, summary->time_turned / summary->turned, "×", no_bar,
                    "patrol robot beside path following, %s, %zu drives a scene: time to the same pose, mean", name,
                    options.count);
    }
}

/* ---- Program ---- */

int main(int argc, char **argv)
{
    static struct campaign campaign;
    struct summary all = {0};
    json_t *figures = json_array();

    parse_drive_options(argc, argv, "Measures the patrol beside path following.", &options);
    if (!four_wheel_file_load(ROBOT_PATH, &campaign.robot)) {
        return ERROR_EXIT;
    }
    in_parallel("patrol beside path following", drive_index, &campaign, options.count * PATROL_SCENES);
    for (size_t kind = 0; kind < PATROL_SCENES; kind++) {
        struct summary summary = {0};

        for (size_t i = 0; i < options.count; i++) {
            add_pair(&summary, &campaign.pairs[kind][i]);
            add_pair(&all, &campaign.pairs[kind][i]);
        }
        print_summary(patrol_scene_names[kind], &summary, campaign.robot.electronics.power_w);
        add_figures(figures, patrol_scene_names[kind], &summary, false);
    }
    print_summary("all scenes", &all, campaign.robot.electronics.power_w);
    add_figures(figures, "all scenes", &all, true);
    figures_print(figures);
    return 0;
}
