#include "waypoints.h"

#include <math.h>
#include <stdlib.h>

#define Q16_ONE 65536.0
#define Q24_ONE 16777216.0
#define TURN    4294967296.0

/** The best way found to a pose of the route and a sector of headings there. */
struct way {
    struct waypoint last;
    double price;             /**< J, with what slopes add and margins lack; infinite: no way */
    const struct way *before; /**< that it goes on from; NULL: the start */
    size_t segments;
};

/** A choice in progress. */
struct choice {
    const struct jp_terrain *terrain;
    const struct waypoints_robot *robot;
    const struct clearance_pose *route;
    size_t count;
    struct way *ways; /**< WAYPOINTS_SECTORS for each pose */
};

static struct way *way_to(const struct choice *choice, size_t pose, double heading)
{
    const long sector = lround(heading / (2 * M_PI) * WAYPOINTS_SECTORS);

    return &choice->ways[pose * WAYPOINTS_SECTORS + (size_t)(sector & (WAYPOINTS_SECTORS - 1))];
}

static struct jp_point point_of(const struct clearance_pose *origin, const struct clearance_pose *pose)
{
    return (struct jp_point){(jp_q16)lround((pose->x - origin->x) * Q16_ONE),
                             (jp_q16)lround((pose->y - origin->y) * Q16_ONE)};
}

static bool optimise(const struct choice *choice, const struct waypoint *from, const struct clearance_pose *to,
                     struct jp_segment *segment)
{
    const struct jp_point start = point_of(&choice->route[0], &from->pose);
    const struct jp_point target = point_of(&choice->route[0], to);
    const jp_angle heading = (jp_angle)(int64_t)llround(from->pose.heading / (2 * M_PI) * TURN);

    return jp_segment_optimise(choice->robot->model, choice->robot->limits, &from->segment.command.motion, &start,
                               heading, &target, segment) == JP_OK;
}

static struct clearance_arc chord_between(const struct clearance_pose *from, const struct clearance_pose *to)
{
    const double dx = to->x - from->x;
    const double dy = to->y - from->y;

    return (struct clearance_arc){{from->x, from->y, atan2(dy, dx)}, hypot(dx, dy), 0};
}

static struct clearance_arc arc_of(const struct clearance_pose *from, const struct jp_segment *segment)
{
    return (struct clearance_arc){{from->x, from->y, from->heading + segment->command.turn / Q24_ONE},
                                  segment->length / Q16_ONE,
                                  segment->arc / Q24_ONE};
}

static bool is_clear(const struct choice *choice, const struct clearance_arc *arc, double margin)
{
    const struct clearance_robot footprint = {choice->robot->length_m, choice->robot->width_m, margin};
    const unsigned steps = clearance_steps(choice->terrain, &footprint, arc);

    for (unsigned i = 0; i <= steps; i++) {
        const struct clearance_pose pose = clearance_arc_pose(arc, steps > 0 ? (double)i / steps : 0);
        if (!clearance_at(choice->terrain, &footprint, &pose)) {
            return false;
        }
    }
    return true;
}

/* The margin that the turn on the spot before an arc and the arc keep; negative: they are not clear. */
static double margin_of(const struct choice *choice, const struct clearance_pose *from, const struct clearance_arc *arc)
{
    const struct clearance_arc turn = {*from, 0, arc->start.heading - from->heading};

    for (int step = WAYPOINTS_MARGIN_STEPS; step >= 0; step--) {
        const double margin = WAYPOINTS_MARGIN_M * step / WAYPOINTS_MARGIN_STEPS;
        if (is_clear(choice, &turn, margin) && is_clear(choice, arc, margin)) {
            return margin;
        }
    }
    return -1;
}

static double price_of(double energy, double margin)
{
    return energy * (1 + WAYPOINTS_MARGIN_PRICE * (1 - margin / WAYPOINTS_MARGIN_M));
}

static jp_elevation elevation_at(const struct jp_terrain *terrain, const struct clearance_pose *pose)
{
    const double cell = terrain->config.resolution / Q16_ONE;

    return jp_terrain_elevation(terrain, (int32_t)floor(pose->x / cell), (int32_t)floor(pose->y / cell));
}

/* J that the slopes under an arc add, in steps of at most a cell; infinite when one is too steep. */
static double slope_price(const struct choice *choice, const struct clearance_arc *arc)
{
    const struct jp_slope_cost *step = choice->robot->step;
    const unsigned steps = (unsigned)ceil(arc->length_m / (choice->terrain->config.resolution / Q16_ONE));
    jp_elevation before = elevation_at(choice->terrain, &arc->start);
    double price = 0;

    for (unsigned i = 1; i <= steps && choice->terrain->config.has_elevation; i++) {
        const struct clearance_pose pose = clearance_arc_pose(arc, (double)i / steps);
        const jp_elevation here = elevation_at(choice->terrain, &pose);
        const jp_cost cost = jp_move_cost(step, here - before);
        if (cost == JP_COST_MAX) {
            return INFINITY;
        }
        price += ((double)cost - (double)jp_move_cost(step, 0)) / JP_COST_PER_JOULE;
        before = here;
    }
    return price;
}

