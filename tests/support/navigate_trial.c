#include "tests/support/navigate_trial.h"

#include <joulepath/tables.h>
#include <math.h>

#include "sim/missions/navigation_sight.h"

/** Of a planner that finds every route on these maps, bytes. */
#define AMPLE ((size_t)32 << 20)

#define SLICE 10000

/** From the goal cell's centre: so far from it is a robot that has not arrived, m. */
#define ARRIVED_MAX 0.1

/** Simulated s. */
#define PATIENCE 1800

static bool load_skid(struct navigate_robot *robot, const char *path)
{
    return robot->skid != NULL && skid_robot_load(path, &robot->model);
}

bool navigate_robot_load(struct navigate_robot *robot, const char *name)
{
    if (strcmp(name, "burger") == 0) {
        *robot = (struct navigate_robot){.skid = skid_robot_find(name), .lattice = &jp_lattice_burger};
        return load_skid(robot, "sim/robots/burger.cfg");
    }
    if (strcmp(name, "zhang2018") == 0) {
        *robot = (struct navigate_robot){.skid = skid_robot_find(name), .lattice = &jp_lattice_zhang2018_navigation};
        const bool is_loaded = load_skid(robot, "sim/robots/zhang2018.cfg");

        robot->hills_deg = robot->model.limits.slope_deg;
        return is_loaded;
    }
    *robot = (struct navigate_robot){.entry = rig_find_robot(name), .lattice = &jp_lattice_courier24};
    return robot->entry != NULL && robot_file_load("sim/robots/courier24.cfg", &robot->file);
}

static enum jp_answer answer_of(struct jp_planner *planner)
{
    enum jp_answer answer;

    do {
        answer = jp_planner_work(planner, SLICE);
    } while (!jp_planner_is_idle(planner));
    return answer;
}

bool navigate_is_reachable(const struct navigate_robot *robot, struct jp_terrain *world,
                           const struct jp_lattice_pose *start, const struct jp_goal *goal)
{
    const struct jp_planner_config config = {robot->lattice, JP_COST_PHYSICAL, {JP_EPSILON(3)}};
    void *block = aligned_alloc(8, AMPLE);
    struct jp_planner planner;
    const char *field;
    enum jp_answer answer = JP_ANSWER_OUT_OF_BUDGET;

    if (block != NULL && jp_planner_init(&planner, &config, world, block, AMPLE, &field) == JP_OK &&
        jp_planner_set_start(&planner, start) == JP_OK && jp_planner_set_goal(&planner, goal) == JP_OK) {
        answer = answer_of(&planner);
    }
    free(block);
    return answer == JP_ANSWER_OPTIMAL || answer == JP_ANSWER_WITHIN_BOUND;
}

static bool can_stand(const struct navigation_task *task)
{
    for (uint8_t i = 0; i < JP_HEADINGS; i++) {
        if (jp_lattice_can_stand(task->lattice, task->world, task->goal.x, task->goal.y, i)) {
            return true;
        }
    }
    return false;
}

/** A robot that stands at the goal has shown that it can be reached, also where no route from cell to cell leads there:
 *  its lines need not pass through the middles of cells. A goal without room for it is to be covered by its disc. */
static bool is_as_it_must_be(const struct navigation_task *task, const struct navigate_trial *trial)
{
    const struct navigation_result *result = &trial->result;
    const double beside = can_stand(task) ? 0 : trial->radius_m;

    return result->state == JP_NAVIGATOR_ARRIVED ? result->goal_error_m < ARRIVED_MAX + beside
                                                 : !trial->is_reachable && result->state == JP_NAVIGATOR_UNREACHABLE;
}

static bool drive(const struct navigation_task *task, const struct navigation_robot *driven,
                  struct navigate_trial *trial)
{
    trial->radius_m = hypot(driven->body.length_m, driven->body.width_m) / 2;
    return navigation_run(task, driven, &trial->result);
}

static bool drive_balancer(const struct navigation_task *task, const struct navigate_robot *robot,
                           struct navigate_trial *trial)
{
    const struct clearance_pose start = navigation_start(task);
    struct navigation_balancer balancer;
    struct navigation_robot driven;

    return navigation_balancer_init(&balancer, robot->entry, &robot->file, &start, task->seed, JP_PILOT_MOTORS,
                                    &driven) &&
           drive(task, &driven, trial);
}

static bool drive_skid(const struct navigation_task *task, const struct navigate_robot *robot,
                       struct navigate_trial *trial)
{
    const struct clearance_pose start = navigation_start(task);
    struct navigation_skid skid;
    struct navigation_robot driven;

    const bool is_done = navigation_skid_init_again(&skid, robot->skid, &robot->model, task->world, NULL, &start,
                                                    task->seed, &robot->scale, &driven) &&
                         drive(task, &driven, trial);

    trial->scale = navigation_skid_gyro_scale(&skid);
    return is_done;
}

bool navigate_trial_run(struct navigate_trial *trial, const struct navigate_robot *robot, uint64_t seed, double view_m,
                        size_t memory)
{
    struct dense_map dense;
    bool is_done = dense_map_make(&dense, robot->lattice, robot->hills_deg, seed);

    *trial = (struct navigate_trial){.is_right = false};
    if (is_done) {
        const struct navigation_task task = {.lattice = robot->lattice,
                                             .map = &dense.map,
                                             .world = &dense.world,
                                             .solid = &dense.world,
                                             .start = dense.start,
                                             .goal = dense.goal,
                                             .view_m = view_m,
                                             .memory = memory,
                                             .patience = PATIENCE,
                                             .seed = seed};

        trial->is_reachable = navigate_is_reachable(robot, &dense.world, &dense.start, &dense.goal);
        is_done = robot->skid != NULL ? drive_skid(&task, robot, trial) : drive_balancer(&task, robot, trial);
        trial->is_right = !trial->result.is_touched && is_as_it_must_be(&task, trial);
    }
    dense_map_free(&dense);
    return is_done;
}
