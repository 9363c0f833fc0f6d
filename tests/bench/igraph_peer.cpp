#include "tests/bench/igraph_peer.h"

#include <limits>

#include <igraph.h>

namespace
{

struct Edges {
    igraph_vector_int_t ends;
    igraph_vector_t costs;
};

igraph_integer_t id_of(const jp_terrain &terrain, int32_t x, int32_t y, unsigned heading)
{
    return (static_cast<igraph_integer_t>(y) * terrain.config.width + x) * JP_HEADINGS + heading;
}

void add_edges_from(Edges &edges, const jp_lattice &lattice, const jp_terrain &terrain, int32_t x, int32_t y)
{
    for (unsigned i = 0; i < lattice.first_from[JP_HEADINGS]; i++) {
        const jp_primitive &primitive = lattice.primitives[i];
        const jp_cost cost = jp_lattice_cost(&lattice, JP_COST_PHYSICAL, &terrain, &primitive, x, y);
        if (cost != JP_COST_MAX) {
            igraph_vector_int_push_back(&edges.ends, id_of(terrain, x, y, primitive.start));
            igraph_vector_int_push_back(&edges.ends, id_of(terrain, x + primitive.dx, y + primitive.dy, primitive.end));
            igraph_vector_push_back(&edges.costs, cost);
        }
    }
}

unsigned first_heading(const jp_goal &goal)
{
    unsigned heading = 0;
    while (heading + 1 < JP_HEADINGS && ((goal.headings >> heading) & 1) == 0) {
        heading++;
    }
    return heading;
}

double cost_of(const igraph_vector_int_t &path, const Edges &edges)
{
    double sum = 0;
    for (igraph_integer_t i = 0; i < igraph_vector_int_size(&path); i++) {
        sum += VECTOR(edges.costs)[VECTOR(path)[i]];
    }
    return sum;
}

} // namespace

double igraph_cost(const jp_lattice *lattice, const jp_terrain *terrain, const jp_lattice_pose *start,
                   const jp_goal *goal)
{
    const igraph_integer_t from = id_of(*terrain, start->x, start->y, start->heading);
    const igraph_integer_t to = id_of(*terrain, goal->x, goal->y, first_heading(*goal));
    Edges edges;
    igraph_t graph;
    igraph_vector_int_t path;

    igraph_vector_int_init(&edges.ends, 0);
    igraph_vector_init(&edges.costs, 0);
    igraph_vector_int_init(&path, 0);
    for (int32_t y = 0; y < terrain->config.height; y++) {
        for (int32_t x = 0; x < terrain->config.width; x++) {
            add_edges_from(edges, *lattice, *terrain, x, y);
        }
    }
    igraph_create(&graph, &edges.ends, id_of(*terrain, 0, terrain->config.height, 0), IGRAPH_DIRECTED);
    igraph_get_shortest_path_dijkstra(&graph, nullptr, &path, from, to, &edges.costs, IGRAPH_OUT);
    const double cost = cost_of(path, edges);
    const bool is_found = igraph_vector_int_size(&path) > 0 || from == to;
    igraph_destroy(&graph);
    igraph_vector_int_destroy(&path);
    igraph_vector_destroy(&edges.costs);
    igraph_vector_int_destroy(&edges.ends);
    return is_found ? cost : std::numeric_limits<double>::infinity();
}
