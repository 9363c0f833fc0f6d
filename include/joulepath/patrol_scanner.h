/** The laser scanner of a robot with four steered wheels. */
#ifndef JOULEPATH_PATROL_SCANNER_H
#define JOULEPATH_PATROL_SCANNER_H

#include <joulepath/plane.h>
#include <stdint.h>

struct jp_patrol_scanner {
    uint16_t beams;             /**< of a scan; 2 or more */
    float first_angle;          /**< of beam 0, counterclockwise from its heading, rad; −7…7 */
    float angle_step;           /**< to the next, rad; above 0, all beams within 7 */
    struct jp_plane_pose place; /**< on the robot */
};

#endif
