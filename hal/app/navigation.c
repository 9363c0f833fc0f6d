#include "hal/app/navigation.h"

#include <joulepath/count.h>
#include <joulepath/meter.h>
#include <stddef.h>
#include <string.h>

#include "hal/can/jp_can.h"

/* Fraction bits that a signal leaves out. */
#define LENGTH_SHIFT   10U /* Q16 to Q6 */
#define DURATION_SHIFT 12U /* Q16 to Q4 */
#define ENERGY_SHIFT   13U /* Q16 to Q3 */
#define POINT_SHIFT    9U  /* Q16 to Q7 */

/** Of the signal, which wraps. */
#define FORGETS_MASK 15U

#define WAY_SHIFT  29U /* Q32 to Q3 */
#define LEFT_SHIFT 28U /* Q32 to Q4 */

#define DEVIATION_MAX ((1 << 14) - 1)
#define WAY_MAX       ((1 << 20) - 1)

bool jp_navigation_is_under_way(const struct jp_navigation *navigation)
{
    return navigation->is_prepared && navigation->finder.is_under_way(navigation->finder.self);
}

static const struct jp_terrain *map_of(const struct jp_navigation *navigation)
{
    return &navigation->maps.decoder.terrain;
}

/* The way home. */

static struct jp_home *home_of(const struct jp_navigation *navigation)
{
    return navigation->home_status == JP_OK ? navigation->config.home->home : NULL;
}

/** To where the robot was switched on, with what drives on other maps have taught. Without it the robot drives all the
 *  same. */
static enum jp_status prepare_home(struct jp_navigation *navigation, const struct jp_terrain *map,
                                   const struct jp_place *origin)
{
    const struct jp_navigation_home *home = navigation->config.home;
    const jp_q16 cell = map->config.resolution;
    const char *field;

    if (home == NULL) {
        return JP_ERR_MEMORY;
    }
    const struct jp_home_config config = {.navigator = &navigation->navigator,
                                          .x = (int16_t)(origin->point.x / cell),
                                          .y = (int16_t)(origin->point.y / cell),
                                          .confidence = home->turns_back ? home->confidence : 0,
                                          .left = jp_ecu_battery_left,
                                          .given = jp_ecu_battery_given,
                                          .context = home->battery,
                                          .legs = home->legs,
                                          .legs_max = home->legs_max,
                                          .slice = JP_NAVIGATION_HOME_SLICE,
                                          .block = home->block,
                                          .size = home->size};
    const struct jp_home_learned learned = home->home->learned;
    const enum jp_status status = jp_home_init(home->home, &config, &field);

    home->home->learned = learned;
    return status;
}

/* The navigator on a lattice finds the way. */

static enum jp_status prepare_navigator(void *self, struct jp_terrain *map, const struct jp_place *origin)
{
    struct jp_navigation *navigation = self;
    const struct jp_navigation_config *config = &navigation->config;
    const struct jp_planner_config planner = {
        .lattice = config->lattice, .cost = JP_COST_PHYSICAL, .epsilon = JP_NAVIGATION_EPSILON};
    const struct jp_navigator_config navigator = {.planner = &navigation->planner,
                                                  .vehicle = &navigation->vehicle,
                                                  .radius = config->body->radius,
                                                  .margin = config->body->margin,
                                                  .legs = config->legs,
                                                  .legs_max = config->legs_max,
                                                  .slice = JP_NAVIGATION_SLICE,
                                                  .patience = JP_NAVIGATION_PATIENCE,
                                                  .way_block = config->way,
                                                  .way_size = config->way_size,
                                                  .seen = config->seen,
                                                  .seen_size = config->seen_size};
    const struct jp_stand_energy stand = navigation->navigator.stand;
    const bool has_room = jp_navigator_way_size(&map->config) <= config->way_size &&
                          jp_navigator_seen_size(&map->config) <= config->seen_size;
    const char *field;
    enum jp_status status = has_room ? JP_OK : JP_ERR_MEMORY;

