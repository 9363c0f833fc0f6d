#include "src/navigate/navigator_goal.h"

static bool can_stand(const struct jp_navigator *navigator, const struct jp_goal *goal)
{
    const struct jp_lattice *lattice = jp_planner_lattice(navigator->config.planner);
    const struct jp_terrain *terrain = jp_planner_terrain(navigator->config.planner);

    for (unsigned i = 0; i < JP_HEADINGS; i++) {
        if (((goal->headings >> i) & 1U) != 0U &&
            jp_lattice_can_stand(lattice, terrain, goal->x, goal->y, (uint8_t)i)) {
            return true;
        }
    }
    return false;
}

struct jp_goal jp_navigator_choose_goal(const struct jp_navigator *navigator)
{
    const struct jp_goal *asked = &navigator->internal.asked;
    const int32_t reach = navigator->config.radius / jp_planner_terrain(navigator->config.planner)->config.resolution;
    int32_t least = reach * reach + 1;
    struct jp_goal best = *asked;

    if (can_stand(navigator, asked)) {
        return *asked;
    }
    for (int32_t dy = -reach; dy <= reach; dy++) {
        for (int32_t dx = -reach; dx <= reach; dx++) {
            const struct jp_goal goal = {(int16_t)(asked->x + dx), (int16_t)(asked->y + dy), asked->headings};
            const int32_t square = dx * dx + dy * dy;

            if (square < least && can_stand(navigator, &goal)) {
                least = square;
                best = goal;
            }
        }
    }
    return best;
}
