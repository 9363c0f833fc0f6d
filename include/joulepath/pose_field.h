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
 * A cell is dealt with at once: turns among its headings are settled, the least value first, before steps leave it.
 *
 * It grows in slices up to a limit; poses beyond it are not reached. The map must not change while it grows; afterwards
 * a change makes it outdated, not invalid. Memory: the caller's block, three bytes and two bits a cell and heading and
 * four bytes a row: 4.5 MiB for 300 × 300 cells. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_POSE_FIELD_H
#define JOULEPATH_POSE_FIELD_H

#include <joulepath/lattice.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum jp_pose_field_sense { JP_POSE_FIELD_FROM_ROOT, JP_POSE_FIELD_TO_ROOT };

/**
 * Private: the values of the poses, and which of them are to be dealt with. Fresh ones, whose values have fallen, are
 * handed out cell by cell and about in the order of their values: in sweeps to and fro over the rows up to a threshold,
 * which rises when a sweep hands out none.
 */
struct jp_pose_wave {
    uint16_t *low;      /**< of the value of a pose, by cell and heading; all bits of both are set where none is */
    uint8_t *high;      /**< its bits from 16 on */
    uint16_t *fresh;    /**< headings of a cell: bits */
    jp_cost *row_least; /**< no fresh value of a row is less */
    uint16_t width;
    uint16_t height;
    uint32_t step; /**< of the threshold */
    uint32_t threshold;
    jp_cost limit;
    jp_cost left; /**< least fresh value that this sweep has left */
    int32_t row;  /**< where this sweep is */
    int32_t column;
    int32_t direction; /**< of it: 1 or -1 */
    uint32_t looks;    /**< in vain, that are not counted yet */
    bool has_taken;    /**< this sweep has handed out poses */
};

/** Private: the straight unit step of a heading, as a way from the root outward takes it. */
struct jp_pose_step {
    const struct jp_primitive *primitive; /**< null: the lattice has none */
    const struct jp_slope_cost *move;
    jp_cost least;               /**< that it takes */
    int32_t outward;             /**< to the cell where it leads, cells of the map */
    struct jp_cell_offset end;   /**< that cell */
    struct jp_cell_offset begin; /**< where it begins: here, or by sense inward there */
};

/** The members are private. */
struct jp_pose_field {
    const struct jp_lattice *lattice;
    const struct jp_terrain *terrain;
    enum jp_cost_kind kind;
    enum jp_pose_field_sense sense;
    struct jp_pose_step step[JP_HEADINGS];
    struct jp_turns turns;        /**< of a way from the root outward, or by sense inward: from near to far */
    uint16_t onward[JP_HEADINGS]; /**< headings to which, or by sense from which, no other turn lies between: bits */
    bool is_plain;                /**< the map: nothing on it multiplies what motions cost */
    bool is_level;                /**< steps take the least on it */
    uint16_t *barred;             /**< of a cell the headings whose step outward cannot be driven: bits */
    uint32_t prepared;            /**< rows of the map that are cleared and know what is barred, times headings */
    struct jp_pose_wave wave;
    uint16_t root_x;
    uint16_t root_y;
    uint16_t headings; /**< of the root: bits */
    uint32_t map_version;
    bool is_done;
};

/** Bytes for a map; 0 when its configuration is out of range. Constant time. */
size_t jp_pose_field_size(const struct jp_terrain_config *config);

/** Binds a field to a lattice, a map and `size` bytes of the caller; it must be started before it grows.
 *  JP_ERR_ARGUMENT: a null pointer. JP_ERR_MEMORY: `size` is below jp_pose_field_size(). JP_ERR_ALIGNMENT: `block`
 *  is not aligned to 8 bytes. Constant time. */
enum jp_status jp_pose_field_init(struct jp_pose_field *field, const struct jp_lattice *lattice, enum jp_cost_kind kind,
                                  const struct jp_terrain *terrain, void *block, size_t size);

/** Takes other costs, as a tariff makes them of the same lattice; jp_pose_field_start() must follow. Constant time. */
void jp_pose_field_set_lattice(struct jp_pose_field *field, const struct jp_lattice *lattice);

/** Starts anew with the root at cell (x, y), at any of its headings, up to costs of `limit`, at most JP_COST_MAX − 2.
 *  JP_ERR_ARGUMENT: a null pointer, no heading, or a limit beyond that. JP_ERR_OUTSIDE: the root is off the map.
 *  Work: the primitives, and JP_HEADINGS³ additions. */
enum jp_status jp_pose_field_start(struct jp_pose_field *field, enum jp_pose_field_sense sense, int32_t x, int32_t y,
                                   uint16_t headings, jp_cost limit);

/** Continues to grow, over at most *poses poses and those of a cell, which counts down. True when done. Work: of a pose
 *  a step, its turns and JP_HEADINGS looks; or before that of a row for one heading, by 32 cells, what the step sweeps;
 *  a pose is counted for 8 cells of it. At last it looks through a row, or at each row. */
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