    if (status == JP_OK) {
        status = jp_planner_init(&navigation->planner, &planner, map, config->planner, config->planner_size, &field);
    }
    if (status == JP_OK) {
        status = jp_navigator_init(&navigation->navigator, &navigator, origin, &field);
    }
    if (status == JP_OK) {
        navigation->navigator.stand = stand;
        navigation->home_status = prepare_home(navigation, map, origin);
    }
    return status;
}

static void forget_navigator(void *self)
{
    struct jp_navigation *navigation = self;

    navigation->navigator = (struct jp_navigator){.state = JP_NAVIGATOR_IDLE, .stand = navigation->navigator.stand};
    navigation->home_status = JP_ERR_STATE;
}

/** It looks for its way home before it leaves. */
static bool is_preparing(const struct jp_navigation *navigation)
{
    const struct jp_home *home = home_of(navigation);

    return home != NULL && home->state == JP_HOME_PREPARING;
}

static bool is_navigator_under_way(const void *self)
{
    const struct jp_navigation *navigation = self;
    const enum jp_navigator_state state = navigation->navigator.state;

    return is_preparing(navigation) || (state != JP_NAVIGATOR_IDLE && state < JP_NAVIGATOR_ARRIVED);
}

static void let_navigator_see(void *self, int32_t x, int32_t y, enum jp_cell cell)
{
    struct jp_navigation *navigation = self;

    /* What is off the map is of no account. */
    (void)jp_navigator_set_cell(&navigation->navigator, x, y, cell);
}

/** Of the lattice's headings, that nearest to one, or all. */
static uint16_t headings_of(const struct jp_navigation *navigation, const struct jp_map_goal *goal)
{
    uint32_t least = UINT32_MAX;
    uint16_t nearest = JP_ANY_HEADING;

    for (unsigned i = 0; i < JP_HEADINGS && goal->has_heading; i++) {
        const int32_t off = (int32_t)(navigation->config.lattice->heading[i] - goal->heading);
        const uint32_t magnitude = off < 0 ? 0U - (uint32_t)off : (uint32_t)off;

        if (magnitude < least) {
            least = magnitude;
            nearest = (uint16_t)(1U << i);
        }
    }
    return nearest;
}

static bool can_stand_there(const void *self, const struct jp_map_goal *goal)
{
    const struct jp_navigation *navigation = self;
    const uint16_t headings = headings_of(navigation, goal);

    for (unsigned i = 0; i < JP_HEADINGS; i++) {
        if ((((uint32_t)headings >> i) & 1U) != 0U &&
            jp_lattice_can_stand(navigation->config.lattice, map_of(navigation), goal->x, goal->y, (uint8_t)i)) {
            return true;
        }
    }
    return false;
}

static bool turns_back(const struct jp_navigation *navigation)
{
    return home_of(navigation) != NULL && navigation->config.home->turns_back;
}

static enum jp_status send_navigator(void *self, const struct jp_map_goal *goal)
{
    struct jp_navigation *navigation = self;
    const struct jp_goal place = {
        .x = (int16_t)goal->x, .y = (int16_t)goal->y, .headings = headings_of(navigation, goal)};

    if (!turns_back(navigation)) {
        return jp_navigator_go(&navigation->navigator, &place);
    }
    return can_stand_there(self, goal) ? jp_home_go(home_of(navigation), &place) : JP_ERR_BLOCKED;
}

static void stop_navigator(void *self)
{
    struct jp_navigation *navigation = self;

    if (home_of(navigation) == NULL) {
        jp_navigator_stop(&navigation->navigator);
    } else {
        jp_home_stop(home_of(navigation));
    }
}

static enum jp_navigator_state work_on(struct jp_navigation *navigation)
{
    struct jp_home *home = home_of(navigation);

    if (home == NULL) {
        return jp_navigator_work(&navigation->navigator);
    }
    const bool was_preparing = home->state == JP_HOME_PREPARING;
    const enum jp_home_state state = jp_home_work(home);

    if (home->has_turned_back || (was_preparing && state == JP_HOME_FAILED)) {
        navigation->answer = JP_GOAL_HOME;
    }
    return navigation->navigator.state;
}

