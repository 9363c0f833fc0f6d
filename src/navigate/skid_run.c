#include "src/navigate/skid_run.h"

#include <stddef.h>

#include "src/trajectory/path_piece.h"

/** Each step of being slower takes a quarter of the speed. */
static struct jp_path_limits slowed_down(const struct jp_path_limits *limits, uint8_t times)
{
    struct jp_path_limits slower = *limits;

    for (uint8_t i = 0; i < times; i++) {
        slower.speed -= slower.speed / 4;
    }
    return slower;
}

static void begin(struct jp_skid_run *run, const struct jp_skid_pilot_config *config, uint8_t slower)
{
    run->path.pieces = config->pieces;
    run->path.places = config->places;
    run->limits = slowed_down(&config->limits, slower);
    run->rounded = 0;
    run->paced = 0;
    run->halved = 0;
}

enum jp_status jp_skid_run_lay(struct jp_skid_run *run, const struct jp_skid_pilot_config *config,
                               const struct jp_line_route *route, uint8_t slower)
{
    begin(run, config, slower);

    /* What arcs in halves may take besides is left free. */
    const uint16_t places = (uint16_t)(config->places - route->count);
    const enum jp_status status = jp_line_path(&run->path, run->path.pieces, places, route);

    run->path.places = config->places;
    return status;
}

void jp_skid_run_lay_turn(struct jp_skid_run *run, const struct jp_skid_pilot_config *config,
                          const struct jp_line_route *route, jp_angle heading)
{
    begin(run, config, 0);
    /* A robot that has the heading turns by no piece. */
    (void)jp_turn_path(&run->path, run->path.pieces, run->path.places, route, heading);
}

/** Pieces from one stand to the next: the robot stands before and after each turn on the spot. */
static uint16_t pieces_to_stand(const struct jp_lattice_path *path, uint16_t from)
{
    uint16_t end = (uint16_t)(from + 1U);

    if (path->pieces[from].kind == JP_PIECE_CURVE) {
        while (end < path->count && path->pieces[end].kind == JP_PIECE_CURVE) {
            end++;
        }
    }
    return (uint16_t)(end - from);
}

/** What it takes is told by its legs; it cannot fail, with prices of a model and a configuration that were checked. */
static void plan_to_stand(struct jp_skid_run *run, const struct jp_motion_price *price)
{
    const uint16_t count = pieces_to_stand(&run->path, run->paced);
    struct jp_lattice_path part = {.pieces = &run->path.pieces[run->paced], .places = count, .count = count};
    struct jp_path_cost cost;

    (void)jp_path_plan_speeds(&part, &run->limits, price, &cost);
    run->paced = (uint16_t)(run->paced + count);
}

/* Arcs in halves, where the legs meet. */

static bool is_arc(const struct jp_path_piece *piece)
{
    return piece->kind == JP_PIECE_CURVE && piece->bend != 0;
}

static struct jp_point middle_of(const struct jp_path_piece *arc, jp_q24 turned)
{
    const jp_angle direction = arc->heading + jp_angle_from_radians(turned / 2);
    const jp_q24 chord = jp_divide(jp_multiply(jp_sin(jp_angle_from_radians(turned / 2)), 1 << 18), arc->bend);

    return (struct jp_point){arc->begin.x + jp_multiply_shift(chord, jp_cos(direction), 39),
                             arc->begin.y + jp_multiply_shift(chord, jp_sin(direction), 39)};
}

/** The halves are driven as the arc was. */
static void halve(struct jp_path_piece halves[2], jp_q24 begin)
{
    struct jp_path_piece *first = &halves[0];
    struct jp_path_piece *second = &halves[1];
    const jp_q24 way = first->length / 2;
    const jp_q24 turned = jp_piece_turned(first, way);
    const jp_q24 speed = jp_piece_speed_after(&first->speed, begin, way);
    const bool brakes = first->speed.brake_from < way;

    *second = *first;
    second->begin = middle_of(first, turned);
    second->heading += jp_angle_from_radians(turned);
    second->length -= way;
    second->rise -= first->rise / 2;
    second->speed.blend = 0;
    second->speed.blend_rate = 0;
    second->speed.brake_from = brakes ? 0 : first->speed.brake_from - way;
    first->length = way;
    first->rise /= 2;
    first->speed.end = speed;
    if (brakes) {
        second->speed.cruise = speed;
    } else {
        first->speed.cruise = speed;
        first->speed.brake_from = way;
    }
}

