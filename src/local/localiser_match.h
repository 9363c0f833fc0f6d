/** A scan laid over the map. Private to the localiser. */
#ifndef JOULEPATH_LOCAL_LOCALISER_MATCH_H
#define JOULEPATH_LOCAL_LOCALISER_MATCH_H

#include <joulepath/localiser.h>

/** What is known of the pose before. */
struct jp_localiser_prior {
    struct jp_plane_pose pose;
    float information[3][3];    /**< all 0: nothing is known */
    struct jp_plane_pose start; /**< where the steps begin */
    float spread;               /**< how far ends of beams may be off there, m */
    float weak;                 /**< directions with less information than this share of the most are left out */
    float noise;                /**< how far they are at the right pose, standard deviation, m */
};

struct jp_localiser_fit {
    struct jp_plane_pose pose;
    float information[3][3]; /**< of prior and scan together */
    float inliers;           /**< ends of beams on walls, as a share of all */
    float surprise;          /**< square of the way from the prior's pose, in its standard deviations */
};

/** The ends of the beams that see something up to range_max, in the robot's frame: every n-th, so that there are
 *  `points_max` or fewer. */
void jp_localiser_collect(struct jp_localiser_cloud *cloud, int32_t points_max, const struct jp_scan *scan,
                          const struct jp_plane_pose *sensor, float range_max);

/** The most probable pose by prior and scan. Work: ends of beams, up to 15 times. */
void jp_localiser_match(const struct jp_wall_field *field, const struct jp_localiser_cloud *cloud,
                        const struct jp_localiser_prior *prior, struct jp_localiser_fit *fit);

/** How every `stride`-th of the ends agrees with the map at a pose, to their noise. Work: the cells along their beams.
 */
void jp_localiser_compare(const struct jp_wall_field *field, const struct jp_localiser_cloud *cloud, int32_t stride,
                          const struct jp_plane_pose *pose, float noise, struct jp_localiser_view *view);

/** How every `stride`-th of the beams that see nothing up to range_max agrees with the map at a pose. Work: the cells
 *  along them. */
void jp_localiser_compare_empty(const struct jp_wall_field *field, const struct jp_localiser_input *input,
                                float range_max, int32_t stride, const struct jp_plane_pose *pose,
                                struct jp_localiser_view *view);

#endif
