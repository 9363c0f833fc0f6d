#include <joulepath/path_drive.h>

#include <stddef.h>

#include "src/base/config_check.h"
#include "src/base/integer.h"
#include "src/trajectory/path_piece.h"

#define FIELD(member, low, high) JP_CONFIG_FIELD("path_drive.", struct jp_path_drive_config, member, low, high)

/** Q40 by Q16. */
#define FRACTION_BITS 24

/** Shares of a step in Q8. */
#define SHARE_BITS 8U
#define SHARE_ONE  ((int32_t)1 << SHARE_BITS)

/** Most that the robot may be turned from the set-point for the law to look at, 2⁻³² turn. */
#define TURNED_MAX ((int32_t)JP_ANGLE_DEGREES(60))

/** Most that it aims at the path and leans, rad: turning there makes it slide, too. */
#define AIM_MAX JP_Q24(0.5)

/** Counter-moves within a turn on the spot, of the most that it takes the robot from its place: so far, and by 3/4 of
 * it in the mean. */
#define MOVE_MAX  JP_Q24(0.87)
#define MOVE_MEAN JP_Q24(0.65)

/** Of what a slope makes a robot slide by the radian where nothing limits it, or at most, treads yield so much about
 * there: (1 + x⁴)^(-1/4) of the former over the latter (skid_odometry.h). */
#define YIELDING_MAX JP_Q24(0.8)

/** Pieces that are looked at for what the robot will slide. */
#define PIECES_AHEAD 3U

/** 2π in Q28. */
#define RADIANS_PER_TURN 1686629713

enum jp_status jp_path_drive_init(struct jp_path_drive *drive, const struct jp_path_drive_config *config,
                                  const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(tick_rate, JP_TICK_RATE_MIN, JP_TICK_RATE_MAX),
        FIELD(way, JP_Q24(0.01), JP_Q24(8)),
        FIELD(pace, 0, JP_Q24(64)),
        FIELD(speed_correction, 0, JP_Q24(8)),
        FIELD(turn_correction, 0, JP_Q24(8)),
    };

    if (drive == NULL) {
        return JP_ERR_ARGUMENT;
    }
    const enum jp_status status = jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);

    if (status == JP_OK) {
        drive->internal = (struct jp_path_drive_internal){
            .config = *config,
            .period = (int32_t)JP_TICKS_PER_PATH_POINT * jp_phase_per_rate(config->tick_rate),
            .pace_rate = (int32_t)config->tick_rate / (int32_t)JP_TICKS_PER_PATH_POINT,
            .per_way = jp_q24_divide(JP_Q24_ONE, config->way),
        };
    }
    return status;
}

/** At the begin of its piece. */
static void set_begin(struct jp_path_drive_internal *d, const struct jp_point *begin)
{
    d->x = (int64_t)begin->x * (1 << FRACTION_BITS);
    d->y = (int64_t)begin->y * (1 << FRACTION_BITS);
}

void jp_path_drive_begin(struct jp_path_drive *drive, const struct jp_lattice_path *path)
{
    struct jp_path_drive_internal *d = &drive->internal;

    d->path = path;
    d->piece = 0;
    d->speed = 0;
    d->progress = 0;
    d->looked_at = 0;
    d->lead = 0;
    d->turn_slides = 0;
    d->lean = 0;
    d->is_to_lean = true;
    d->move = 0;
    set_begin(d, path->count > 0U ? &path->pieces[0].begin : &path->end.position);
}

/** Of a step of `period` from here on, the share that lies beyond a place on the piece, Q8. */
static int32_t share_beyond(const struct jp_path_drive_internal *d, int32_t period, jp_q24 place)
{
    const jp_q24 way = jp_multiply_shift(d->speed, period, 32);
    const jp_q24 ahead = place - d->progress;

    if (ahead >= way) {
        return 0;
    }
    return ahead <= 0 ? SHARE_ONE : SHARE_ONE - ahead * SHARE_ONE / way;
}

/** A step of speed, towards `target`, and of progress on the piece. Returns the change of speed. */
static jp_q24 step_towards(struct jp_path_drive_internal *d, jp_q24 target, jp_q24 acceleration, int32_t period)
{
    const jp_q24 most = jp_multiply_shift(acceleration, period, 32);
    const jp_q24 change = jp_clamp32(target - d->speed, -most, most);

    d->progress += jp_multiply_shift(d->speed + change / 2, period, 32);
    d->speed += change;
    return change;
}

