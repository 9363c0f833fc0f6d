/** Where the robot is, and what is around it. Private to the patrol. */
#ifndef JOULEPATH_LOCAL_PATROL_SENSE_H
#define JOULEPATH_LOCAL_PATROL_SENSE_H

#include <joulepath/patrol.h>

/** False: the wheels alone say where the robot is. */
bool jp_patrol_uses_laser(const struct jp_patrol *patrol);

/** The wheels' motion since the last cycle, then the laser's judgement of it. */
void jp_patrol_predict_pose(struct jp_patrol *patrol, const struct jp_patrol_input *input);

/** The mean of wheels and laser by the weights of their residuals: where these alone would put the band's first pose.
 */
void jp_patrol_correct_pose(struct jp_patrol *patrol);

/** Takes the scan. The obstacles of the last one stay when it is missing: they stand in the map's frame. */
void jp_patrol_look(struct jp_patrol *patrol, const struct jp_patrol_input *input);

#endif
