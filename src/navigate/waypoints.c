#include <joulepath/waypoints.h>

#include "src/base/block.h"
#include "src/base/config_check.h"
#include "src/base/integer.h"
#include "src/navigate/waypoint_arc.h"

#define ATTEMPTS 4U

#define NO_PRICE INT64_MAX

static const jp_q24 whole_margin = JP_Q24(JP_WAYPOINTS_MARGIN_M);

/** A J, in the model's unit, with a whole margin, in J/10; each step that is missing counts for one more. */
#define PRICE_ONE 10

/** Price of a unit of jp_cost where the model's unit is 1 J. */
#define PRICE_PER_COST (PRICE_ONE * 65536 / JP_COST_PER_JOULE)

#define NOT_CLEAR (-1)

/** Longer arcs, Q20 cells, are outside the arithmetic of a map. */
#define LENGTH_MAX ((int64_t)1000 * JP_CELLS_ONE)

/** A place where a waypoint may be. */
struct place {
    jp_cells_q20 x; /**< cells from the map's corner */
    jp_cells_q20 y;
    struct jp_point point; /**< m from the start */
};

/** From a label to a place: the segment, and its turn and arc over the map. */
struct leg {
    struct jp_segment segment;
    struct jp_waypoint_arc turn;
    struct jp_waypoint_arc arc;
    jp_phase heading; /**< at its end */
};

/* ---- Formats ---- */

/* Radians in Q24 are 2³²/2π of it: 683565275 + 37777/65536. */
static jp_phase phase_of(jp_q24 radians)
{
    const int64_t angle = radians;

    return (jp_phase)(angle * 683565275 + ((angle * 37777) >> 16));
}

static jp_angle angle_of(jp_phase heading)
{
    return jp_phase_angle(heading + ((jp_phase)1 << 23));
}

static int64_t turn_of(jp_q24 radians)
{
    return (int64_t)phase_of(radians) >> 24;
}

static jp_cells_q20 cells_of(const struct jp_waypoints *waypoints, jp_q24 metres)
{
    /* m in Q24 over m in Q16 is cells in Q8. */
    return (jp_cells_q20)(((int64_t)metres << 12) / waypoints->config.terrain->config.resolution);
}

/* ---- Places ---- */

static jp_cells_q20 centre_of(int16_t cell)
{
    return cell * JP_CELLS_ONE + JP_CELLS_ONE / 2;
}

static struct place place_on(const struct jp_waypoints *waypoints, size_t pose)
{
    const int32_t side = waypoints->config.terrain->config.resolution;
    const struct jp_lattice_pose *start = &waypoints->internal.route[0];
    const struct jp_lattice_pose *at = &waypoints->internal.route[pose];

    return (struct place){centre_of(at->x), centre_of(at->y), {(at->x - start->x) * side, (at->y - start->y) * side}};
}

/* In a wide search each pose but the ends is followed by the places to its left and its right. */
static size_t pose_of(const struct jp_waypoints *waypoints, size_t place)
{
    return waypoints->is_wide ? (place + 2U) / 3U : place;
}

static int side_of(const struct jp_waypoints *waypoints, size_t place)
{
    static const int8_t sides[3] = {-1, 0, 1};

    return waypoints->is_wide && place > 0U ? sides[place % 3U] : 0;
}

static struct place place_at(const struct jp_waypoints *waypoints, size_t index)
{
    const size_t pose = pose_of(waypoints, index);
    const int side = side_of(waypoints, index);
    struct place place = place_on(waypoints, pose);

    if (side != 0) {
        const struct jp_lattice_pose *before = &waypoints->internal.route[pose - 1U];
        const struct jp_lattice_pose *after = &waypoints->internal.route[pose + 1U];
        const jp_angle ahead = jp_atan2(after->y - before->y, after->x - before->x);
        const int32_t resolution = waypoints->config.terrain->config.resolution;
        const int32_t x = -(jp_sin(ahead) >> 1) * side; /* Q30 */
        const int32_t y = (jp_cos(ahead) >> 1) * side;

        place.x += jp_multiply_shift(JP_CELLS_ONE, x, 30);
        place.y += jp_multiply_shift(JP_CELLS_ONE, y, 30);
        place.point.x += jp_multiply_shift(resolution, x, 30);
        place.point.y += jp_multiply_shift(resolution, y, 30);
    }
    return place;
}

/* ---- Legs ---- */

static struct jp_waypoints_label *labels_at(const struct jp_waypoints *waypoints, size_t place)
{
    return &waypoints->internal.labels[place * JP_WAYPOINTS_SECTORS];
}