/** A step towards the cruise, and from where it must be left to the end. */
static jp_q24 step(struct jp_path_drive_internal *d, const struct jp_piece_speed *speed, int32_t period)
{
    const int32_t rest = jp_multiply_shift(period, share_beyond(d, period, speed->brake_from), SHARE_BITS);
    jp_q24 change = 0;

    if (rest < period) {
        change = step_towards(d, speed->cruise, speed->acceleration, period - rest);
    }
    if (rest > 0) {
        change += step_towards(d, speed->end, speed->acceleration, rest);
    }
    return change;
}

/** To the begin of the next piece. */
static void next_piece(struct jp_path_drive_internal *d)
{
    d->progress = 0;
    d->piece++;
    set_begin(d, d->piece < d->path->count ? &d->path->pieces[d->piece].begin : &d->path->end.position);
}

/** A step that leads on to the next piece, each part of it by the speeds of its own. */
static jp_q24 step_over(struct jp_path_drive_internal *d, const struct jp_path_piece *piece, int32_t share)
{
    const int32_t rest = jp_multiply_shift(d->period, share, SHARE_BITS);
    const jp_q24 change = step(d, &piece->speed, d->period - rest);

    next_piece(d);
    return change + step(d, &piece[1].speed, rest);
}

/** A step to a stand at the end of the piece. */
static jp_q24 step_to_stand(struct jp_path_drive_internal *d, const struct jp_path_piece *piece)
{
    const jp_q24 change = step(d, &piece->speed, d->period);

    if (d->progress >= piece->length || d->speed == 0) {
        d->speed = 0;
        next_piece(d);
        return 0;
    }
    return change;
}

/** Returns the change of speed. */
static jp_q24 step_on(struct jp_path_drive_internal *d, const struct jp_path_piece *piece)
{
    if (piece->speed.end == 0) {
        return step_to_stand(d, piece);
    }
    const int32_t share = share_beyond(d, d->period, piece->length);

    return share > 0 ? step_over(d, piece, share) : step(d, &piece->speed, d->period);
}

static jp_angle heading_at(const struct jp_path_piece *piece, jp_q24 way)
{
    return piece->heading + jp_angle_from_radians(jp_piece_turned(piece, way));
}

static struct jp_path_bend bend_at(const struct jp_path_drive_internal *d, const struct jp_path_piece *piece)
{
    const bool goes_on = d->piece + 1U < d->path->count;

    return jp_piece_bend_at(piece, goes_on ? &piece[1] : NULL, d->progress);
}

static void set_curve(struct jp_path_drive_internal *d, const struct jp_path_piece *piece, jp_q24 way,
                      struct jp_path_set_point *at)
{
    const struct jp_path_bend bend = bend_at(d, piece);
    const jp_q24 square = jp_q24_multiply(d->speed, d->speed);

    d->x += jp_multiply(at->cosine, way) >> 15;
    d->y += jp_multiply(at->sine, way) >> 15;
    at->motion = (struct jp_motion){d->speed, jp_q24_multiply(bend.bend, d->speed)};
    at->turn_acceleration =
        jp_add(jp_q24_multiply(bend.bend, at->acceleration), jp_multiply_shift(bend.rate, square, 16));
}

static void set_turn(const struct jp_path_drive_internal *d, const struct jp_path_piece *piece,
                     struct jp_path_set_point *at)
{
    const bool is_left = piece->kind == JP_PIECE_TURN_LEFT;

    at->motion = (struct jp_motion){0, is_left ? d->speed : -d->speed};
    at->turn_acceleration = is_left ? at->acceleration : -at->acceleration;
    at->acceleration = 0;
}

/** `way`: of the step on this piece. */
static void set_point_on(struct jp_path_drive_internal *d, const struct jp_path_piece *piece, jp_q24 way,
                         struct jp_path_set_point *at)
{
    const jp_angle middle = heading_at(piece, d->progress - way / 2);

    at->cosine = jp_cos(middle);
    at->sine = jp_sin(middle);
    if (piece->kind == JP_PIECE_CURVE) {
        set_curve(d, piece, way, at);
    } else {
        set_turn(d, piece, at);
    }
    at->pose.heading = heading_at(piece, d->progress);
}

/** At rest where the path ends. */
static void set_end(const struct jp_lattice_path *path, struct jp_path_set_point *at)
{
    at->motion = (struct jp_motion){0, 0};
    at->acceleration = 0;
    at->turn_acceleration = 0;
    at->cosine = jp_cos(path->end.heading);
    at->sine = jp_sin(path->end.heading);
    at->pose.heading = path->end.heading;
}