/** The next arc, if there is one: the line before it tells how fast it begins. */
static bool halve_next(struct jp_skid_run *run)
{
    struct jp_path_piece *pieces = run->path.pieces;

    while (run->halved < run->path.count && !is_arc(&pieces[run->halved])) {
        run->halved++;
    }
    if (run->halved == run->path.count) {
        return false;
    }
    for (unsigned i = run->path.count; i > run->halved + 1U; i--) {
        pieces[i] = pieces[i - 1U];
    }
    halve(&pieces[run->halved], pieces[run->halved - 1U].speed.end);
    run->path.count++;
    run->rounded++;
    run->paced++;
    run->halved = (uint16_t)(run->halved + 2U);
    return true;
}

/** The inner side drives half as fast as the middle, so that it drives on forward where treads slide by more than on
 * the ground of the model, as on slopes: those that stand or go back among others that drive make the robot hop. */
static jp_q24 radius_min(const struct jp_skid_energy_model *model)
{
    return 2 * model->half_track;
}

bool jp_skid_run_plan(struct jp_skid_run *run, const struct jp_skid_pilot_config *config,
                      const struct jp_skid_energy_model *model)
{
    const struct jp_motion_price price = jp_skid_motion_price(model, config->time);

    if (config->corner > 0 && run->rounded < run->path.count) {
        const struct jp_corner_room room = {.clearance = config->corner, .radius_min = radius_min(model)};

        (void)jp_path_round_corner(&run->path, run->rounded, &room, &run->limits, &price);
        run->rounded++;
        return true;
    }
    if (run->paced < run->path.count) {
        plan_to_stand(run, &price);
        return true;
    }
    return halve_next(run);
}

bool jp_skid_run_next_leg(const struct jp_skid_run *run, struct jp_skid_leg *leg)
{
    const struct jp_path_piece *pieces = run->path.pieces;
    uint16_t end = leg->end;

    if (end == run->path.count) {
        return false;
    }
    leg->begin = end;
    leg->speed = end == 0U ? 0 : pieces[end - 1U].speed.end;
    /* To its line, if it is not a turn alone, and to the middle of the arc after it. */
    while (end + 1U < run->path.count && !jp_piece_is_straight(&pieces[end])) {
        end++;
    }
    end++;
    while (end < run->path.count && pieces[end].is_joined) {
        end++;
    }
    leg->end = end < run->path.count && is_arc(&pieces[end]) ? (uint16_t)(end + 1U) : end;
    return true;
}

uint16_t jp_skid_run_end_of_ground(const struct jp_skid_run *run, const struct jp_skid_leg *leg)
{
    const struct jp_path_piece *pieces = run->path.pieces;
    uint16_t end = (uint16_t)(leg->begin + 1U);

    while (end < leg->end && jp_piece_is_on_the_same(&pieces[end - 1U], &pieces[end])) {
        end++;
    }
    return end;
}

/** By the model of a class of ground. */
static uint8_t add_by_class(const struct jp_skid_knowledge *known, uint8_t ground, const struct jp_path_piece *piece,
                            const struct jp_path_piece *next, jp_q24 speed, struct jp_skid_drive *drive,
                            jp_q16 *duration)
{
    const uint8_t known_class = ground < JP_GROUND_CLASSES ? ground : 0U;

    jp_skid_piece_energy(jp_skid_grounds_model(known->grounds, known->robot, known_class), piece, next, speed, drive,
                         duration);
    return known_class;
}

static void add_piece(const struct jp_skid_knowledge *known, const struct jp_path_piece *piece,
                      const struct jp_path_piece *next, jp_q24 speed, struct jp_skid_ground_drive *drive,
                      jp_q16 *duration)
{
    struct jp_skid_drive left = {.energy = 0};
    jp_q16 again = 0;
    const uint8_t on = add_by_class(known, piece->ground_left, piece, next, speed, &left, duration);

    drive->at_edges += piece->is_at_edge ? left.energy : 0;
    if (piece->ground_left == piece->ground_right) {
        jp_skid_drive_add(&drive->on[on], &left, 1);
    } else {
        struct jp_skid_drive right = {.energy = 0};
        const uint8_t other = add_by_class(known, piece->ground_right, piece, next, speed, &right, &again);

        /* Each side is on its own. */
        jp_skid_drive_add(&drive->on[on], &left, 2);
        jp_skid_drive_add(&drive->on[other], &right, 2);
    }
}

void jp_skid_run_leg_energy(const struct jp_skid_run *run, const struct jp_skid_leg *leg,
                            const struct jp_skid_knowledge *known, struct jp_skid_ground_drive *drive, jp_q16 *duration)
{
    jp_q24 speed = leg->speed;

    for (unsigned i = leg->begin; i < leg->end; i++) {
        const struct jp_path_piece *piece = &run->path.pieces[i];

        const struct jp_path_piece *next = i + 1U < run->path.count ? &piece[1] : NULL;

        add_piece(known, piece, next, speed, drive, duration);
        speed = piece->speed.end;
    }
}
