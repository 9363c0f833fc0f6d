#include "sim/lattice/lattice_json.h"

#include <math.h>
#include <stdlib.h>

#include "sim/base/error.h"
#include "sim/base/strict_math.h"
#include "sim/lattice/lattice_costs.h"
#include "sim/lattice/lattice_moves.h"
#include "sim/lattice/lattice_sweep.h"

/* Primitives of a file. */
#define PRIMITIVES_MAX 1024

/* A path must end this close to the centre of its end cell and its end heading, cells and rad. */
#define END_TOLERANCE 1e-3

static json_t *json_cells(const struct lattice_cells *cells)
{
    json_t *rows = json_array();

    for (int y = -LATTICE_REACH; y <= LATTICE_REACH; y++) {
        for (int x = -LATTICE_REACH; x <= LATTICE_REACH; x++) {
            const int first = x;
            while (lattice_has_cell(cells, x, y)) {
                x++;
            }
            if (x > first) {
                (void)json_array_append_new(rows, json_pack("[i, i, i]", y, first, x - 1));
            }
        }
    }
    return rows;
}

static json_t *json_path(const struct lattice_path *path)
{
    json_t *poses = json_array();

    for (size_t i = 0; i < path->count; i++) {
        const struct lattice_pose *pose = &path->poses[i];
        (void)json_array_append_new(poses, json_pack("[f, f, f]", pose->x, pose->y, pose->heading));
    }
    return poses;
}

static json_t *json_primitive(const struct lattice_primitive *primitive)
{
    json_t *moves = json_array();
    json_t *base = json_array();

    for (size_t i = 0; i < primitive->move_count; i++) {
        (void)json_array_append_new(moves, json_integer(primitive->moves[i]));
    }
    for (int kind = 0; kind < JP_COST_KINDS; kind++) {
        (void)json_array_append_new(base, json_integer(primitive->base[kind]));
    }
    return json_pack("{s:i, s:i, s:i, s:i, s:f, s:f, s:o, s:o, s:o, s:o}", "start", (int)primitive->start, "end",
                     (int)primitive->end, "dx", primitive->dx, "dy", primitive->dy, "length_m", primitive->length_m,
                     "duration_s", primitive->duration_s, "base", base, "moves", moves, "swept",
                     json_cells(primitive->swept), "poses", json_path(&primitive->path));
}

static json_t *json_polynomial(const struct jp_polynomial *polynomial)
{
    return json_pack("[i, i, i]", polynomial->constant, polynomial->linear, polynomial->quadratic);
}

static json_t *json_move_costs(const struct lattice *lattice, int kind)
{
    json_t *moves = json_array();

    for (int move = 0; move < JP_MOVE_KINDS; move++) {
        const struct jp_slope_cost *cost = &lattice->move_costs[kind][move];
        (void)json_array_append_new(moves,
                                    json_pack("{s:o, s:o, s:i, s:i, s:i}", "climb", json_polynomial(&cost->climb),
                                              "descend", json_polynomial(&cost->descend), "bend", cost->bend,
                                              "rise_max", cost->rise_max, "floor", cost->floor));
    }
    return json_pack("{s:f, s:o}", "ratio", lattice->ratio[kind], "moves", moves);
}

static json_t *json_skid_steer(const struct skid_steer_model *model)
{
    return json_pack("{s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "wheel_radius_m",
                     model->wheel.radius_m, "width_m", model->body.width_m, "wheelbase_m", model->body.wheelbase_m,
                     "weight_n", model->body.mass_kg * STANDARD_GRAVITY, "rolling", model->ground.rolling, "friction",
                     model->ground.friction, "torque_per_ampere",
                     model->motor.torque_constant * model->motor.gear_ratio * model->motor.efficiency, "resistance_ohm",
                     model->motor.resistance_ohm, "efficiency", model->motor.efficiency, "recuperation",
                     model->motor.recuperation, "electronics_power_w", model->electronics.power_w, "distance_j_per_m",
                     model->lattice.distance_j_per_m);
}

/* Of the margin that the lattice sweeps, half is what the robot may leave its trajectory by. */
static json_t *json_navigation(const struct lattice_robot *robot)
{
    return json_pack("{s:f, s:f, s:b}", "radius_m", strict_hypot(robot->length_m, robot->width_m) / 2, "margin_m",
                     robot->margin_m / 2, "is_swept", robot->radius_m > 0);
}