static struct jp_waypoints_label *label_of(const struct jp_waypoints *waypoints, size_t place, jp_phase heading)
{
    const jp_phase half_sector = JP_PHASE_TURN / (2U * JP_WAYPOINTS_SECTORS);
    const jp_phase sector = (heading + half_sector) / (JP_PHASE_TURN / JP_WAYPOINTS_SECTORS) % JP_WAYPOINTS_SECTORS;

    return &labels_at(waypoints, place)[sector];
}

static bool find_leg(const struct jp_waypoints *waypoints, const struct jp_waypoints_label *label,
                     const struct place *from, const struct place *to, struct leg *leg)
{
    const struct jp_waypoints_config *config = &waypoints->config;
    const jp_angle heading = angle_of(label->heading);
    struct jp_segment *segment = &leg->segment;

    if (jp_segment_optimise(config->model, config->limits, &label->motion, &from->point, heading, &to->point,
                            segment) != JP_OK) {
        return false;
    }

    const jp_phase turned = label->heading + phase_of(segment->command.turn);

    leg->turn = (struct jp_waypoint_arc){from->x, from->y, heading, turn_of(segment->command.turn), 0};
    leg->arc = (struct jp_waypoint_arc){from->x, from->y, angle_of(turned), turn_of(segment->arc),
                                        ((int64_t)segment->length << 20) / config->terrain->config.resolution};
    leg->heading = turned + phase_of(segment->arc);
    return leg->arc.length < LENGTH_MAX;
}

static bool is_clear(const struct jp_waypoints *waypoints, const struct jp_waypoint_arc *arc, int margin)
{
    const struct jp_waypoint_footprint footprint = {
        cells_of(waypoints, waypoints->config.length / 2), cells_of(waypoints, waypoints->config.width / 2),
        cells_of(waypoints, whole_margin * margin / JP_WAYPOINTS_MARGIN_STEPS)};

    return jp_waypoint_arc_is_clear(waypoints->config.terrain, &footprint, arc);
}

/* The widest margin that a leg keeps, or NOT_CLEAR. */
static int margin_of(const struct jp_waypoints *waypoints, const struct leg *leg)
{
    int margin = JP_WAYPOINTS_MARGIN_STEPS;

    while (margin > NOT_CLEAR && !(is_clear(waypoints, &leg->turn, margin) && is_clear(waypoints, &leg->arc, margin))) {
        margin--;
    }
    return margin;
}

static int64_t price_of(jp_q16 energy, int margin)
{
    const int parts = PRICE_ONE + JP_WAYPOINTS_MARGIN_STEPS - margin;

    return (int64_t)energy * parts;
}

/* The places of start and goal are given. */
static int margin_needed(const struct jp_waypoints *waypoints, size_t from, size_t to)
{
    return from == 0U || to + 1U == waypoints->internal.places ? 0 : (int)waypoints->margin_min;
}

/* Extends a label to a place and keeps the result if it is the best so far there. */
static void join(struct jp_waypoints *waypoints, uint8_t sector, const struct place *from, const struct place *to)
{
    const struct jp_waypoints_label *label = &labels_at(waypoints, waypoints->internal.from)[sector];
    struct leg leg;
    int64_t slopes;

    if (!find_leg(waypoints, label, from, to, &leg) ||
        !jp_waypoint_arc_slopes(waypoints->config.terrain,
                                &waypoints->config.lattice->move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS], &leg.arc,
                                &slopes)) {
        return;
    }

    struct jp_waypoints_label *const best = label_of(waypoints, waypoints->internal.to, leg.heading);
    const int64_t before =
        label->price + jp_times_power(slopes * PRICE_PER_COST, -waypoints->config.model->unit_exponent);

    if (before + price_of(leg.segment.energy, JP_WAYPOINTS_MARGIN_STEPS) >= best->price) {
        return;
    }

    const int margin = margin_of(waypoints, &leg);
    const int64_t price = before + price_of(leg.segment.energy, margin);

    if (margin >= margin_needed(waypoints, waypoints->internal.from, waypoints->internal.to) && price < best->price) {
        *best = (struct jp_waypoints_label){
            leg.heading, price, leg.segment.command.motion, waypoints->internal.from, sector, (uint8_t)margin};
    }
}

static bool is_chord_clear(const struct jp_waypoints *waypoints, const struct place *from, const struct place *to)
{
    const int64_t x = (int64_t)to->point.x - from->point.x;
    const int64_t y = (int64_t)to->point.y - from->point.y;
    const int64_t dx = (int64_t)to->x - from->x;
    const int64_t dy = (int64_t)to->y - from->y;
    const struct jp_waypoint_arc chord = {from->x, from->y, jp_atan2((int32_t)dy, (int32_t)dx), 0,
                                          jp_square_root((uint64_t)(dx * dx + dy * dy))};

    return x * x + y * y > (int64_t)JP_SEGMENT_LENGTH_MIN * JP_SEGMENT_LENGTH_MIN && is_clear(waypoints, &chord, 0);
}