static bool work_of_navigator(void *self)
{
    struct jp_navigation *navigation = self;
    const enum jp_navigator_state before = navigation->navigator.state;

    return work_on(navigation) == JP_NAVIGATOR_TURNING && before == JP_NAVIGATOR_JOINING;
}

static void tell_of_navigator(const void *self, struct jp_way_report *report)
{
    const struct jp_navigation *navigation = self;
    const struct jp_navigator *navigator = &navigation->navigator;

    *report = (struct jp_way_report){.state = is_preparing(navigation) ? JP_NAVIGATOR_PLANNING : navigator->state,
                                     .reason = navigator->reason,
                                     .status = navigator->status,
                                     .replans = navigator->replans,
                                     .forgets = navigator->forgets};
    report->legs = jp_navigator_legs(navigator, &report->leg_count);
    (void)jp_navigator_progress(navigator, &report->progress);
}

/* Start. */

static const char *missing(const struct jp_navigation_config *config)
{
    if (config->lattice == NULL) {
        return "lattice";
    }
    if (config->body == NULL) {
        return "body";
    }
    if (config->map == NULL) {
        return "map";
    }
    if (config->planner == NULL) {
        return "planner";
    }
    if (config->way == NULL) {
        return "way";
    }
    if (config->seen == NULL) {
        return "seen";
    }
    return config->legs == NULL || config->legs_max == 0U ? "legs" : NULL;
}

static void start(struct jp_navigation *navigation, const struct jp_wayfinder *finder, const struct jp_map_room *room)
{
    (void)memset(navigation, 0, sizeof *navigation);
    navigation->finder = *finder;
    navigation->home_status = JP_ERR_STATE;
    jp_map_link_start(&navigation->maps, room);
}

