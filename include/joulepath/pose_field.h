/**
 * Pose field: for every cell of a map and every heading the least cost of driving there from a root, or from there to
 * the root, by unit steps and turns.
 *
 * A robot at a pose drives the straight unit step of its heading, at what the lattice charges for that primitive over
 * the ground (lattice.h), or turns where it is, at the least that primitives take to turn so (jp_lattice_turns()), 1 or
 * more. A route of a lattice may save a little against this where it turns in motion and moves aside at once; it costs
 * more where its curves need more room than there is. Both ways are exact in this sense: uphill is dearer than
 * downhill.
 *
 * A cell is dealt with at once, whatever its headings: turns among them are settled before steps leave it.
 *
 * It grows in slices up to a limit; poses beyond it are not reached. The map must not change while it grows; afterwards
 * a change makes it outdated, not invalid. Memory: the caller's block, three bytes and two bits a cell and heading:
 * 4.6 MiB for 300 × 300 cells. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_POSE_FIELD_H
#define JOULEPATH_POSE_FIELD_H

#include <joulepath/lattice.h>
#include <joulepath/wavefront.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Largest width of a map, cells. */
#define JP_POSE_FIELD_WIDTH_MAX 4095

enum jp_pose_field_sense { JP_POSE_FIELD_FROM_ROOT, JP_POSE_FIELD_TO_ROOT };

/** The members are private. */
struct jp_pose_field {
    const struct jp_lattice *lattice;
    const struct jp_terrain *terrain;
    enum jp_cost_kind kind;
    enum jp_pose_field_sense sense;
    const struct jp_primitive *step[JP_HEADINGS]; /**< the straight one; null: the lattice has none */
    struct jp_turns turns;        /**< of a way from the root outward, or by sense inward: from near to far */
    uint16_t onward[JP_HEADINGS]; /**< headings to which, or by sense from which, no other turn lies between: bits */
    jp_cost least[JP_HEADINGS];   /**< that the straight step takes */
    bool is_level;                /**< the map: steps take that */
    uint32_t *barred;             /**< where the step of a heading cannot begin: bits, a map for each heading */
    uint16_t barred_rows;         /**< of them that are made */
    struct jp_wavefront wave;     /**< a column for each heading of each column of cells */
    uint16_t root_x;
    uint16_t root_y;
    uint16_t headings; /**< of the root: bits */
    uint32_t map_version;
    bool is_done;
};

/** Bytes for a map; 0 when its configuration is out of range. Constant time. */
size_t jp_pose_field_size(const struct jp_terrain_config *config);

/** Binds a field to a lattice, a map and `size` bytes of the caller; it must be started before it grows.
 *  JP_ERR_ARGUMENT: a null pointer. JP_ERR_OUTSIDE: the map is wider than JP_POSE_FIELD_WIDTH_MAX. JP_ERR_MEMORY:
 *  `size` is below jp_pose_field_size(). JP_ERR_ALIGNMENT: `block` is not aligned to 8 bytes. Constant time. */
enum jp_status jp_pose_field_init(struct jp_pose_field *field, const struct jp_lattice *lattice, enum jp_cost_kind kind,
                                  const struct jp_terrain *terrain, void *block, size_t size);

/** Takes other costs, as a tariff makes them of the same lattice; jp_pose_field_start() must follow. Constant time. */
void jp_pose_field_set_lattice(struct jp_pose_field *field, const struct jp_lattice *lattice);

/** Starts anew with the root at cell (x, y), at any of its headings, up to costs of `limit`, at most JP_COST_MAX − 2.
 *  JP_ERR_ARGUMENT: a null pointer, no heading, or a limit beyond that. JP_ERR_OUTSIDE: the root is off the map.
 *  Work: the primitives, and JP_HEADINGS³ additions. */
enum jp_status jp_pose_field_start(struct jp_pose_field *field, enum jp_pose_field_sense sense, int32_t x, int32_t y,
                                   uint16_t headings, jp_cost limit);

/** Continues to grow, over at most *poses poses and those of a cell, which counts down. True when done. Work: a step
 *  and the turns of a pose. */
bool jp_pose_field_grow(struct jp_pose_field *field, unsigned *poses);

/** The least cost between the root and a pose of the map; JP_COST_MAX where none up to the limit leads, off the map,
 * and until jp_pose_field_grow() has returned true. Constant time. */
jp_cost jp_pose_field_cost(const struct jp_pose_field *field, int32_t x, int32_t y, unsigned heading);

/** The same of the heading of a cell at which it is least. JP_HEADINGS looks. */
jp_cost jp_pose_field_least(const struct jp_pose_field *field, int32_t x, int32_t y);

/** From a pose one motion nearer to the root of a finished field: along a way of least cost, which with
 *  JP_POSE_FIELD_FROM_ROOT is the way here backward. False: the pose is a root, or was not reached. Work: a step and
 * the turns of a pose. */
bool jp_pose_field_next(const struct jp_pose_field *field, struct jp_lattice_pose *pose);

/** True when the map has changed since the field was started. Constant time. */
bool jp_pose_field_is_outdated(const struct jp_pose_field *field);

#ifdef __cplusplus
}
#endif

#endif