bool jp_path_drive_advance(struct jp_path_drive *drive, struct jp_path_set_point *set_point)
{
    struct jp_path_drive_internal *d = &drive->internal;

    if (d->path == NULL || d->piece == d->path->count) {
        return false;
    }
    const uint16_t piece = d->piece;
    const jp_q24 before = d->progress;
    const jp_q24 change = step_on(d, &d->path->pieces[piece]);
    const jp_q24 way = d->piece == piece ? d->progress - before : d->progress;

    set_point->acceleration = jp_saturate32(jp_multiply(change, d->pace_rate));
    if (d->piece < d->path->count) {
        set_point_on(d, &d->path->pieces[d->piece], way, set_point);
    } else {
        set_end(d->path, set_point);
    }
    set_point->pose.position = (struct jp_point){(jp_q16)(d->x >> FRACTION_BITS), (jp_q16)(d->y >> FRACTION_BITS)};
    return true;
}

/* What the robot will slide. */

/** Of a piece; of a curve at most `longest`. */
static struct jp_path_stretch stretch_of(const struct jp_path_piece *piece, jp_q24 from, jp_q24 longest)
{
    const jp_q24 rest = piece->length - from;

    if (piece->kind != JP_PIECE_CURVE) {
        return (struct jp_path_stretch){piece->kind == JP_PIECE_TURN_LEFT ? rest : -rest, 0};
    }
    const jp_q24 way = rest < longest ? rest : longest;

    return (struct jp_path_stretch){jp_q24_multiply(jp_piece_bend(piece, jp_add(from, way / 2)), way), way};
}

/** How far it slides to the left on a stretch that begins `turned` to the left of where the grades are given. */
static jp_q24 slide_on(const struct jp_path_slide *slide, const struct jp_path_stretch *stretch, jp_q24 turned)
{
    const jp_q24 middle = jp_add(turned, stretch->turn / 2);
    const jp_q24 ahead = jp_add(slide->ahead, jp_q24_multiply(slide->left, middle));
    const jp_q24 left = jp_sub(slide->left, jp_q24_multiply(slide->ahead, middle));
    const jp_q24 pushed = jp_q24_multiply(slide->by_left, ahead);
    const jp_q24 by_turn =
        jp_sub(stretch->turn < 0 ? jp_sub(0, pushed) : pushed, jp_q24_multiply(slide->by_turn, left));

    return jp_sub(
        jp_q24_multiply(jp_clamp32(by_turn, -slide->most, slide->most), (jp_q24)jp_magnitude32(stretch->turn)),
        jp_q24_multiply(jp_q24_multiply(slide->by_way, left), stretch->way));
}

/** 1/(base + MOVE_MEAN turn), for a base of 1 or 2. */
static jp_q24 share_of_turn(int32_t base, jp_q24 turn)
{
    const int32_t whole = jp_add(base * JP_Q24_ONE, jp_q24_multiply(MOVE_MEAN, turn)) >> 14; /* Q10 */

    return (((int32_t)1 << 30) / whole) * 16;
}

/** What a stretch makes up for before, of what it slides there: of a curve nothing, for the robot leans against it. */
static jp_q24 lead_of(const struct jp_path_stretch *stretch, jp_q24 slides)
{
    return stretch->way > 0 ? 0 : jp_q24_multiply(slides, share_of_turn(2, (jp_q24)jp_magnitude32(stretch->turn)));
}

/** The stretch that is driven now. */
static void note_turn(struct jp_path_drive_internal *d, const struct jp_path_stretch *stretch, jp_q24 slides)
{
    if (stretch->way == 0) {
        d->turn_slides = slides;
        d->turn_share = share_of_turn(1, (jp_q24)jp_magnitude32(stretch->turn));
    }
}

static bool is_looked_over(const struct jp_path_drive_internal *d)
{
    return d->looked_at == PIECES_AHEAD || d->looked_from + d->looked_at >= d->path->count ||
           d->seen.way >= 2 * d->config.way;
}

/** How far a piece turns from a place on it to another, rad. */
static jp_q24 turned_between(const struct jp_path_piece *piece, jp_q24 from, jp_q24 to)
{
    return jp_sub(jp_piece_turned(piece, to), jp_piece_turned(piece, from));
}