enum jp_status jp_navigation_init(struct jp_navigation *navigation, const struct jp_navigation_config *config,
                                  const struct jp_vehicle *vehicle, int32_t unit_exponent, const char **field)
{
    if (navigation == NULL || config == NULL || vehicle == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *field = missing(config);
    if (*field != NULL) {
        return JP_ERR_CONFIG;
    }
    const struct jp_map_room room = {
        .block = config->map, .size = config->map_size, .resolution = config->lattice->resolution};

    const struct jp_wayfinder finder = {.self = navigation,
                                        .prepare = prepare_navigator,
                                        .forget = forget_navigator,
                                        .is_under_way = is_navigator_under_way,
                                        .see = let_navigator_see,
                                        .can_stand = can_stand_there,
                                        .go = send_navigator,
                                        .stop = stop_navigator,
                                        .work = work_of_navigator,
                                        .tell = tell_of_navigator};

    start(navigation, &finder, &room);
    navigation->config = *config;
    navigation->vehicle = *vehicle;
    navigation->unit_exponent = unit_exponent;
    if (config->home != NULL) {
        config->home->home->learned = jp_home_learned_new;
    }
    return JP_OK;
}

enum jp_status jp_navigation_init_with(struct jp_navigation *navigation, const struct jp_wayfinder *finder,
                                       const struct jp_map_room *room)
{
    if (navigation == NULL || finder == NULL || room == NULL) {
        return JP_ERR_ARGUMENT;
    }
    start(navigation, finder, room);
    return JP_OK;
}

/* The map. */

/** The goal was on the map that has gone. */
static void forget_map(struct jp_navigation *navigation)
{
    navigation->is_prepared = false;
    navigation->finder.forget(navigation->finder.self);
    navigation->goal = (struct jp_map_goal){.id = 0};
    navigation->is_round = false;
    navigation->answer = JP_GOAL_NONE;
}

/** As the link has it. */
static void follow_map(struct jp_navigation *navigation)
{
    const bool is_ready = navigation->maps.state == JP_MAP_LINK_READY;

    if (!is_ready && navigation->is_prepared) {
        forget_map(navigation);
    } else if (is_ready && !navigation->is_prepared) {
        struct jp_map_decoder *map = &navigation->maps.decoder;

        navigation->is_prepared =
            navigation->finder.prepare(navigation->finder.self, &map->terrain, &map->origin) == JP_OK;
        if (!navigation->is_prepared) {
            jp_map_link_reject(&navigation->maps, JP_MAP_REASON_TOO_LARGE);
        }
    } else {
        /* Nothing has changed. */
    }
}

/* Frames that arrive. */

static enum jp_e2e_result accept_offer(struct jp_navigation *navigation, const struct jp_can_frame *frame)
{
    const enum jp_e2e_result result =
        jp_map_link_accept_offer(&navigation->maps, frame, !jp_navigation_is_under_way(navigation));

    follow_map(navigation);
    return result;
}

static void change(struct jp_navigation *navigation, const struct jp_cell_changes *changes)
{
    for (unsigned i = 0; i < JP_CELL_CHANGES; i++) {
        const unsigned cell = (changes->cells >> (2U * i)) & JP_CELL_UNCHANGED;
        const int32_t x = (int32_t)(changes->x + i);

        if (cell != JP_CELL_UNCHANGED && jp_terrain_cell(map_of(navigation), x, changes->y) != (enum jp_cell)cell) {
            navigation->finder.see(navigation->finder.self, x, changes->y, (enum jp_cell)cell);
        }
    }
}

static enum jp_e2e_result accept_cells(struct jp_navigation *navigation, const struct jp_can_frame *frame)
{
    struct jp_cell_changes changes;
    const enum jp_e2e_result result = jp_map_link_accept_cells(&navigation->maps, frame, &changes);

    if (result != JP_E2E_CRC && navigation->is_prepared && changes.map == navigation->maps.id) {
        change(navigation, &changes);
    }
    return result;
}

static enum jp_goal_answer answer_to_goal(const struct jp_navigation *navigation)
{
    const struct jp_map_goal *goal = &navigation->goal;

    if (!navigation->is_prepared) {
        return JP_GOAL_NO_MAP;
    }
    if (goal->map != navigation->maps.id) {
        return JP_GOAL_OTHER_MAP;
    }
    if (!jp_terrain_contains(map_of(navigation), goal->x, goal->y)) {
        return JP_GOAL_OUTSIDE;
    }
    return navigation->finder.can_stand(navigation->finder.self, goal) ? JP_GOAL_TAKEN : JP_GOAL_BLOCKED;
}

static void drop_round(struct jp_navigation *navigation)
{
    navigation->is_round = false;
    if (jp_navigation_goes_round(navigation)) {
        navigation->finder.rounds->drop(navigation->finder.self);
    }
}

static enum jp_e2e_result accept_goal(struct jp_navigation *navigation, const struct jp_can_frame *frame)
{
    struct jp_map_goal goal;
    const enum jp_e2e_result result = jp_map_link_accept_goal(&navigation->maps, frame, &goal);
    const bool was_taken = navigation->answer == JP_GOAL_TAKEN || navigation->answer == JP_GOAL_DRIVEN;

    if (result == JP_E2E_OK && goal.id != 0U && !(was_taken && goal.id == navigation->goal.id)) {
        drop_round(navigation);
        navigation->goal = goal;
        navigation->answer = answer_to_goal(navigation);
    }
    return result;
}

bool jp_navigation_goes_round(const struct jp_navigation *navigation)
{
    return navigation->finder.rounds != NULL;
}

/** A round that is ready takes the goal's place. */
static enum jp_e2e_result accept_of_round(struct jp_navigation *navigation, const struct jp_can_frame *frame)
{
    const struct jp_wayfinder *finder = &navigation->finder;
    const uint8_t map = navigation->is_prepared ? navigation->maps.id : 0U;
    const enum jp_e2e_result result = finder->rounds->accept(finder->self, frame, map);
    const uint8_t ready = finder->rounds->ready(finder->self);

    if (ready != 0U && !(navigation->is_round && navigation->goal.id == ready)) {
        navigation->goal = (struct jp_map_goal){.map = map, .id = ready};
        navigation->is_round = true;
        navigation->answer = JP_GOAL_TAKEN;
    }
    return result;
}

enum jp_e2e_result jp_navigation_accept(struct jp_navigation *navigation, const struct jp_can_frame *frame)
{
    switch (frame->id) {
    case JP_CAN_MAP_OFFER_FRAME_ID:
        return accept_offer(navigation, frame);
    case JP_CAN_MAP_DATA_FRAME_ID:
        return jp_map_link_accept_data(&navigation->maps, frame);
    case JP_CAN_CELL_CHANGES_FRAME_ID:
        return accept_cells(navigation, frame);
    case JP_CAN_MAP_GOAL_FRAME_ID:
        return accept_goal(navigation, frame);
    default:
        return accept_of_round(navigation, frame);
    }
}

/* Commands. */

bool jp_navigation_drive(struct jp_navigation *navigation, uint8_t goal)
{
    if (navigation->answer != JP_GOAL_TAKEN || goal != navigation->goal.id) {
        return false;
    }
    const struct jp_wayfinder *finder = &navigation->finder;
    const enum jp_status status =
        navigation->is_round ? finder->rounds->begin(finder->self) : finder->go(finder->self, &navigation->goal);

    if (status == JP_OK) {
        navigation->answer = JP_GOAL_DRIVEN;
    } else if (status != JP_ERR_STATE) {
        navigation->answer = JP_GOAL_BLOCKED;
    } else {
        /* Its motors are about to be on. */
    }
    return status == JP_OK;
}

void jp_navigation_stop(struct jp_navigation *navigation)
{
    if (jp_navigation_is_under_way(navigation)) {
        navigation->finder.stop(navigation->finder.self);
    }
}

/* The report. */

static void begin(struct jp_can_frame *frame, uint32_t id)
{
    *frame = (struct jp_can_frame){.id = id, .length = JP_CAN_LENGTH_MAX};
}

static uint32_t signal_of(int32_t value, unsigned shift, int32_t high)
{
    return (uint32_t)jp_clamp32(jp_round_shift(value, shift), 0, high);
}

static void tell_map(const struct jp_navigation *navigation, struct jp_can_frame *frame)
{
    const struct jp_map_link *maps = &navigation->maps;
    const struct jp_can_map_status_t signals = {.map_id = maps->id,
                                                .state = (uint8_t)maps->state,
                                                .reason = (uint8_t)maps->reason,
                                                .cell_counter = maps->cell_counter,
                                                .received = maps->frames,
                                                .map_crc = maps->crc};

    begin(frame, JP_CAN_MAP_STATUS_FRAME_ID);
    (void)jp_can_map_status_pack(frame->data, &signals, sizeof frame->data);
}

static uint8_t count8(uint32_t value)
{
    return (uint8_t)(value > UINT8_MAX ? UINT8_MAX : value);
}

static void tell_state(const struct jp_navigation *navigation, const struct jp_way_report *way,
                       struct jp_can_frame *frame)
{
    const struct jp_can_navigation_status_t signals = {.goal_id = navigation->goal.id,
                                                       .state = (uint8_t)way->state,
                                                       .reason = (uint8_t)way->reason,
                                                       .answer = (uint8_t)navigation->answer,
                                                       .has_course = way->leg_count > 0U,
                                                       .forgets = way->forgets & FORGETS_MASK,
                                                       .vehicle_status = (int8_t)way->status,
                                                       .replans = count8(way->replans),
                                                       .course = navigation->course,
                                                       .legs_left = count8(way->leg_count)};

    begin(frame, JP_CAN_NAVIGATION_STATUS_FRAME_ID);
    (void)jp_can_navigation_status_pack(frame->data, &signals, sizeof frame->data);
}

/** In J, of a value in the vehicle's unit. */
static jp_q16 joules(const struct jp_navigation *navigation, jp_q16 energy)
{
    return jp_energy_to_q16(jp_energy_from_q16(energy, navigation->unit_exponent), 0);
}

static void tell_progress(const struct jp_navigation *navigation, const struct jp_progress *progress,
                          struct jp_can_frame *frame)
{
    const struct jp_can_navigation_progress_t signals = {
        .distance = (uint16_t)signal_of(progress->length, LENGTH_SHIFT, UINT16_MAX),
        .duration = (uint16_t)signal_of(progress->duration, DURATION_SHIFT, UINT16_MAX),
        .energy = signal_of(joules(navigation, progress->energy.energy), ENERGY_SHIFT, INT32_MAX),
        .deviation = (uint16_t)signal_of(joules(navigation, progress->energy.deviation), ENERGY_SHIFT, DEVIATION_MAX)};

    begin(frame, JP_CAN_NAVIGATION_PROGRESS_FRAME_ID);
    (void)jp_can_navigation_progress_pack(frame->data, &signals, sizeof frame->data);
}

static void tell_leg(const struct jp_navigation *navigation, const struct jp_course_leg *leg,
                     struct jp_can_frame *frame)
{
    const struct jp_can_course_leg_t signals = {.course = navigation->course,
                                                .after = navigation->leg_told,
                                                .is_stop = leg->is_stop ? 1U : 0U,
                                                .x = (uint16_t)signal_of(leg->end.x, POINT_SHIFT, UINT16_MAX),
                                                .y = (uint16_t)signal_of(leg->end.y, POINT_SHIFT, UINT16_MAX)};

    begin(frame, JP_CAN_COURSE_LEG_FRAME_ID);
    (void)jp_can_course_leg_pack(frame->data, &signals, sizeof frame->data);
}

/** From the leg that is driven to the last, and again. */
static uint8_t tell_legs(struct jp_navigation *navigation, const struct jp_course_leg *legs, uint8_t count,
                         struct jp_can_frame *frames)
{
    uint8_t told = 0;

    while (told < JP_NAVIGATION_REPORT_LEGS && told < count) {
        const bool begins = navigation->leg_told == 0U || navigation->leg_told > count;

        navigation->leg_told = (uint8_t)((begins ? count : navigation->leg_told) - 1U);
        tell_leg(navigation, &legs[count - 1U - navigation->leg_told], &frames[told]);
        told++;
    }
    return told;
}

static enum jp_home_told told_of_probability(const struct jp_navigation *navigation, jp_q31 probability)
{
    return probability >= navigation->config.home->confidence ? JP_HOME_TOLD_SUFFICES : JP_HOME_TOLD_TOO_LITTLE;
}

/** *answer is 0 where it is not known. */
static enum jp_home_told ask_home(const struct jp_navigation *navigation, struct jp_home_answer *answer)
{
    const struct jp_home *home = home_of(navigation);
    struct jp_home_answer found = {.probability = 0};
    const enum jp_status status = jp_home_ask(home, &found);

    if (status == JP_OK) {
        *answer = found;
    }
    if (home->state == JP_HOME_RETURNING) {
        return JP_HOME_TOLD_TURNING_BACK;
    }
    if (jp_home_is_cut_off(home)) {
        return JP_HOME_TOLD_NO_WAY;
    }
    if (status == JP_ERR_NO_PLAN) {
        return JP_HOME_TOLD_SEEKING;
    }
    return status == JP_OK ? told_of_probability(navigation, found.probability) : JP_HOME_TOLD_UNPOWERED;
}

static enum jp_home_told look_home(const struct jp_navigation *navigation, struct jp_home_answer *answer)
{
    switch (navigation->home_status) {
    case JP_OK:
        return ask_home(navigation, answer);
    case JP_ERR_MEMORY:
        return JP_HOME_TOLD_NO_ROOM;
    case JP_ERR_BLOCKED:
        return JP_HOME_TOLD_CLOSED;
    default:
        return JP_HOME_TOLD_NONE;
    }
}

static uint32_t way_signal(const struct jp_navigation *navigation, jp_q16 energy)
{
    const int64_t way = jp_energy_from_q16(energy, navigation->unit_exponent) >> WAY_SHIFT;

    return (uint32_t)(way < WAY_MAX ? way : WAY_MAX);
}

static void tell_home(const struct jp_navigation *navigation, struct jp_can_frame *frame)
{
    struct jp_home_answer answer = {.probability = 0};
    const enum jp_home_told told = look_home(navigation, &answer);
    const struct jp_can_home_status_t signals = {.home_state = (uint8_t)told,
                                                 .probability = (uint16_t)((uint32_t)answer.probability >> 15U),
                                                 .way = way_signal(navigation, answer.way.energy),
                                                 .way_deviation = way_signal(navigation, answer.way.deviation)};

    begin(frame, JP_CAN_HOME_STATUS_FRAME_ID);
    (void)jp_can_home_status_pack(frame->data, &signals, sizeof frame->data);
}

static void tell_battery(const struct jp_navigation *navigation, struct jp_can_frame *frame)
{
    jp_energy left = 0;
    jp_energy deviation = 0;

    if (navigation->config.home != NULL) {
        jp_ecu_battery_tell(navigation->config.home->battery, &left, &deviation);
    }
    const struct jp_can_home_battery_t signals = {.left = (uint32_t)(left >> LEFT_SHIFT),
                                                  .left_deviation = (uint32_t)(deviation >> LEFT_SHIFT)};

    begin(frame, JP_CAN_HOME_BATTERY_FRAME_ID);
    (void)jp_can_home_battery_pack(frame->data, &signals, sizeof frame->data);
}

/** Frames told. */
static uint8_t tell_round(const struct jp_navigation *navigation, struct jp_can_frame *frames)
{
    const struct jp_wayfinder *finder = &navigation->finder;

    if (!jp_navigation_goes_round(navigation)) {
        return 0;
    }
    begin(&frames[0], JP_CAN_ROUND_STATUS_FRAME_ID);
    begin(&frames[1], JP_CAN_ROUND_BATTERY_FRAME_ID);
    finder->rounds->tell(finder->self, frames);
    return JP_NAVIGATION_ROUND_FRAMES;
}

static void report(struct jp_navigation *navigation)
{
    struct jp_way_report way = {.state = JP_NAVIGATOR_IDLE};

    if (navigation->is_prepared) {
        navigation->finder.tell(navigation->finder.self, &way);
    }
    const uint8_t told_of_round = tell_round(navigation, navigation->frames);
    const uint8_t told =
        told_of_round + tell_legs(navigation, way.legs, count8(way.leg_count), &navigation->frames[told_of_round]);

    tell_progress(navigation, &way.progress, &navigation->frames[told]);
    tell_state(navigation, &way, &navigation->frames[told + 1U]);
    tell_map(navigation, &navigation->frames[told + 2U]);
    navigation->told_home = !navigation->told_home;
    if (navigation->told_home) {
        tell_home(navigation, &navigation->frames[told + 3U]);
    } else {
        tell_battery(navigation, &navigation->frames[told + 3U]);
    }
    __atomic_store_n(&navigation->frames_left, (uint8_t)(told + 4U), __ATOMIC_RELEASE);
}

bool jp_navigation_take_frame(struct jp_navigation *navigation, struct jp_can_frame *frame)
{
    const uint8_t left = __atomic_load_n(&navigation->frames_left, __ATOMIC_ACQUIRE);

    if (left == 0U) {
        return false;
    }
    *frame = navigation->frames[left - 1U];
    __atomic_store_n(&navigation->frames_left, (uint8_t)(left - 1U), __ATOMIC_RELEASE);
    return true;
}

/* The work. */

static void navigate(struct jp_navigation *navigation)
{
    if (navigation->finder.work(navigation->finder.self)) {
        navigation->course++;
        navigation->leg_told = 0;
    }
}

bool jp_navigation_work(struct jp_navigation *navigation, uint32_t tick, uint32_t tick_rate)
{
    jp_map_link_work(&navigation->maps);
    follow_map(navigation);
    if (navigation->is_prepared) {
        navigate(navigation);
    }
    if (tick - navigation->told_tick >= tick_rate * JP_NAVIGATION_REPORT_MS / 1000U &&
        __atomic_load_n(&navigation->frames_left, __ATOMIC_ACQUIRE) == 0U) {
        navigation->told_tick = tick;
        report(navigation);
    }
    return navigation->is_prepared;
}
