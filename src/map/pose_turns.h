/** Turns among the headings of a cell, as a pose field takes them. Private to the core. */
#ifndef JOULEPATH_MAP_POSE_TURNS_H
#define JOULEPATH_MAP_POSE_TURNS_H

#include <joulepath/pose_field.h>

/** The poses of a cell while they are dealt with. Sets of headings are bits. */
struct jp_cell_poses {
    size_t cell;
    int32_t x;
    int32_t y;
    jp_cost value[JP_HEADINGS];
    uint32_t open;    /**< headings from which turns are yet to be looked at */
    uint32_t settled; /**< those from which they have been */
    uint32_t lowered; /**< headings that turns have lowered */
};

/** Takes the turns of the field's lattice for its sense. Work: the primitives, and JP_HEADINGS³ additions. */
void jp_pose_turns_take(struct jp_pose_field *field);

/** Of the turn by which a way outward passes from one heading at a cell to another. */
jp_cost jp_pose_turns_cost(const struct jp_pose_field *field, int32_t x, int32_t y, unsigned near, unsigned far);

/** Looks at turns from the open headings, and from those up to the threshold of the wave that they lower, until none
 *  is open. Returns how many were settled. Work: of each its turns, and JP_HEADINGS looks. */
unsigned jp_pose_turns_settle(const struct jp_pose_field *field, struct jp_cell_poses *cell);

#endif
