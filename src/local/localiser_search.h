/** Where on the map a scan may have been taken. Private to the localiser. */
#ifndef JOULEPATH_LOCAL_LOCALISER_SEARCH_H
#define JOULEPATH_LOCAL_LOCALISER_SEARCH_H

#include <joulepath/localiser.h>

/** What a search that has ended found. */
enum jp_localiser_finding {
    JP_LOCALISER_ONE_PLACE, /**< places[0] */
    JP_LOCALISER_MANY_PLACES,
    JP_LOCALISER_NO_PLACE
};

/** Begins a search of a region for the scan of which this is the cloud. */
void jp_localiser_search_begin(struct jp_localiser_search *search, const struct jp_localiser_cloud *cloud,
                               const struct jp_localiser_region *region);

/** Goes on by the work of so many nodes, or by one closer look more than that; returns how many, less when the search
 * has ended. */
unsigned jp_localiser_search_work(struct jp_localiser_search *search, const struct jp_wall_field *field,
                                  const struct jp_terrain *map, float noise, unsigned nodes);

/** Whether two poses are one place. */
bool jp_localiser_search_is_same(const struct jp_plane_pose *a, const struct jp_plane_pose *b);

/** Keeps a place if it is the best one, or the best apart from that. */
void jp_localiser_search_keep(struct jp_localiser_search *search, const struct jp_localiser_place *place);

enum jp_localiser_finding jp_localiser_search_finding(const struct jp_localiser_search *search);

#endif