static bool is_reached(const struct jp_waypoints_label *label)
{
    return label->price != NO_PRICE;
}

static void join_pair(struct jp_waypoints *waypoints)
{
    const struct place from = place_at(waypoints, waypoints->internal.from);
    const struct place to = place_at(waypoints, waypoints->internal.to);

    if (!is_chord_clear(waypoints, &from, &to)) {
        return;
    }
    for (uint8_t sector = 0; sector < JP_WAYPOINTS_SECTORS; sector++) {
        if (is_reached(&labels_at(waypoints, waypoints->internal.from)[sector])) {
            join(waypoints, sector, &from, &to);
        }
    }
}

/* ---- The search ---- */

static const struct jp_waypoints_label *best_label(const struct jp_waypoints *waypoints)
{
    const struct jp_waypoints_label *labels = labels_at(waypoints, waypoints->internal.places - 1U);
    const struct jp_waypoints_label *best = labels;

    for (size_t sector = 1; sector < JP_WAYPOINTS_SECTORS; sector++) {
        best = labels[sector].price < best->price ? &labels[sector] : best;
    }
    return best;
}

static void begin_attempt(struct jp_waypoints *waypoints)
{
    const jp_phase heading = (jp_phase)waypoints->config.lattice->heading[waypoints->internal.route[0].heading] << 24;

    waypoints->is_wide = waypoints->attempts % 2U != 0U;
    waypoints->margin_min = waypoints->attempts < ATTEMPTS / 2U ? waypoints->config.margin_min : 0U;
    waypoints->internal.places =
        waypoints->is_wide ? (uint16_t)(3U * waypoints->internal.route_count - 4U) : waypoints->internal.route_count;
    waypoints->internal.from = 0;
    waypoints->internal.to = 1;
    for (size_t i = 0; i < (size_t)waypoints->internal.places * JP_WAYPOINTS_SECTORS; i++) {
        waypoints->internal.labels[i].price = NO_PRICE;
    }
    *label_of(waypoints, 0, heading) = (struct jp_waypoints_label){.heading = heading};
}

static void end_attempt(struct jp_waypoints *waypoints)
{
    waypoints->attempts++;
    if (is_reached(best_label(waypoints))) {
        waypoints->answer = JP_WAYPOINTS_FOUND;
    } else if (waypoints->attempts == ATTEMPTS) {
        waypoints->answer = JP_WAYPOINTS_NONE;
    } else {
        begin_attempt(waypoints);
    }
}

static void advance(struct jp_waypoints *waypoints)
{
    waypoints->internal.to++;
    if (waypoints->internal.to == waypoints->internal.places ||
        waypoints->internal.to - waypoints->internal.from > waypoints->config.reach) {
        waypoints->internal.from++;
        waypoints->internal.to = (uint16_t)(waypoints->internal.from + 1U);
    }
    if (waypoints->internal.to == waypoints->internal.places) {
        end_attempt(waypoints);
    }
}

enum jp_waypoints_answer jp_waypoints_work(struct jp_waypoints *waypoints, unsigned pairs)
{
    for (unsigned i = 0; i < pairs && waypoints->answer == JP_WAYPOINTS_CHOOSING; i++) {
        join_pair(waypoints);
        advance(waypoints);
    }
    return waypoints->answer;
}

/* ---- The answer ---- */

/* Where the answer is when it is followed from its end. */
struct position {
    size_t place;
    const struct jp_waypoints_label *label;
};

static struct position last_position(const struct jp_waypoints *waypoints)
{
    return (struct position){waypoints->internal.places - 1U, best_label(waypoints)};
}

static struct position position_before(const struct jp_waypoints *waypoints, const struct position *at)
{
    return (struct position){at->label->before, &labels_at(waypoints, at->label->before)[at->label->before_sector]};
}

size_t jp_waypoints_count(const struct jp_waypoints *waypoints)
{
    size_t count = 1;

    if (waypoints->answer != JP_WAYPOINTS_FOUND) {
        return 0;
    }
    for (struct position at = last_position(waypoints); at.place > 0U; at = position_before(waypoints, &at)) {
        count++;
    }
    return count;
}

static struct jp_waypoint waypoint_at(const struct jp_waypoints *waypoints, const struct position *at)
{
    return (struct jp_waypoint){.point = place_at(waypoints, at->place).point,
                                .heading = angle_of(at->label->heading),
                                .pose = (uint16_t)pose_of(waypoints, at->place),
                                .side = (int8_t)side_of(waypoints, at->place),
                                .margin = at->label->margin};
}

