/**
 * Route of least energy over a map: Anytime Dynamic A* (Likhachev et al., ICAPS 2005) in one fixed block of memory.
 *
 * The search runs on the states of a lattice (lattice.h), from the goal to the robot, so that its costs-to-go stay
 * valid while the robot drives. Two fields rooted at the robot are its heuristics: first the guide's estimate times ε
 * (guide_field.h), which finds good routes with few states; then, where the block has room for it, the bound of the
 * energy field (energy_field.h) and of turning, which proves the optimum. Where the states do not fit, the turn field
 * (turn_field.h) takes the place of some of them, and a search by the sum of both fields begins anew; in a smaller
 * block the fields take the states' place after the search, one after the other, and bound the cost of its route. After
 * changes of the map the search repairs what they touch; when a proved route is lost, a small second search by the
 * guide, the scout, joins what is left of it before the proof goes on. jp_planner_work() does it in slices. The same
 * input gives the same bits on every core.
 *
 * A route that is not proved is looked for once more in each smaller part of the block that is a power of two, divided
 * as a block of that size: so no block of a power of two gives a dearer route than a smaller one, where the schedule
 * ends with JP_EPSILON_ONE.
 *
 * When the states do not fit the block, ε goes up; when not even the greediest search fits, the planner searches from
 * the robot towards the goal and gives the route to the nearest state that it has found: a partial plan.
 *
 * A robot that drives has new starts: jp_planner_set_start(). Changes of the map go through jp_planner_set_cell(),
 * jp_planner_set_elevation(), jp_planner_set_cost() and jp_planner_set_class(). The map and the lattice must outlive
 * the planner. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_PLANNER_H
#define JOULEPATH_PLANNER_H

#include <joulepath/energy_field.h>
#include <joulepath/guide_field.h>
#include <joulepath/turn_field.h>

#ifdef __cplusplus
extern "C" {
#endif

/** ε in 1/256: JP_EPSILON(1.5) is 384. */
#define JP_EPSILON(x)     ((uint16_t)((x)*256.0 + 0.5))
#define JP_EPSILON_ONE    ((uint16_t)256)
#define JP_EPSILON_MAX    ((uint16_t)4096)
#define JP_EPSILON_LEVELS 4

/** In place of a bound: none is proved, or it is too large for its format. */
#define JP_BOUND_NONE ((uint16_t)0xFFFF)

/** Largest map, cells; width and height also obey JP_TERRAIN_SIDE_MAX. */
#define JP_PLANNER_CELLS_MAX ((uint32_t)1 << 24)

/** Changed cells that are repaired together. */
#define JP_PLANNER_CHANGES 64

/** Most states of a block; more memory than that is left unused. */
#define JP_PLANNER_STATES_MAX ((uint32_t)950000)

/** A goal cell and the set of allowed headings at it, a bit for each. */
struct jp_goal {
    int16_t x;
    int16_t y;
    uint16_t headings; /**< not 0 */
};

struct jp_planner_config {
    const struct jp_lattice *lattice; /**< that passed jp_lattice_check(); resolution equal to the map's */
    enum jp_cost_kind cost;
    /** Descending, each JP_EPSILON_ONE…JP_EPSILON_MAX; 0 ends the schedule early. Few, large steps are fastest. The
     *  search proves the optimum under JP_EPSILON_ONE if the block holds the energy field (the statistics say so) and
     *  the states of every ε. */
    uint16_t epsilon[JP_EPSILON_LEVELS];
};

enum jp_answer {
    JP_ANSWER_OUT_OF_BUDGET, /**< no route for this start, goal and map yet: call again; when the planner is
                                  idle, the block is too small */
    JP_ANSWER_OPTIMAL,       /**< no route of the lattice costs less */
    JP_ANSWER_WITHIN_BOUND,  /**< no route costs less than cost / bound, where a bound is proved */
    JP_ANSWER_PARTIAL,       /**< the route ends before the goal; about `cost_left` is left */
    JP_ANSWER_UNREACHABLE,   /**< there is no route: proved, not given up */
    JP_ANSWER_STALE          /**< the map was not changed through the planner: call jp_planner_restart() */
};

/** The last route that was found. It stays as it is until a better or newer one replaces it. */
struct jp_plan {
    enum jp_answer answer; /**< JP_ANSWER_OUT_OF_BUDGET: there is none yet */
    struct jp_lattice_pose start;
    struct jp_lattice_pose end;
    jp_cost cost;               /**< of the route, in the unit of the cost kind */
    jp_cost cost_left;          /**< estimate from its end to the goal; 0 unless partial */
    uint16_t bound;             /**< proved: cost ≤ bound/256 × optimum; JP_BOUND_NONE: nothing; 0 when partial */
    uint16_t step_count;        /**< primitives; 0 when start is goal, or a partial plan gets no nearer */
    uint32_t parameter_version; /**< of the lattice that it was found on: version of lattice.h */
};