/** How far the path turns on the next `way`, to the end of the next piece at most, or to a turn on the spot. */
static jp_q24 turn_ahead(const struct jp_path_drive_internal *d, const struct jp_path_piece *piece, jp_q24 way)
{
    const jp_q24 beyond = d->progress + way - piece->length;

    if (beyond <= 0) {
        return turned_between(piece, d->progress, d->progress + way);
    }
    const jp_q24 rest = turned_between(piece, d->progress, piece->length);

    if (d->piece + 1U == d->path->count || piece[1].kind != JP_PIECE_CURVE) {
        return rest;
    }
    return jp_add(rest, jp_piece_turned(&piece[1], beyond < piece[1].length ? beyond : piece[1].length));
}

/** The same of the last `way`. */
static jp_q24 turn_behind(const struct jp_path_drive_internal *d, const struct jp_path_piece *piece, jp_q24 way)
{
    const jp_q24 beyond = way - d->progress;

    if (beyond <= 0) {
        return turned_between(piece, -beyond, d->progress);
    }
    const jp_q24 turned = jp_piece_turned(piece, d->progress);

    if (d->piece == 0U || piece[-1].kind != JP_PIECE_CURVE) {
        return turned;
    }
    const jp_q24 from = piece[-1].length - beyond;

    return jp_add(turned, turned_between(&piece[-1], from > 0 ? from : 0, piece[-1].length));
}

/** How far it shall be turned to the left of the path, so that it goes along it while it slides. A robot that a turn
 * slides outwards turns about its front axle, which turns before its middle, and else about its rear one. */
static jp_q24 lean_on(const struct jp_path_drive_internal *d, const struct jp_path_slide *slide)
{
    const struct jp_path_piece *piece = &d->path->pieces[d->piece];
    const jp_q24 pushed = jp_q24_multiply(slide->by_left, slide->ahead);
    const jp_q24 crept = jp_q24_multiply(slide->by_turn, slide->left);
    const jp_q24 left_turn = jp_clamp32(jp_sub(crept, pushed), -slide->most, slide->most); /* to the right */
    const jp_q24 right_turn = jp_clamp32(jp_sub(jp_sub(0, crept), pushed), -slide->most, slide->most); /* to the left */
    const jp_q24 ahead = turn_ahead(d, piece, slide->most);
    const jp_q24 behind = turn_behind(d, piece, slide->most);
    const jp_q24 left = left_turn > 0 ? ahead : behind;
    const jp_q24 right = right_turn > 0 ? ahead : behind;
    const jp_q24 slides =
        jp_add(left > 0 ? jp_q24_multiply(left, left_turn) : 0, right < 0 ? jp_q24_multiply(right, right_turn) : 0);
    const jp_q24 by_turn = jp_q24_multiply(jp_q24_multiply(slides, YIELDING_MAX), slide->per_most);

    return jp_clamp32(jp_add(by_turn, jp_q24_multiply(slide->by_way, slide->left)), -AIM_MAX, AIM_MAX);
}

/** Against what it slides on a curve. */
static void lean(struct jp_path_drive_internal *d, const struct jp_path_slide *slide)
{
    const bool is_on_curve = d->piece < d->path->count && d->path->pieces[d->piece].kind == JP_PIECE_CURVE;

    d->lean = is_on_curve ? lean_on(d, slide) : 0;
}

/** One more piece. */
static void look_on(struct jp_path_drive_internal *d, const struct jp_path_slide *slide)
{
    const bool begins = d->looked_at == 0U;

    if (begins) {
        d->looked_from = d->piece;
        d->seen = (struct jp_path_stretch){0, 0};
        d->leads = 0;
        d->turn_slides = 0;
    }
    if (!is_looked_over(d)) {
        const struct jp_path_stretch next = stretch_of(&d->path->pieces[d->looked_from + d->looked_at],
                                                       begins ? d->progress : 0, 2 * d->config.way - d->seen.way);
        const jp_q24 slides = slide_on(slide, &next, d->seen.turn);

        if (begins) {
            note_turn(d, &next, slides);
        }
        d->leads = jp_add(d->leads, lead_of(&next, slides));
        d->seen.turn = jp_add(d->seen.turn, next.turn);
        d->seen.way += next.way;
        d->looked_at++;
    }
    if (is_looked_over(d)) {
        d->lead = d->leads;
        d->looked_at = 0;
        d->is_to_lean = true;
    }
}

void jp_path_drive_look_ahead(struct jp_path_drive *drive, const struct jp_path_slide *slide)
{
    struct jp_path_drive_internal *d = &drive->internal;

    if (d->is_to_lean) {
        d->is_to_lean = false;
        lean(d, slide);
    } else {
        look_on(d, slide);
    }
}