json_t *lattice_to_json(const struct lattice *lattice)
{
    json_t *primitives = json_array();
    json_t *headings = json_array();
    json_t *footprint = json_array();
    json_t *reach = json_array();
    json_t *costs = json_array();

    for (size_t i = 0; i < lattice->count; i++) {
        (void)json_array_append_new(primitives, json_primitive(&lattice->primitives[i]));
    }
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        (void)json_array_append_new(headings, json_real(lattice->headings[heading]));
        (void)json_array_append_new(footprint, json_cells(lattice->footprint[heading]));
        (void)json_array_append_new(reach, json_cells(lattice->reach[heading]));
    }
    for (int kind = 0; kind < JP_COST_KINDS; kind++) {
        (void)json_array_append_new(costs, json_move_costs(lattice, kind));
    }
    json_t *root = json_pack("{s:s, s:f, s:o, s:o, s:o, s:o, s:o, s:o}", "robot", lattice->robot->name, "resolution_m",
                             lattice->resolution_m, "headings_rad", headings, "primitives", primitives, "footprint",
                             footprint, "reach", reach, "core", json_cells(lattice->core), "costs", costs);
    if (lattice->robot->skid_steer.body.mass_kg > 0) {
        (void)json_object_set_new(root, "skid_steer", json_skid_steer(&lattice->robot->skid_steer));
    }
    if (lattice->robot->turning_radius_m > 0) {
        (void)json_object_set_new(root, "navigation", json_navigation(lattice->robot));
    }
    return root;
}

/* A number of an array. */
static bool element(const json_t *array, size_t index, double *value)
{
    const json_t *number = json_array_get(array, index);

    *value = json_number_value(number);
    return json_is_number(number) && isfinite(*value);
}

static bool read_pose(const json_t *value, struct lattice_pose *pose)
{
    return json_array_size(value) == 3 && element(value, 0, &pose->x) && element(value, 1, &pose->y) &&
           element(value, 2, &pose->heading);
}

/* Appends poses on the way to the next one, as close as a sweep needs them. False when they are too many. */
static bool extend(struct lattice_path *path, const struct lattice_pose *to)
{
    const struct lattice_pose from = path->poses[path->count - 1];
    const double way = strict_hypot(to->x - from.x, to->y - from.y) / LATTICE_SPACING;
    const double turn = remainder(to->heading - from.heading, 2 * LATTICE_PI);
    const double steps = ceil(fmax(way, fabs(turn) / LATTICE_TURN));

    if (!(steps < (double)(LATTICE_POSES_MAX - path->count))) {
        return false;
    }
    for (size_t i = 1; i <= (size_t)steps; i++) {
        const double share = (double)i / steps;
        path->poses[path->count++] = (struct lattice_pose){
            from.x + (to->x - from.x) * share, from.y + (to->y - from.y) * share, from.heading + turn * share};
    }
    return true;
}

static const char *read_path(const json_t *poses, struct lattice_path *path)
{
    struct lattice_pose pose;

    path->count = 0;
    for (size_t i = 0; i < json_array_size(poses); i++) {
        if (!read_pose(json_array_get(poses, i), &pose)) {
            return "a pose is not three numbers";
        }
        if (i == 0) {
            path->poses[path->count++] = pose;
        } else if (!extend(path, &pose)) {
            return "its path is too long";
        }
    }
    return path->count < 2 ? "it goes nowhere" : NULL;
}

/* Largest curvature, rad/cell. */
static double sharpest(const struct lattice_path *path)
{
    double largest = 0;

    for (size_t i = 1; i < path->count; i++) {
        const struct lattice_pose *from = &path->poses[i - 1];
        const struct lattice_pose *to = &path->poses[i];
        largest = fmax(largest, fabs(to->heading - from->heading) / strict_hypot(to->x - from->x, to->y - from->y));
    }
    return largest;
}

static bool is_near(const struct lattice *lattice, const struct lattice_pose *pose, double x, double y,
                    unsigned heading)
{
    return strict_hypot(pose->x - x, pose->y - y) <= END_TOLERANCE &&
           fabs(remainder(pose->heading - lattice->headings[heading], 2 * LATTICE_PI)) <= END_TOLERANCE;
}