/** What the block holds, or during a rehearsal that part of it, and what the search has done. */
struct jp_planner_counts {
    uint32_t states_max;   /**< states that fit, the scout's among them */
    uint32_t states;       /**< states in use */
    uint32_t expansions;   /**< since init */
    uint32_t restarts;     /**< searches begun anew since init */
    uint32_t guide_bytes;  /**< of the block, for the guide field */
    uint32_t field_bytes;  /**< of the block, for the energy field; 0: it does not fit */
    uint32_t search_bytes; /**< of the block, for states, their hash and queue */
};

/* Private, until jp_planner_size(). */

struct jp_planner_state;

/** Phase of the planner's work. */
enum jp_planner_phase {
    JP_PLANNER_EMPTY,        /**< idle, and there is no search */
    JP_PLANNER_GROW_GUIDE,   /**< for a new search */
    JP_PLANNER_GROW_FIELD,   /**< for a new search */
    JP_PLANNER_GROW_TURNS,   /**< the turn field, in the place of the states or of some of them */
    JP_PLANNER_CLEAR,        /**< forgets the states of the search before */
    JP_PLANNER_CHECK_PLAN,   /**< from here on there is a search; it waits for what the changes leave of the plan */
    JP_PLANNER_UPDATE_FIELD, /**< it waits for the energy field */
    JP_PLANNER_REPAIR,       /**< recomputes the states whose primitives sweep changed cells */
    JP_PLANNER_CUT,          /**< forgets all costs from the least on that a change has made wrong */
    JP_PLANNER_REKEY,        /**< computes all keys anew, for another ε or a wider range */
    JP_PLANNER_GROW_BOUND,   /**< the energy field, in the place of the states */
    JP_PLANNER_SEARCH,
    JP_PLANNER_TRACE,  /**< follows the route that the search has found */
    JP_PLANNER_SETTLED /**< idle, with a search that can be repaired */
};

/** What has the memory of the states, which cannot be repaired then. */
enum jp_planner_lent {
    JP_PLANNER_LENT_TO_NONE,
    JP_PLANNER_LENT_TO_TURNS,     /**< the turn field */
    JP_PLANNER_LENT_TO_FIELD,     /**< the energy field */
    JP_PLANNER_LENT_TO_REHEARSALS /**< searches in smaller parts of the block */
};

/** A search in a part of the block, divided as a block of that size would be. */
struct jp_planner_rehearsal {
    size_t size;    /**< of the part; 0: there is no rehearsal, or all are over */
    bool has_route; /**< it has found one */
};

/** Where the search begins. */
enum jp_planner_direction {
    JP_PLANNER_FROM_GOAL,
    JP_PLANNER_FROM_ROBOT /**< for a partial plan */
};

/** Cells of the map that have changed since the states were right. */
struct jp_planner_changes {
    struct jp_cell_change {
        int16_t x;
        int16_t y;
    } cells[JP_PLANNER_CHANGES];
    uint16_t count;
    bool may_be_cheaper; /**< one of them may make the map cheaper */
    uint32_t cursor;     /**< of the repair */
};

/** How far the plan has been checked on the present map. */
struct jp_planner_check {
    struct jp_lattice_pose pose;
    uint32_t step;
    uint32_t head_steps;              /**< before the first that is blocked */
    jp_cost head_cost;                /**< of these */
    struct jp_lattice_pose tail_pose; /**< from here on nothing blocks the steps that have been checked */
    uint32_t tail_step;
    jp_cost tail_cost;
};

/** The chain of best predecessors that is followed from the search's target to its seed. */
struct jp_planner_trace {
    enum jp_planner_trace_stage {
        JP_PLANNER_COUNT_STEPS, /**< from a forward search's end to the robot */
        JP_PLANNER_SKIP_STEPS,  /**< from that end, of those that the route's memory does not hold */
        JP_PLANNER_WRITE_STEPS
    } stage;
    struct jp_lattice_pose begin; /**< of this stage */
    struct jp_lattice_pose end;   /**< where it is */
    jp_cost cost;                 /**< between the two */
    uint32_t steps;
    uint32_t steps_max;
    uint32_t route_steps; /**< that a forward search's route has, and its memory holds */
    bool has_ended;       /**< the search */
};

/** Steps of the plan on either side of what is blocked that a splice may join. */
#define JP_PLANNER_SPLICE_STEPS ((uint32_t)32)

/** The head of the plan that the scout joins with its tail. */
struct jp_planner_head {
    uint32_t ids[JP_PLANNER_SPLICE_STEPS + 1U]; /**< states before the steps from first_step on, and
                                                           after the last */
    uint32_t start_id;
    uint32_t first_step;
    uint32_t steps;
    jp_cost cost;
    uint32_t junction_step; /**< the scout has found a way to the tail from the state before it */
};

