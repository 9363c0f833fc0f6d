/**
 * Where a robot with a laser scanner is on a known map: an extended Kalman filter over its pose. The wheels
 * predict, each scan laid over the map corrects.
 *
 *   start ─▶ DEGRADED ◀─▶ TRACKING
 *               │  ▲          │
 *               ▼  └── found ─┼──┐
 *              LOST ◀─────────┘  │
 *               └──── search ────┘
 *
 * A scan is laid over the map by Gauss–Newton steps on the distances of its beams' ends from the nearest wall, which a
 * field holds for each cell. Ends that no wall explains, such as people, boxes and doors that moved, lose their weight.
 * The odometry's prediction takes part with its covariance: in a direction that the walls do not determine, such as
 * along a corridor, it stands, and the uncertainty grows.
 *
 * Where the map shows nothing within range and the beams see nothing, the scan agrees with the map, whatever stands
 * there besides: in the open the robot goes on by its wheels however uncertain it becomes, as no stand would tell where
 * it is, and is lost by that only where there are walls to find itself by, until it has searched where it may be.
 *
 * A robot that is lost searches the whole map, in slices: branch and bound over positions and headings, with the
 * distances as bounds. It stays lost while several places explain the scan alike, or none does. A robot that is not
 * lost but uncertain searches where it may be, for a place to lay the scan over. Where it finds several, or none, no
 * stand would tell either, and who is lost by nothing but its uncertainty goes on by its wheels. Beyond the uncertainty
 * that the configuration allows, a scan that fits where the wheels say may be laid over other walls that look alike:
 * the pose follows it, and is told as uncertain as before until a search finds one place alone.
 *
 * Memory: one block of the caller: a byte a cell of the map, a byte a row, and 1 440 B for a scan. Single-precision
 * floating point: part of libjoulepath_float. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_LOCALISER_H
#define JOULEPATH_LOCALISER_H

#include <joulepath/obstacles.h>
#include <joulepath/terrain.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Ends of beams that are laid over the map: every n-th where a scan has more. */
#define JP_LOCALISER_POINTS_MAX 180

/** Of them, those that a search uses. */
#define JP_LOCALISER_SEARCH_POINTS 60

/** Places that a search keeps: the best, and the best apart from it. */
#define JP_LOCALISER_PLACES 2

/** Wheels that tell of more than this since the last update, m and rad, are not believed: the pose stays. */
#define JP_LOCALISER_MOTION_MAX 0.5f

/** A correction by more than this, m and rad, is told of. */
#define JP_LOCALISER_NEW_PLACE 0.2f

/** Private: nodes that a search has not looked at. */
#define JP_LOCALISER_NODES 32

enum jp_localiser_state {
    JP_LOCALISER_TRACKING, /**< the last scan fits the map */
    JP_LOCALISER_DEGRADED, /**< it does not tell where the robot is: odometry does, and the uncertainty grows */
    JP_LOCALISER_LOST      /**< the pose is not known */
};

/** Why the state is not TRACKING. */
enum jp_localiser_reason {
    JP_LOCALISER_NONE,
    JP_LOCALISER_NO_SCAN,      /**< missing, or with too few beams that see something */
    JP_LOCALISER_UNEXPLAINED,  /**< the map explains too little of it: people or things around the robot */
    JP_LOCALISER_CONTRADICTED, /**< beams pass through walls: the robot was carried away, or the map is another */
    JP_LOCALISER_JUMPED,       /**< the scan fits the map, but away from where odometry allows */
    JP_LOCALISER_UNCERTAIN,    /**< not in the open, more uncertain than the configuration allows, and not searched */
    JP_LOCALISER_SEARCHING,    /**< the map is searched */
    JP_LOCALISER_AMBIGUOUS,    /**< several places explain the scan alike: it takes one from elsewhere */
    JP_LOCALISER_NOWHERE       /**< no place explains it */
};

/** How the wheels err, standard deviations. Such errors keep their sign: they grow with the way, not with its root. */
struct jp_localiser_drift {
    float distance;  /**< of the way, a share of it; 0.001…1 */
    float turn;      /**< of turns, a share of them; 0.001…1 */
    float deviation; /**< of the heading, rad after 1 m; 0.001…1 */
};

struct jp_localiser_config {
    const struct jp_terrain *map; /**< must outlive the localiser and not change */
    uint16_t beams_max;           /**< of a scan; 2…JP_SCAN_MATCH_BEAMS_MAX */
    float range_max;              /**< what is farther away is left out, m; above 0, at most 1 000 */
    float noise;                  /**< of ranges, standard deviation, m; 0.001…1 */
    struct jp_localiser_drift wheels;
    float start_distance; /**< standard deviation of the pose at the start, m; 0.001…10 */
    float start_turn;     /**< rad; 0.001…1 */
    float lost_distance;  /**< standard deviation beyond which it is lost, unless in the open, m; 0.01…10 */
    float lost_turn;      /**< of the heading, rad; 0.01…1 */
};

/** What is known in a cycle. */
struct jp_localiser_input {
    struct jp_plane_pose wheels; /**< integrated from the wheels, in any frame */
    struct jp_scan scan;         /**< ranges may be null: dropped out */
    struct jp_plane_pose sensor; /**< of the scanner on the robot */
};

struct jp_localiser_counts {
    uint32_t scans;
    uint32_t fits;     /**< scans that corrected the pose */
    uint32_t losses;   /**< times that it became lost */
    uint32_t searches; /**< of the map */
    uint32_t nodes;    /**< work of searches: a closer look at a place counts as 100 */
};

