#include "sim/missions/plan_route.h"

#include <math.h>
#include <stdlib.h>

static double joules(jp_cost cost)
{
    return (double)cost / JP_COST_PER_JOULE;
}

/* Rise of every unit step, what it would take without, and the energy of all, whatever the map charges: J. */
static double add_moves(struct plan_route *route, const struct jp_lattice *lattice, const struct jp_terrain *terrain,
                        const struct jp_primitive *primitive, const struct jp_lattice_pose *from)
{
    int32_t x = from->x;
    int32_t y = from->y;
    double energy = 0;

    for (unsigned i = 0; i < primitive->move_count; i++) {
        const unsigned direction = lattice->moves[primitive->first_move + i];
        const jp_elevation before = jp_terrain_elevation(terrain, x, y);
        x += jp_move_offsets[direction].dx;
        y += jp_move_offsets[direction].dy;
        route->way[route->way_count++] = (struct jp_lattice_pose){(int16_t)x, (int16_t)y, from->heading};
        const struct jp_slope_cost *cost = &lattice->move_costs[JP_COST_PHYSICAL][jp_move_kind_of(direction)];
        const int32_t rise = jp_terrain_elevation(terrain, x, y) - before;
        route->climb += fmax(0, rise) / JP_ELEVATION_ONE;
        route->level_energy += joules(jp_move_cost(cost, 0));
        energy += joules(jp_move_cost(cost, rise));
    }
    return energy;
}

static void add(struct plan_route *route, const struct jp_lattice *lattice, const struct jp_terrain *terrain,
                const struct jp_primitive *primitive, const struct jp_lattice_pose *end)
{
    const struct plan_step *last = plan_route_end(route);
    const double base = joules(primitive->base[JP_COST_PHYSICAL]);

    const double moves = add_moves(route, lattice, terrain, primitive, &last->pose);

    route->turning_energy += base;
    route->level_energy += base;
    route->steps[route->count] = (struct plan_step){
        .pose = *end,
        .length = last->length + primitive->length / 1000.0,
        .energy = last->energy + moves + base,
        .time = last->time + primitive->duration / 1000.0,
    };
    route->count++;
}

static size_t count_moves(const struct jp_planner *planner, unsigned steps, struct jp_lattice_pose pose)
{
    size_t moves = 0;

    for (unsigned i = 0; i < steps; i++) {
        moves += jp_planner_step(planner, i, &pose)->move_count;
    }
    return moves;
}

bool plan_route_read(const struct jp_planner *planner, const struct jp_lattice *lattice,
                     const struct jp_terrain *terrain, const struct jp_lattice_pose *start, struct plan_route *route)
{
    const struct jp_plan *plan = jp_planner_plan(planner);
    const bool has_route = plan->answer != JP_ANSWER_OUT_OF_BUDGET;
    const unsigned count = has_route ? plan->step_count : 0;
    struct jp_lattice_pose pose = has_route ? plan->start : *start;

    *route = (struct plan_route){.steps = calloc(count + 1, sizeof *route->steps),
                                 .count = 1,
                                 .way = calloc(count_moves(planner, count, pose) + 1, sizeof *route->way),
                                 .way_count = 1};
    if (route->steps == NULL || route->way == NULL) {
        plan_route_free(route);
        return false;
    }
    route->steps[0].pose = pose;
    route->way[0] = pose;
    for (unsigned i = 0; i < count; i++) {
        const struct jp_primitive *primitive = jp_planner_step(planner, i, &pose);
        add(route, lattice, terrain, primitive, &pose);
    }
    return true;
}

void plan_route_free(struct plan_route *route)
{
    free(route->steps);
    free(route->way);
    *route = (struct plan_route){0};
}

const struct plan_step *plan_route_end(const struct plan_route *route)
{
    return &route->steps[route->count - 1];
}

void plan_route_write(const struct plan_route *route, const struct map_file *map, const struct jp_lattice *lattice,
                      FILE *stream)
{
    (void)fprintf(stream, "x_m,y_m,z_m,heading_deg,length_m,energy_j,time_s\n");
    for (size_t i = 0; i < route->count; i++) {
        const struct plan_step *step = &route->steps[i];
        const struct clearance_pose pose = plan_grid_pose(map, lattice, &step->pose);
        const struct plan_place place = plan_map_place(map, &pose);
        const jp_elevation elevation = jp_terrain_elevation(&map->terrain, step->pose.x, step->pose.y);
        (void)fprintf(stream, "%.4f,%.4f,%.4f,%.3f,%.3f,%.4f,%.3f\n", place.x, place.y,
                      (double)elevation / JP_ELEVATION_ONE, place.heading_deg, step->length, step->energy, step->time);
    }
}
