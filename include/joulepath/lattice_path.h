/**
 * Path of a robot that its sides steer, skid steer or differential drive, along a plan of the lattice: curves whose
 * curvature is linear in the arc length, which straight lines and arcs are too, and turns on the spot.
 *
 * Every primitive of a lattice that moves is such a curve, a clothoid, and its ends alone tell which one (Bertolazzi
 * and Frego, G1 fitting with clothoids, 2015). With the headings φ₀ and φ₁ at its ends against their chord and δ = φ₁ −
 * φ₀,
 *
 *   ∫₀¹ sin(φ(u)) du = 0,  φ(u) = φ₀ + (δ − A) u + A u²     gives A, by Newton's method
 *   length = chord / ∫₀¹ cos(φ(u)) du,  curvature = (δ − A)/length at its begin, (δ + A)/length at its end
 *
 * Each piece begins exactly at the centre of a cell, in a heading of the lattice. Straight lines that follow each other
 * become one piece where the ground is of one class and rises alike, and so do turns on the spot in one direction.
 *
 * The path is the caller's memory; path_speed.h plans its speeds, path_drive.h drives it. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_LATTICE_PATH_H
#define JOULEPATH_LATTICE_PATH_H

#include <joulepath/planner.h>
#include <joulepath/point.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Longest piece, m. */
#define JP_PIECE_LENGTH_MAX JP_Q24(64)

/** Largest curvature of a piece, 1/m. */
#define JP_PIECE_BEND_MAX JP_Q24(100)

enum jp_piece_kind { JP_PIECE_CURVE, JP_PIECE_TURN_LEFT, JP_PIECE_TURN_RIGHT };

/** Speeds of a piece, by path_speed.h: along a curve m/s and m/s², of a turn on the spot rad/s and rad/s². */
struct jp_piece_speed {
    jp_q24 cruise;       /**< that it speeds up or slows down to; above 0, at most 8 */
    jp_q24 end;          /**< at its end; 0…8; 0 before and after a turn on the spot, and at the end of the path */
    jp_q24 acceleration; /**< of every change; above 0, at most 64 */
    jp_q24 brake_from;   /**< where it begins to change to `end`; m or rad from its begin, within its length */
    jp_q24 blend;        /**< half of the way over which the curvature changes to that at its begin, m; 0, or at most
                              half of this piece and of the one before it */
    jp_q16 blend_rate;   /**< by so much a metre, 1/m² */
};

struct jp_path_piece {
    struct jp_point begin; /**< m, on the map */
    jp_angle heading;      /**< at its begin */
    jp_q24 length;         /**< of a curve m, of a turn on the spot rad; above 0, at most JP_PIECE_LENGTH_MAX */
    jp_q24 bend;           /**< curvature at its begin, to the left above 0, 1/m; ±JP_PIECE_BEND_MAX */
    jp_q16 bend_rate;      /**< of the curvature by the arc length, 1/m² */
    jp_q16 rise;           /**< of the ground over the whole piece, m */
    enum jp_piece_kind kind;
    uint8_t ground_left;  /**< class of the ground (ground.h) under the wheels of the left side, */
    uint8_t ground_right; /**< and of the right one */
    bool is_at_edge;      /**< within the ground's margin the wheels of a side are on another class */
    bool is_joined;       /**< the line of the piece before goes on in it */
    struct jp_piece_speed speed;
};

struct jp_path_pose {
    struct jp_point position; /**< m, on the map */
    jp_angle heading;
};

struct jp_lattice_path {
    struct jp_path_piece *pieces; /**< the caller's memory */
    uint16_t places;              /**< in it; at least 1 */
    uint16_t count;               /**< pieces of the path */
    struct jp_path_pose end;      /**< of the last piece */
};

/** An empty path in memory for `places` pieces. JP_ERR_ARGUMENT: a pointer is null, or there is no place. Constant
 *  time. */
enum jp_status jp_lattice_path_start(struct jp_lattice_path *path, struct jp_path_piece *pieces, uint16_t places);

/**
 * Adds a primitive of `lattice` from a cell of `terrain`, which tells the side of the cells and what the ground rises.
 * JP_ERR_MEMORY: all places are taken. JP_ERR_INFEASIBLE: its curve leads back or takes a detour, or it is longer,
 * shorter than 1 mm or more bent than a piece may be. JP_ERR_ARGUMENT: a null pointer. The path stays as it was then.
 * Work: 42 sines and 42 cosines.
 */
enum jp_status jp_lattice_path_add(struct jp_lattice_path *path, const struct jp_lattice *lattice,
                                   const struct jp_terrain *terrain, const struct jp_lattice_pose *from,
                                   const struct jp_primitive *primitive);

/** The path of the last plan that a planner has found, on its map. JP_ERR_NO_PLAN: it has none, or the plan has no
 *  step. Else as jp_lattice_path_start() and jp_lattice_path_add(). Work: as the latter for each step. */
enum jp_status jp_lattice_path_of_plan(struct jp_lattice_path *path, const struct jp_planner *planner,
                                       struct jp_path_piece *pieces, uint16_t places);

/** Tells the path, which is on a map, in the frame of a place on it: that of a robot's odometry that began there.
 * Points saturate. Work: a sine and a cosine, and four multiplications a piece. */
void jp_lattice_path_in_frame(struct jp_lattice_path *path, const struct jp_path_pose *origin);

/** Curvature of a piece so far from its begin, m; 1/m. Constant time. */
static inline jp_q24 jp_piece_bend(const struct jp_path_piece *piece, jp_q24 way)
{
    return jp_add(piece->bend, jp_multiply_shift(piece->bend_rate, way, 16));
}

/** How far it has turned to the left there, rad: of a curve, the integral of its curvature; of a turn on the spot the
 *  way, rad. Constant time. */
static inline jp_q24 jp_piece_turned(const struct jp_path_piece *piece, jp_q24 way)
{
    if (piece->kind == JP_PIECE_CURVE) {
        return jp_q24_multiply(jp_add(piece->bend, jp_multiply_shift(piece->bend_rate, way, 17)), way);
    }
    return piece->kind == JP_PIECE_TURN_LEFT ? way : -way;
}

#ifdef __cplusplus
}
#endif

#endif