/* NULL, or what is wrong with the primitive. */
static const char *read_primitive(const struct lattice *lattice, json_t *value, struct lattice_primitive *primitive)
{
    int start;
    int end;
    json_t *poses;

    if (json_unpack(value, "{s:i, s:i, s:i, s:i, s:F, s:o}", "start", &start, "end", &end, "dx", &primitive->dx, "dy",
                    &primitive->dy, "factor", &primitive->factor, "poses", &poses) != 0) {
        return "start, end, dx, dy, factor or poses is missing";
    }
    if (!(primitive->factor >= 1 && primitive->factor <= UINT16_MAX)) {
        return "its factor is not in 1 to 65535";
    }
    if (start < 0 || start >= JP_HEADINGS || end < 0 || end >= JP_HEADINGS || abs(primitive->dx) > LATTICE_REACH ||
        abs(primitive->dy) > LATTICE_REACH) {
        return "start, end, dx or dy is out of range";
    }
    primitive->start = (unsigned)start;
    primitive->end = (unsigned)end;
    const char *fault = read_path(poses, &primitive->path);
    if (fault != NULL) {
        return fault;
    }
    const struct lattice_pose *last = &primitive->path.poses[primitive->path.count - 1];
    if (!is_near(lattice, &primitive->path.poses[0], 0, 0, primitive->start) ||
        !is_near(lattice, last, primitive->dx, primitive->dy, primitive->end)) {
        return "its path does not lead from its start to its end";
    }
    const bool moves = primitive->dx != 0 || primitive->dy != 0;
    if (!moves && start == end) {
        return "it goes nowhere";
    }
    if (moves && !(sharpest(&primitive->path) < INFINITY)) {
        return "it turns without moving on the way";
    }
    return lattice_find_moves(primitive) ? NULL : "no unit steps lead along it";
}

static bool read_primitives(const char *path, const json_t *values, struct lattice *lattice)
{
    const size_t count = json_array_size(values);
    if (count == 0 || count > PRIMITIVES_MAX) {
        error_line("%s: %zu primitives: must be 1 to %d; import another file", path, count, PRIMITIVES_MAX);
        return false;
    }
    lattice->primitives = calloc(count, sizeof *lattice->primitives);
    if (lattice->primitives == NULL) {
        error_line("%s: no memory for %zu primitives; import a smaller file", path, count);
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        struct lattice_primitive *primitive = &lattice->primitives[i];
        const char *fault = read_primitive(lattice, json_array_get(values, i), primitive);
        if (fault != NULL) {
            error_line("%s: primitive %zu: %s; correct it, or import another file", path, i, fault);
            return false;
        }
        lattice->count = i + 1;
        lattice_drive(lattice, primitive, sharpest(&primitive->path));
    }
    return true;
}

static bool read_headings(const char *path, const json_t *values, struct lattice *lattice)
{
    bool valid = json_array_size(values) == JP_HEADINGS;

    for (size_t i = 0; i < JP_HEADINGS && valid; i++) {
        valid = element(values, i, &lattice->headings[i]);
    }
    if (!valid) {
        error_line("%s: headings_rad: must be %d numbers; import another file", path, JP_HEADINGS);
    }
    return valid;
}

static bool read_root(const char *path, const json_t *root, struct lattice *lattice)
{
    const json_t *resolution = json_object_get(root, "resolution_m");

    lattice->counts_rounding = true;
    lattice->resolution_m = json_number_value(resolution);
    if (!(lattice->resolution_m >= 0.01 && lattice->resolution_m <= 10)) {
        error_line("%s: resolution_m: must be 0.01 to 10 m; import another file", path);
        return false;
    }
    return read_headings(path, json_object_get(root, "headings_rad"), lattice) &&
           read_primitives(path, json_object_get(root, "primitives"), lattice);
}

bool lattice_from_json(const char *path, struct lattice *lattice)
{
    json_error_t error;
    json_t *root = json_load_file(path, 0, &error);
    if (root == NULL) {
        error_line("%s: line %d: %s; make it with python -m tools.design.lattice", path, error.line, error.text);
        return false;
    }
    const bool read = read_root(path, root, lattice);
    json_decref(root);
    return read;
}