static double margin_needed(const struct choice *choice, const struct way *from, size_t j)
{
    return from->before == NULL || j == choice->count - 1 ? 0 : choice->robot->margin_min_m;
}

/* Goes on from a way to pose `j`; keeps what comes of it if it is the best so far. */
static void join(struct choice *choice, const struct way *from, size_t j)
{
    struct jp_segment segment;

    if (!optimise(choice, &from->last, &choice->route[j], &segment)) {
        return;
    }
    const double energy = segment.energy / Q16_ONE;
    const struct clearance_arc arc = arc_of(&from->last.pose, &segment);
    const double heading = clearance_arc_pose(&arc, 1).heading;
    struct way *to = way_to(choice, j, heading);
    const double price_before = from->price + slope_price(choice, &arc);
    if (price_before + energy >= to->price) {
        return;
    }
    const double margin = margin_of(choice, &from->last.pose, &arc);
    const double price = price_before + price_of(energy, margin);
    if (margin >= margin_needed(choice, from, j) && price < to->price) {
        *to = (struct way){
            {{choice->route[j].x, choice->route[j].y, heading}, segment, margin}, price, from, from->segments + 1};
    }
}

static bool is_reached(const struct way *way)
{
    return !isinf(way->price);
}

static void join_all(struct choice *choice, size_t i, size_t j)
{
    for (size_t sector = 0; sector < WAYPOINTS_SECTORS; sector++) {
        const struct way *from = &choice->ways[i * WAYPOINTS_SECTORS + sector];
        if (is_reached(from)) {
            join(choice, from, j);
        }
    }
}

/* Goes on from pose `i` to those after it. */
static void extend(struct choice *choice, size_t i)
{
    const size_t left = choice->count - 1 - i;

    for (size_t j = i + 1; j <= i + (left < WAYPOINTS_REACH ? left : WAYPOINTS_REACH); j++) {
        const struct clearance_arc chord = chord_between(&choice->route[i], &choice->route[j]);
        if (chord.length_m * Q16_ONE > JP_SEGMENT_LENGTH_MIN && is_clear(choice, &chord, 0)) {
            join_all(choice, i, j);
        }
    }
}

static void begin(struct choice *choice)
{
    for (size_t i = 0; i < choice->count * WAYPOINTS_SECTORS; i++) {
        choice->ways[i].price = INFINITY;
    }
    *way_to(choice, 0, choice->route[0].heading) = (struct way){.last.pose = choice->route[0]};
}

static const struct way *best_way(const struct choice *choice)
{
    const struct way *ways = &choice->ways[(choice->count - 1) * WAYPOINTS_SECTORS];
    const struct way *best = ways;

    for (size_t sector = 1; sector < WAYPOINTS_SECTORS; sector++) {
        best = ways[sector].price < best->price ? &ways[sector] : best;
    }
    return best;
}

static size_t trace(const struct choice *choice, struct waypoint *waypoints)
{
    const struct way *way = best_way(choice);

    if (!is_reached(way)) {
        return 0;
    }
    const size_t length = way->segments + 1;
    for (size_t i = length; i > 0; i--) {
        waypoints[i - 1] = way->last;
        way = way->before;
    }
    return length;
}

size_t waypoints_choose(const struct jp_terrain *terrain, const struct waypoints_robot *robot,
                        const struct clearance_pose *route, size_t count, struct waypoint *waypoints)
{
    struct choice choice = {terrain, robot, route, count, calloc(count * WAYPOINTS_SECTORS, sizeof *choice.ways)};

    if (choice.ways == NULL) {
        return 0;
    }
    begin(&choice);
    for (size_t i = 0; i + 1 < count; i++) {
        extend(&choice, i);
    }
    const size_t length = trace(&choice, waypoints);
    free(choice.ways);
    return length;
}

size_t waypoints_widen(const struct clearance_pose *route, size_t count, double aside_m, struct clearance_pose *wide)
{
    size_t written = 0;

    wide[written++] = route[0];
    for (size_t i = 1; i + 1 < count; i++) {
        const struct clearance_pose *at = &route[i];
        const double ahead = atan2(route[i + 1].y - route[i - 1].y, route[i + 1].x - route[i - 1].x);
        const double dx = -aside_m * sin(ahead);
        const double dy = aside_m * cos(ahead);
        wide[written++] = *at;
        wide[written++] = (struct clearance_pose){at->x + dx, at->y + dy, at->heading};
        wide[written++] = (struct clearance_pose){at->x - dx, at->y - dy, at->heading};
    }
    wide[written++] = route[count - 1];
    return written;
}
