#include "src/search/planner_fields.h"

#include "src/search/planner_pose.h"

/** One of the goal's headings. */
static unsigned goal_heading(const struct jp_planner_internal *planner)
{
    unsigned heading = 0;

    while (((planner->goal.headings >> heading) & 1U) == 0U) {
        heading++;
    }
    return heading;
}

static bool is_robot_at_root(const struct jp_planner_internal *planner)
{
    return jp_pose_is_same(&planner->start, &planner->field_root);
}

static void root_at_robot(struct jp_planner_internal *planner)
{
    if (!is_robot_at_root(planner)) {
        planner->turns_to_goal = 0;
    }
    planner->field_root = planner->start;
}

void jp_fields_start_turns(struct jp_planner_internal *planner)
{
    const struct jp_lattice_pose *start = &planner->start;
    const struct jp_goal *goal = &planner->goal;

    root_at_robot(planner);
    jp_turn_field_start(&planner->turn_field, &planner->turns, start->x, start->y, start->heading, goal->x, goal->y,
                        goal_heading(planner));
}

void jp_fields_start(struct jp_planner_internal *planner)
{
    const struct jp_lattice_pose *start = &planner->start;
    const struct jp_goal *goal = &planner->goal;

    root_at_robot(planner);
    planner->is_field_rooted = true;
    planner->are_fields_grown = false;
    jp_energy_field_start(&planner->field, start->x, start->y, goal->x, goal->y);
    if (planner->has_turn_field) {
        jp_fields_start_turns(planner);
    }
}

jp_cost jp_fields_bound(const struct jp_planner_internal *planner, const struct jp_lattice_pose *pose)
{
    const jp_cost ground = jp_energy_field_bound(&planner->field, pose->x, pose->y);
    const jp_cost turns = planner->has_turn_field
                              ? jp_turn_field_bound(&planner->turn_field, pose->x, pose->y, pose->heading)
                              : planner->turns.cost[planner->field_root.heading][pose->heading];

    return jp_cost_add(ground, turns);
}

jp_cost jp_fields_bound_at_goal(const struct jp_planner_internal *planner)
{
    jp_cost least = JP_COST_MAX;

    for (uint8_t heading = 0; heading < JP_HEADINGS; heading++) {
        const struct jp_lattice_pose pose = {planner->goal.x, planner->goal.y, heading};
        const jp_cost bound = jp_pose_is_goal(&planner->goal, &pose) ? jp_fields_bound(planner, &pose) : JP_COST_MAX;
        least = bound < least ? bound : least;
    }
    if (is_robot_at_root(planner) && planner->turns_to_goal > 0U) {
        const jp_cost ground = jp_energy_field_bound(&planner->field, planner->goal.x, planner->goal.y);
        const jp_cost bound = jp_cost_add(ground, planner->turns_to_goal);
        least = bound > least ? bound : least;
    }
    return least;
}

jp_cost jp_fields_turns_to_goal(const struct jp_planner_internal *planner)
{
    jp_cost least = UINT16_MAX;

    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        const jp_cost cost = planner->turns.cost[planner->start.heading][heading];
        if (((planner->goal.headings >> heading) & 1U) != 0U && cost < least) {
            least = cost;
        }
    }
    return is_robot_at_root(planner) && planner->turns_to_goal > least ? planner->turns_to_goal : least;
}

bool jp_fields_are_cut_off(const struct jp_planner_internal *planner)
{
    return planner->is_field_rooted && planner->are_fields_grown &&
           jp_fields_bound(planner, &planner->start) == JP_COST_MAX;
}

static struct jp_cell_box around(const struct jp_cell_box *a, const struct jp_cell_box *b)
{
    return (struct jp_cell_box){
        a->first_x < b->first_x ? a->first_x : b->first_x,
        a->last_x > b->last_x ? a->last_x : b->last_x,
        a->first_y < b->first_y ? a->first_y : b->first_y,
        a->last_y > b->last_y ? a->last_y : b->last_y,
    };
}

struct jp_cell_box jp_fields_take_lowered(struct jp_planner_internal *planner)
{
    struct jp_cell_box box = jp_energy_field_take_lowered(&planner->field);

    if (planner->has_turn_field) {
        const struct jp_cell_box turns = jp_turn_field_take_lowered(&planner->turn_field);
        box = around(&box, &turns);
    }
    return box;
}

void jp_fields_cell_changed(struct jp_planner_internal *planner, int32_t x, int32_t y)
{
    jp_energy_field_cell_changed(&planner->field, x, y);
    if (planner->has_turn_field) {
        jp_turn_field_cell_changed(&planner->turn_field, x, y);
    }
}