/** Work, in expansions and what takes as long, by which the planner knows when beginning anew is cheaper. */
struct jp_planner_effort {
    uint32_t spent;       /**< since the search began, or since a change ended a route */
    uint32_t fresh_route; /**< from the last beginning to its first route; 0: changes came before */
    uint32_t fresh_end;   /**< to its end; 0: changes came before */
    jp_cost fresh_cost;   /**< of that route */
    bool has_begun;       /**< in this slice, a search or a repair: what the slice did before is not of it */
    bool has_cut;         /**< since the last change: what is left is part of a new search */
};

/** The cut of a search whose repair has become too dear. */
struct jp_planner_cut {
    uint32_t slot; /**< that it has come to */
    uint32_t lost; /**< costs that are forgotten, and needed again */
    jp_cost key;   /**< of the plan */
    bool is_found; /**< the least wrong cost; states are cut since */
    jp_cost least;
};

/** A search from one end of the route to the other: its states, their queue, and what steers it. */
struct jp_planner_search {
    struct jp_planner_state *states; /**< open-addressed hash table */
    uint32_t *buckets;               /**< heads of the queue's lists */
    uint32_t slot_count;             /**< prime */
    uint32_t bucket_count;
    uint32_t state_count;
    uint32_t state_count_max;
    uint32_t lowest_bucket;
    uint32_t rekey_slot; /**< slots from here on are not in the queue yet */
    uint32_t clear_slot; /**< slots from here on are yet to be cleared for a new search */
    jp_cost cut_cost;    /**< slots that are not in the queue yet may rest on costs from this one on, which are gone */
    jp_cost edge_max;    /**< no primitive that has been looked at costs more */
    uint32_t nearest;    /**< slot of the state with the least heuristic */
    jp_cost nearest_heuristic;
    enum jp_planner_direction direction;
    uint16_t epsilon;
    uint8_t level; /**< of the schedule of ε */
    uint8_t bucket_shift;
    bool is_exact;        /**< the energy field steers it, with ε = 1; else the guide does */
    bool is_of_one_level; /**< the table holds no states of an earlier ε */
    bool is_repaired;     /**< start or map have changed since it began */
};

struct jp_planner_internal {
    struct jp_planner_config config;
    struct jp_terrain *terrain;

    enum jp_planner_phase phase;
    struct jp_lattice_pose start;
    struct jp_goal goal;
    bool has_start;
    bool has_goal;
    enum jp_planner_lent lent;
    struct jp_planner_rehearsal rehearsal;
    bool is_field_rooted;              /**< the energy field has a root */
    bool are_fields_grown;             /**< and they have grown from it since: their bounds hold */
    bool has_turn_field;               /**< beside the energy field, in the place of part of the states */
    struct jp_lattice_pose field_root; /**< where the robot was when the fields got their roots */
    jp_cost turns_to_goal;             /**< least cost of turning from there, by a field that has made way since */
    uint16_t neighbours_max;           /**< that an expansion can add */
    struct jp_planner_search search;   /**< that is worked on */
    struct jp_planner_search resting;  /**< the scout: a small one by the guide, that finds a route while the exact one
                                          is repaired; while it searches, the exact one. No states: there is none */
    bool is_scouting;
    bool is_splicing;  /**< the scout joins what the last check has left of the plan */
    bool has_guide;    /**< the guide has grown for this goal, from where the robot was then */
    bool is_guide_old; /**< it had grown before the present search began */

    uint32_t terrain_version;
    uint8_t *block;        /**< all of it */
    size_t block_size;     /**< of it */
    uint8_t *states_block; /**< of the search */
    size_t states_bytes;   /**< of it */
    uint8_t *route;        /**< of the plan: index of each primitive among those of its heading */
    uint8_t *spare_route;  /**< the next plan is written here, so that the last one stays whole */
    uint16_t route_max;
    enum jp_answer answer;
    struct jp_plan plan;
    jp_cost least; /**< no route of this start, goal and map costs less */
    struct jp_planner_counts statistics;
    struct jp_planner_changes changes;
    struct jp_planner_check check;
    struct jp_planner_head head;
    struct jp_planner_trace trace;
    struct jp_planner_effort effort;
    struct jp_planner_cut cut;
    struct jp_turns turns;
    struct jp_straight straight;
    struct jp_guide_field guide;
    struct jp_energy_field field;
    struct jp_turn_field turn_field;
};

struct jp_planner {
    struct jp_planner_internal internal;
};

/** Bytes of the smallest block for a map, with room for 64 states; 0 when the map is too large. Constant time. */
size_t jp_planner_size(const struct jp_terrain_config *config);

