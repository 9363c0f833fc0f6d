#include "src/navigate/skid_run.h"

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
    run->limits = slowed_down(&config->limits, slower);
    run->rounded = 0;
    run->paced = 0;
}

enum jp_status jp_skid_run_lay(struct jp_skid_run *run, const struct jp_skid_pilot_config *config,
                               const struct jp_line_route *route, uint8_t slower)
{
    begin(run, config, slower);
    return jp_line_path(&run->path, config->pieces, config->places, route);
}

void jp_skid_run_lay_turn(struct jp_skid_run *run, const struct jp_skid_pilot_config *config,
                          const struct jp_path_pose *start, jp_angle heading)
{
    begin(run, config, 0);
    /* A robot that has the heading turns by no piece. */
    (void)jp_turn_path(&run->path, config->pieces, config->places, start, heading);
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

bool jp_skid_run_plan(struct jp_skid_run *run, const struct jp_skid_pilot_config *config,
                      const struct jp_skid_energy_model *model)
{
    const struct jp_motion_price price = jp_skid_motion_price(model, config->time);

    if (config->corner > 0 && run->rounded < run->path.count) {
        (void)jp_path_round_corner(&run->path, run->rounded, config->corner, &run->limits, &price);
        run->rounded++;
        return true;
    }
    if (run->paced < run->path.count) {
        plan_to_stand(run, &price);
        return true;
    }
    return false;
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
    /* A leg ends with its line; a turn on the spot may be all of a path. */
    while (end + 1U < run->path.count && !jp_piece_is_straight(&pieces[end])) {
        end++;
    }
    leg->end = (uint16_t)(end + 1U);
    return true;
}

void jp_skid_run_leg_energy(const struct jp_skid_run *run, const struct jp_skid_leg *leg,
                            const struct jp_skid_energy_model *model, struct jp_skid_drive *drive, jp_q16 *duration)
{
    jp_q24 speed = leg->speed;

    for (unsigned i = leg->begin; i < leg->end; i++) {
        const struct jp_path_piece *piece = &run->path.pieces[i];

        jp_skid_piece_energy(model, piece, speed, drive, duration);
        speed = piece->speed.end;
    }
}