enum jp_status jp_waypoints_read(const struct jp_waypoints *waypoints, struct jp_waypoint *list, size_t max)
{
    if (waypoints == NULL || list == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const size_t count = jp_waypoints_count(waypoints);

    if (count == 0U) {
        return JP_ERR_NO_PLAN;
    }
    if (count > max) {
        return JP_ERR_MEMORY;
    }

    struct position at = last_position(waypoints);

    for (size_t i = count - 1U; i > 0U; i--) {
        const struct position before = position_before(waypoints, &at);
        const struct place from = place_at(waypoints, before.place);
        const struct place to = place_at(waypoints, at.place);
        struct leg leg;

        (void)find_leg(waypoints, before.label, &from, &to, &leg);
        list[i] = waypoint_at(waypoints, &at);
        list[i].segment = leg.segment;
        at = before;
    }
    list[0] = waypoint_at(waypoints, &at);
    return JP_OK;
}

/* ---- Preparation ---- */

size_t jp_waypoints_size(size_t poses)
{
    if (poses < 2U || poses > JP_WAYPOINTS_ROUTE_MAX) {
        return 0;
    }
    return (3U * poses - 4U) * JP_WAYPOINTS_SECTORS * sizeof(struct jp_waypoints_label);
}

static bool is_side_in_range(const struct jp_waypoints_config *config, jp_q24 side)
{
    const int64_t resolution = config->terrain->config.resolution;
    const int64_t all = (int64_t)side + 2 * (int64_t)whole_margin;

    return side > 0 && all <= resolution * 256 * JP_WAYPOINTS_FOOTPRINT_MAX;
}

static bool is_map_in_range(const struct jp_terrain_config *map)
{
    const int64_t longest = map->width > map->height ? map->width : map->height;

    return longest * map->resolution <= INT32_MAX;
}

#define FIELD(member, low, high) JP_CONFIG_FIELD("", struct jp_waypoints_config, member, low, high)

static enum jp_status check(const struct jp_waypoints_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(reach, 1, UINT16_MAX),
        FIELD(margin_min, 0, JP_WAYPOINTS_MARGIN_STEPS),
    };

    if (config->terrain == NULL) {
        return jp_config_refuse("terrain", field);
    }
    if (config->lattice == NULL) {
        return jp_config_refuse("lattice", field);
    }
    if (config->model == NULL) {
        return jp_config_refuse("model", field);
    }
    if (config->limits == NULL) {
        return jp_config_refuse("limits", field);
    }
    if (config->terrain->config.resolution != config->lattice->resolution ||
        !is_map_in_range(&config->terrain->config)) {
        return jp_config_refuse("terrain.resolution", field);
    }
    if (!is_side_in_range(config, config->length)) {
        return jp_config_refuse("length", field);
    }
    if (!is_side_in_range(config, config->width)) {
        return jp_config_refuse("width", field);
    }
    return jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);
}

enum jp_status jp_waypoints_init(struct jp_waypoints *waypoints, const struct jp_waypoints_config *config, void *block,
                                 size_t size, const char **field)
{
    if (waypoints == NULL || config == NULL || block == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (!jp_block_is_aligned(block)) {
        return JP_ERR_ALIGNMENT;
    }
    const enum jp_status status = check(config, field);
    if (status != JP_OK) {
        return status;
    }
    *waypoints = (struct jp_waypoints){
        .config = *config, .internal = {.labels = block, .labels_max = size / sizeof *waypoints->internal.labels}};
    return JP_OK;
}

static enum jp_status check_route(const struct jp_waypoints *waypoints, const struct jp_lattice_pose *route,
                                  size_t poses)
{
    for (size_t i = 0; i < poses; i++) {
        if (route[i].heading >= JP_HEADINGS) {
            return JP_ERR_ARGUMENT;
        }
        if (!jp_terrain_contains(waypoints->config.terrain, route[i].x, route[i].y)) {
            return JP_ERR_OUTSIDE;
        }
    }
    return JP_OK;
}

enum jp_status jp_waypoints_start(struct jp_waypoints *waypoints, const struct jp_lattice_pose *route, size_t poses)
{
    const size_t size = jp_waypoints_size(poses);

    if (waypoints == NULL || route == NULL || size == 0U) {
        return JP_ERR_ARGUMENT;
    }
    if (size > waypoints->internal.labels_max * sizeof *waypoints->internal.labels) {
        return JP_ERR_MEMORY;
    }

    const enum jp_status status = check_route(waypoints, route, poses);

    if (status == JP_OK) {
        waypoints->internal.route = route;
        waypoints->internal.route_count = (uint16_t)poses;
        waypoints->answer = JP_WAYPOINTS_CHOOSING;
        waypoints->attempts = 0;
        begin_attempt(waypoints);
    }
    return status;
}