/** How the last scan agrees with the map at the pose, in numbers of its beams. */
struct jp_localiser_view {
    uint16_t beams;     /**< that were looked at */
    uint16_t explained; /**< end at the first wall on their way */
    uint16_t behind;    /**< pass through a wall and end at another: a door that the map shows closed is open */
    uint16_t beyond;    /**< pass through a wall and end where none is */
    uint16_t empty;     /**< beams that see nothing; looked at where the scan does not fit */
    uint16_t open;      /**< of these, beams on whose way the map shows no wall either */
};

/** Signed distances of the cells' middles from the nearest edge of a wall, below 0 inside. Private. */
struct jp_wall_field {
    int8_t *cells; /* in eighths of a cell */
    int32_t width;
    int32_t height;
    float cell; /* m */
};

/** Ends of beams in the robot's frame. Private. */
struct jp_localiser_cloud {
    struct jp_plane_point *points;
    int32_t count;
    int32_t stride; /* every so many-th end is one of them */
    struct jp_plane_point sensor;
};

/** Positions in a square and headings in a sector. Private. */
struct jp_localiser_node {
    int16_t x; /* of the south-west corner, in sides of the smallest squares */
    int16_t y;
    int16_t heading; /* in the smallest steps */
    int16_t level;
};

/** Private. */
struct jp_localiser_place {
    struct jp_plane_pose pose;
    float score;
};

/** Poses around one. Private. */
struct jp_localiser_region {
    struct jp_plane_pose centre;
    float distance; /* along x and y, m */
    float turn;     /* rad */
};

/** Private. */
struct jp_localiser_search {
    bool is_running;
    struct jp_localiser_region region;
    float least; /* score from which on places are looked for */
    struct jp_plane_point points[JP_LOCALISER_SEARCH_POINTS];
    float ranges[JP_LOCALISER_SEARCH_POINTS]; /* of the points from the robot */
    struct jp_localiser_cloud cloud;
    struct jp_localiser_node top; /* the next square of the first level */
    struct jp_localiser_node nodes[JP_LOCALISER_NODES];
    int32_t node_count;
    struct jp_localiser_place places[JP_LOCALISER_PLACES]; /* score 0: none */
};

/** Private. */
struct jp_localiser_internal {
    struct jp_wall_field field;
    struct jp_localiser_cloud cloud;
    struct jp_localiser_search search;
    struct jp_plane_pose wheels;
    bool has_wheels;
    bool has_jumped;            /* the wheels did, since the last scan that fitted */
    float reach;                /* root mean square of the ends' distances, m */
    uint8_t doubts;             /* scans in a row that contradict the map or the odometry */
    uint8_t unexplained;        /* scans of which next to nothing is on the map, since the last fit */
    bool is_near;               /* the next search of a lost robot is around where it was last */
    struct jp_plane_pose since; /* motion since the scan that is searched for */
    uint16_t waited;            /* scans since the last search */
    bool has_place;             /* it found one, which the next scan may confirm */
    bool has_drifted;           /* it is lost by nothing but its uncertainty */
    bool has_searched;          /* where it may be, since the last fit */
    float rival_distance;       /* how far off places are that look alike, standard deviation, m; 0: there are none */
    float rival_turn;           /* rad */
};

/** The members but `internal` may be read. */
struct jp_localiser {
    struct jp_localiser_config config;
    enum jp_localiser_state state;
    enum jp_localiser_reason reason;
    bool is_new_place;         /**< the last scan found the robot again, or farther away than JP_LOCALISER_NEW_PLACE */
    struct jp_plane_pose pose; /**< of the robot in the map's frame; while LOST as odometry goes on */
    float covariance[3][3];    /**< of x, y, m, and the heading, rad, about the place that it is taken to be at */
    float position_deviation;  /**< in the direction in which it is largest, and of places that look alike, m */
    float heading_deviation;   /**< likewise, rad */
    struct jp_localiser_view view;
    struct jp_localiser_counts counts;
    struct jp_localiser_internal internal;
};

/** Bytes of the block; 0 when the map is out of range. Constant time. */
size_t jp_localiser_size(const struct jp_localiser_config *config);

/** Checks the configuration, makes the field in `size` bytes of the caller and is LOST. JP_ERR_CONFIG: *field names the
 *  first field out of range. JP_ERR_MEMORY, JP_ERR_ALIGNMENT: the block. JP_ERR_ARGUMENT: a null pointer. Work: the
 *  cells of the map, each at most 30 times. */
enum jp_status jp_localiser_init(struct jp_localiser *localiser, const struct jp_localiser_config *config, void *block,
                                 size_t size, const char **field);

/** Begins anew at a pose of the robot on the map; null: it is not known, and the next scan is searched for.
 *  JP_ERR_ARGUMENT: a null localiser or a pose out of range; then nothing changes. Constant time. */
enum jp_status jp_localiser_start(struct jp_localiser *localiser, const struct jp_plane_pose *pose);

/** Takes the wheels' motion and a scan. JP_ERR_ARGUMENT: a null pointer or a value out of range; then nothing changes.
 *  Work: a short reading of the field, at most 45 times for each of JP_LOCALISER_POINTS_MAX ends of beams, as a rule 5
 *  times; where the scan does not fit, also the cells along the beams that see nothing. */
enum jp_status jp_localiser_update(struct jp_localiser *localiser, const struct jp_localiser_input *input);

/** Continues the search of a robot that is lost by the work of so many nodes, each of JP_LOCALISER_SEARCH_POINTS or
 * fewer readings of the field. A closer look, where a place may be, counts as 100 of them; the last one may go beyond.
 * True while there is more to do. */
bool jp_localiser_work(struct jp_localiser *localiser, unsigned nodes);

#ifdef __cplusplus
}
#endif

#endif