/* The way back. */

/** What is left of a turn on the spot, rad; without one, nothing. */
static jp_q24 rest_of_turn(const struct jp_path_drive_internal *d)
{
    if (d->piece == d->path->count || d->path->pieces[d->piece].kind == JP_PIECE_CURVE) {
        return 0;
    }
    return d->path->pieces[d->piece].length - d->progress;
}

/** How far it should be turned to the right of the path, rad: more and more towards the end of a turn on the spot, and
 *  not at the path's end. */
static jp_q24 aim_at(const struct jp_path_drive_internal *d, jp_q24 left)
{
    const jp_q24 rest = rest_of_turn(d);
    const jp_q24 aim = jp_clamp32(jp_multiply_shift(left, d->per_way, 25), -AIM_MAX, AIM_MAX);

    if (rest == 0) {
        return d->piece == d->path->count ? 0 : aim;
    }
    return rest >= JP_Q24_ONE || d->piece + 1U == d->path->count ? 0 : jp_q24_multiply(aim, JP_Q24_ONE - rest);
}

/** How far ahead of its place a turn on the spot shall move it, m: as far as leaves it no farther away than what is
 * left to slide takes it in any case. */
static jp_q24 move_in_turn(const struct jp_path_drive_internal *d, jp_radians_per_s turn_rate, jp_q24 left)
{
    const bool slides_left = d->turn_slides > 0;
    const jp_q24 aside = slides_left ? left : jp_sub(0, left);
    const jp_q24 size = (jp_q24)jp_magnitude32(left);
    const jp_q24 most = jp_q24_multiply(jp_add(aside, (jp_q24)jp_magnitude32(d->turn_slides)), d->turn_share);
    const jp_q24 beyond = jp_sub(most, size);
    const jp_q24 room = beyond < most / 2 ? jp_add(beyond, beyond) : most;

    if (d->turn_slides == 0 || room <= 0) {
        return 0;
    }
    const jp_q24 move = jp_q24_multiply(MOVE_MAX, room);
    const bool turns_left = turn_rate > 0;

    return slides_left == turns_left ? move : -move;
}

/** No faster than speeds may be corrected. */
static void move_on(struct jp_path_drive_internal *d, jp_radians_per_s turn_rate, jp_q24 left)
{
    const jp_q24 change = jp_multiply_shift(d->config.speed_correction, d->period, 32);

    d->move = jp_clamp32(move_in_turn(d, turn_rate, left), d->move - change, d->move + change);
}

/** m in Q24 of a sum of products of Q16 and Q31. */
static jp_q24 metres(int64_t sum)
{
    return jp_saturate32(sum >> 22);
}

void jp_path_drive_track(struct jp_path_drive *drive, const struct jp_path_set_point *set_point,
                         const struct jp_path_pose *pose, struct jp_motion *motion)
{
    struct jp_path_drive_internal *d = &drive->internal;
    const struct jp_path_drive_config *config = &d->config;
    const int32_t dx = jp_sub(pose->position.x, set_point->pose.position.x);
    const int32_t dy = jp_sub(pose->position.y, set_point->pose.position.y);
    const jp_q24 ahead = metres(jp_multiply(dx, set_point->cosine) / 2 + jp_multiply(dy, set_point->sine) / 2);
    const jp_q24 left = metres(jp_multiply(dy, set_point->cosine) / 2 - jp_multiply(dx, set_point->sine) / 2);
    const int32_t turned = jp_clamp32((int32_t)(pose->heading - set_point->pose.heading), -TURNED_MAX, TURNED_MAX);
    const jp_q24 radians = jp_multiply_shift(turned, RADIANS_PER_TURN, 36);
    const jp_q24 rate = jp_q24_multiply(2 * set_point->motion.speed, d->per_way); /* 1/s */
    const jp_q24 pace = rate > config->pace ? rate : config->pace;
    const jp_q24 aim = jp_clamp32(aim_at(d, jp_add(left, d->lead)) - d->lean, -AIM_MAX, AIM_MAX);
    const jp_q24 turn_back = jp_q24_multiply(pace, radians + aim);

    move_on(d, set_point->motion.turn_rate, left);
    const jp_q24 back = jp_q24_multiply(config->pace, jp_sub(ahead, d->move));

    motion->speed = set_point->motion.speed - jp_clamp32(back, -config->speed_correction, config->speed_correction);
    motion->turn_rate =
        set_point->motion.turn_rate - jp_clamp32(turn_back, -config->turn_correction, config->turn_correction);
}