/**
 * Prepares a planner in `size` bytes of the caller. The statistics say how many states fit.
 * JP_ERR_CONFIG: *field names the first field out of range. JP_ERR_MEMORY: `size` is below jp_planner_size().
 * JP_ERR_ALIGNMENT: `block` is not aligned to 8 bytes. JP_ERR_ARGUMENT: a pointer is null. Work: the tables of the
 * lattice.
 */
enum jp_status jp_planner_init(struct jp_planner *planner, const struct jp_planner_config *config,
                               struct jp_terrain *terrain, void *block, size_t size, const char **field);

/**
 * Takes other costs of the same lattice (tariff.h) and begins anew; the plan stands until there is a new one, and says
 * the version of its own. The lattice before may then be overwritten. JP_ERR_ARGUMENT: a pointer is null;
 * JP_ERR_CONFIG: it is made of another lattice. Work: as jp_planner_restart(), and jp_lattice_turns().
 */
enum jp_status jp_planner_set_lattice(struct jp_planner *planner, const struct jp_lattice *lattice);

/** Sets the robot's pose. On the plan's route the plan begins there from now on, with what is proved of it; elsewhere
 * the search continues with its costs. JP_ERR_OUTSIDE, JP_ERR_BLOCKED: the pose is off the map, or the footprint does
 * not fit; JP_ERR_ARGUMENT: no such heading, or a null pointer. The old start stays then. Work: the plan's steps;
 * within a cut, two looks at every slot of the table; if the search must begin anew, as jp_planner_restart(). */
enum jp_status jp_planner_set_start(struct jp_planner *planner, const struct jp_lattice_pose *start);

/** Sets the goal. The search begins anew. JP_ERR_OUTSIDE: off the map. JP_ERR_BLOCKED: the footprint fits at no
 * heading; JP_ERR_ARGUMENT: no heading, or a null pointer. The old goal stays then. Constant time.
 */
enum jp_status jp_planner_set_goal(struct jp_planner *planner, const struct jp_goal *goal);

/** Changes a cell of the map and notes it for repair. A plan whose route is not touched stays, after a look at its
 *  steps. As jp_terrain_set_cell(). Work: constant, but for every
 *  JP_PLANNER_CHANGES-th or far-off one, which repairs those before it, and for one within a cut, which is ended: two
 *  looks at every slot of the table. */
enum jp_status jp_planner_set_cell(struct jp_planner *planner, int32_t x, int32_t y, enum jp_cell cell);

/** The same for an elevation. As jp_terrain_set_elevation(). */
enum jp_status jp_planner_set_elevation(struct jp_planner *planner, int32_t x, int32_t y, jp_elevation elevation);

/** The same for the cost of a cell. As jp_terrain_set_cost(). */
enum jp_status jp_planner_set_cost(struct jp_planner *planner, int32_t x, int32_t y, uint8_t cost);

/** The same for the class of a cell's ground. As jp_terrain_set_class(). */
enum jp_status jp_planner_set_class(struct jp_planner *planner, int32_t x, int32_t y, uint8_t ground);

/** Forgets the search, not the plan, and begins anew with the map as it is. Work: the fields are cleared; the states
 *  are, in one of the slices of work that follow. */
void jp_planner_restart(struct jp_planner *planner);

/**
 * Continues the search for at most `expansions` expansions (or as much other work) and returns what is known now.
 * JP_ANSWER_OUT_OF_BUDGET also without a start or a goal. A better answer may follow until jp_planner_is_idle().
 */
enum jp_answer jp_planner_work(struct jp_planner *planner, unsigned expansions);

/** True when more work cannot improve the answer. Constant time. */
bool jp_planner_is_idle(const struct jp_planner *planner);

/** The last route, also during a search; it may be of an older start, goal or map. Never null. Constant time. */
const struct jp_plan *jp_planner_plan(const struct jp_planner *planner);

/** Primitive of step `index` of the plan; null when there is no such step. `*pose` is moved from its start to its end:
 *  begin with plan->start and index 0. Constant time. */
const struct jp_primitive *jp_planner_step(const struct jp_planner *planner, unsigned index,
                                           struct jp_lattice_pose *pose);

/** What it plans on and by: the map, and the lattice that it was given last. Never null. Constant time. */
const struct jp_terrain *jp_planner_terrain(const struct jp_planner *planner);
const struct jp_lattice *jp_planner_lattice(const struct jp_planner *planner);

/** Division of the block and work of the search. Never null. Constant time. */
const struct jp_planner_counts *jp_planner_statistics(const struct jp_planner *planner);

/** For pictures of the search: a state that it holds, with `*is_open` when it waits for its expansion. Begin with *slot
 * 0; false: there is no more, or the block holds no search now. Work: a look at each slot of the table up to the state.
 */
bool jp_planner_next_state(const struct jp_planner *planner, uint32_t *slot, struct jp_lattice_pose *pose,
                           bool *is_open);

#ifdef __cplusplus
}
#endif

#endif
