#include "hal/app/ecu_patrol_round.h"

#include <joulepath/meter.h>
#include <string.h>

#include "hal/app/float_signals.h"
#include "hal/app/signals.h"
#include "hal/can/jp_can.h"
#include "hal/can/round_code.h"

/** 2⁻⁴ J in the account, which is Q32. */
#define CHARGE_SHIFT 28U
#define JOULE        16.0f

/** Of the signal Stop. */
#define STOP_MASK 15U

static bool is_running(const struct jp_ecu_patrol_round *self)
{
    return self->link.state == JP_ROUND_LINK_WHOLE && self->phase == JP_ROUND_RUNS;
}

static void end(struct jp_ecu_patrol_round *self, bool has_failed, enum jp_round_reason reason, uint16_t stop)
{
    self->phase = JP_ROUND_ENDED;
    self->has_failed = has_failed;
    self->reason = reason;
    self->stop = stop;
}

/* Frames that arrive. */

static enum jp_round_field field_of(const char *name)
{
    static const struct {
        const char *name;
        enum jp_round_field field;
    } fields[] = {{"stops.pose", JP_ROUND_FIELD_STOP_POSE}, {"stops.dwell", JP_ROUND_FIELD_STOP_DWELL},
                  {"charger", JP_ROUND_FIELD_CHARGER},      {"full", JP_ROUND_FIELD_FULL},
                  {"reserve", JP_ROUND_FIELD_RESERVE},      {"deviations", JP_ROUND_FIELD_DEVIATIONS}};

    for (unsigned i = 0; i < sizeof fields / sizeof fields[0]; i++) {
        if (strcmp(name, fields[i].name) == 0) {
            return fields[i].field;
        }
    }
    return JP_ROUND_FIELD_NONE;
}

/** The charger is behind the last stop. */
static const struct jp_plane_pose *place(const struct jp_ecu_patrol_round *self, uint16_t stop)
{
    return stop < self->config.stop_count ? &self->config.stops[stop].pose : &self->config.charger;
}

/** By its map it can stand everywhere. */
static void check_places(struct jp_ecu_patrol_round *self)
{
    for (uint16_t i = 0; i <= self->config.stop_count; i++) {
        if (!jp_patrol_pilot_can_stand(&self->patrol->pilot, place(self, i))) {
            jp_round_link_reject(&self->link, JP_ROUND_REASON_BLOCKED, JP_ROUND_FIELD_NONE);
            self->stop = i;
            return;
        }
    }
}

static void take_round(struct jp_ecu_patrol_round *self)
{
    const char *field;

    jp_round_decode(self->link.bytes, self->link.stops, &self->config);
    self->config.standing_power = (float)self->patrol->internal.tables.energy->electronics_power / (float)JP_Q16_ONE;
    if (jp_patrol_round_check(&self->config, &field) != JP_OK) {
        jp_round_link_reject(&self->link, JP_ROUND_REASON_FIELD, field_of(field));
    } else {
        check_places(self);
    }
}

static enum jp_e2e_result accept_offer(struct jp_ecu_patrol_round *self, const struct jp_can_frame *frame, uint8_t map)
{
    return jp_round_link_accept_offer(&self->link, frame, map, !is_running(self));
}

static enum jp_e2e_result accept_data(struct jp_ecu_patrol_round *self, const struct jp_can_frame *frame)
{
    const bool was_whole = self->link.state == JP_ROUND_LINK_WHOLE;
    const enum jp_e2e_result result = jp_round_link_accept_data(&self->link, frame);

    if (!was_whole && self->link.state == JP_ROUND_LINK_WHOLE) {
        self->phase = JP_ROUND_WAITS;
        self->round = (struct jp_patrol_round){.state = JP_ROUND_SURVEYING};
        self->reason = JP_ROUND_REASON_NONE;
        self->stop = 0;
        take_round(self);
    }
    return result;
}

static enum jp_e2e_result accept_charge(struct jp_ecu_patrol_round *self, const struct jp_can_frame *frame)
{
    const enum jp_e2e_result result = jp_round_link_accept_charge(&self->link, frame, &self->charge);

    self->is_charge_new = self->is_charge_new || result == JP_E2E_OK;
    return result;
}

static enum jp_e2e_result accept(void *self, const struct jp_can_frame *frame, uint8_t map)
{
    switch (frame->id) {
    case JP_CAN_ROUND_OFFER_FRAME_ID:
        return accept_offer(self, frame, map);
    case JP_CAN_ROUND_DATA_FRAME_ID:
        return accept_data(self, frame);
    case JP_CAN_BATTERY_CHARGE_FRAME_ID:
    default:
        return accept_charge(self, frame);
    }
}

/* The battery. */

static void keep_account(struct jp_ecu_patrol_round *self, const struct jp_four_wheel_telemetry *now)
{
    if (self->is_charge_new) {
        self->is_charge_new = false;
        self->knows_charge = true;
        self->full_then = ((jp_energy)self->charge << CHARGE_SHIFT) + now->energy;
    }
    self->held = self->full_then - now->energy;
    self->held = self->held < 0 || !self->knows_charge ? 0 : self->held;
}

static float held_joules(const struct jp_ecu_patrol_round *self)
{
    return (float)(int32_t)(self->held >> 32) + (float)(uint32_t)((uint64_t)self->held & UINT32_MAX) * 0x1p-32f;
}

/* The round. */

static uint8_t round_ready(const void *context)
{
    const struct jp_ecu_patrol_round *self = context;

    return self->link.state == JP_ROUND_LINK_WHOLE && self->phase == JP_ROUND_WAITS ? self->link.id : 0U;
}

static void drop_round(void *context)
{
    struct jp_ecu_patrol_round *self = context;

    if (round_ready(self) != 0U) {
        end(self, false, JP_ROUND_REASON_TOLD, 0);
    }
}

static bool are_drives_on(const struct jp_ecu_patrol_round *self)
{
    const enum jp_four_wheel_robot_state state = jp_four_wheel_robot_state_now(&self->patrol->robot);

    return state == JP_FOUR_WHEEL_ROBOT_STANDING || state == JP_FOUR_WHEEL_ROBOT_DRIVING;
}

static enum jp_status begin_round(void *context)
{
    struct jp_ecu_patrol_round *self = context;
    enum jp_status status;
    const char *field;

    if (!self->knows_charge) {
        self->reason = JP_ROUND_REASON_NO_BATTERY;
        return JP_ERR_STATE;
    }
    if (!are_drives_on(self)) {
        return JP_ERR_STATE;
    }
    self->way.stop(self->way.self);
    status = jp_patrol_round_init(&self->round, &self->config, &self->patrol->pilot, &field);
    if (status == JP_OK) {
        self->reason = JP_ROUND_REASON_NONE;
        self->phase = JP_ROUND_RUNS;
    }
    return status;
}

enum jp_round_told jp_round_told_of(enum jp_patrol_round_state state)
{
    switch (state) {
    case JP_ROUND_SURVEYING:
        return JP_ROUND_TOLD_SURVEYING;
    case JP_ROUND_CHARGING:
        return JP_ROUND_TOLD_CHARGING;
    case JP_ROUND_LEAVING:
        return JP_ROUND_TOLD_LEAVING;
    case JP_ROUND_DWELLING:
        return JP_ROUND_TOLD_DWELLING;
    case JP_ROUND_HOMING:
        return JP_ROUND_TOLD_HOMING;
    case JP_ROUND_WAITING:
        return JP_ROUND_TOLD_WAITING;
    case JP_ROUND_FAILED:
    default:
        return JP_ROUND_TOLD_FAILED;
    }
}

enum jp_round_reason jp_round_reason_of(enum jp_patrol_round_reason reason)
{
    switch (reason) {
    case JP_ROUND_NO_WAY:
        return JP_ROUND_REASON_NO_WAY;
    case JP_ROUND_NO_ENERGY:
        return JP_ROUND_REASON_NO_ENERGY;
    case JP_ROUND_DRIVES_OFF:
        return JP_ROUND_REASON_DRIVES_OFF;
    case JP_ROUND_NO_REASON:
    default:
        return JP_ROUND_REASON_NONE;
    }
}

/** The drives brake by themselves. */
static bool has_drives(struct jp_ecu_patrol_round *self)
{
    const bool is_fault = jp_four_wheel_robot_state_now(&self->patrol->robot) == JP_FOUR_WHEEL_ROBOT_FAULT;

    if (are_drives_on(self)) {
        return true;
    }
    end(self, true, is_fault ? JP_ROUND_REASON_FAULT : JP_ROUND_REASON_DRIVES_OFF, self->round.stop);
    self->way.stop(self->way.self);
    return false;
}

static void go_round(struct jp_ecu_patrol_round *self, uint32_t ticks)
{
    const uint32_t rate = jp_four_wheel_robot_configuration(&self->patrol->robot)->tick_rate;

    if (has_drives(self) &&
        jp_patrol_round_work(&self->round, held_joules(self), (float)ticks / (float)rate) == JP_ROUND_FAILED) {
        end(self, true, jp_round_reason_of(self->round.reason), self->round.stop);
    }
}

static bool work(void *context)
{
    struct jp_ecu_patrol_round *self = context;
    const bool is_new = self->way.work(self->way.self);
    struct jp_four_wheel_telemetry now;

    if (jp_four_wheel_robot_telemetry(&self->patrol->robot, &now)) {
        const uint32_t ticks = now.tick - self->tick;

        self->tick = now.tick;
        keep_account(self, &now);
        if (is_running(self)) {
            go_round(self, ticks);
        }
    }
    return is_new;
}

/* The way of a single goal, unless the round is driven. */

static enum jp_status prepare(void *context, struct jp_terrain *map, const struct jp_place *origin)
{
    struct jp_ecu_patrol_round *self = context;

    return self->way.prepare(self->way.self, map, origin);
}

/** A round under way keeps its map. */
static void forget(void *context)
{
    struct jp_ecu_patrol_round *self = context;

    if (self->link.state == JP_ROUND_LINK_RECEIVING) {
        jp_round_link_reject(&self->link, JP_ROUND_REASON_MAP_GONE, JP_ROUND_FIELD_NONE);
    } else if (round_ready(self) != 0U) {
        end(self, false, JP_ROUND_REASON_MAP_GONE, 0);
    } else {
        /* None waits. */
    }
    self->way.forget(self->way.self);
}

static bool is_under_way(const void *context)
{
    const struct jp_ecu_patrol_round *self = context;

    return is_running(self) || self->way.is_under_way(self->way.self);
}

static void see(void *context, int32_t x, int32_t y, enum jp_cell cell)
{
    struct jp_ecu_patrol_round *self = context;

    self->way.see(self->way.self, x, y, cell);
}

static bool can_stand(const void *context, const struct jp_map_goal *goal)
{
    const struct jp_ecu_patrol_round *self = context;

    return self->way.can_stand(self->way.self, goal);
}

static void stop(void *context)
{
    struct jp_ecu_patrol_round *self = context;

    if (is_running(self)) {
        end(self, false, JP_ROUND_REASON_TOLD, self->round.stop);
    }
    self->way.stop(self->way.self);
}

/** In the round's place. */
static enum jp_status go(void *context, const struct jp_map_goal *goal)
{
    struct jp_ecu_patrol_round *self = context;

    if (is_running(self)) {
        stop(self);
    }
    return self->way.go(self->way.self, goal);
}

static void tell(const void *context, struct jp_way_report *report)
{
    const struct jp_ecu_patrol_round *self = context;

    self->way.tell(self->way.self, report);
}

/* The report. */

static enum jp_round_told told_whole(const struct jp_ecu_patrol_round *self)
{
    if (self->phase == JP_ROUND_WAITS) {
        return JP_ROUND_TOLD_READY;
    }
    if (self->phase == JP_ROUND_RUNS) {
        return jp_round_told_of(self->round.state);
    }
    return self->has_failed ? JP_ROUND_TOLD_FAILED : JP_ROUND_TOLD_STOPPED;
}

static enum jp_round_told told(const struct jp_ecu_patrol_round *self)
{
    switch (self->link.state) {
    case JP_ROUND_LINK_RECEIVING:
        return JP_ROUND_TOLD_RECEIVING;
    case JP_ROUND_LINK_REJECTED:
        return JP_ROUND_TOLD_REJECTED;
    case JP_ROUND_LINK_WHOLE:
        return told_whole(self);
    case JP_ROUND_LINK_NONE:
    default:
        return JP_ROUND_TOLD_NONE;
    }
}

/** Of the round, or of an offer that was refused for its sake. */
static enum jp_round_reason reason_of_whole(const struct jp_ecu_patrol_round *self)
{
    if (!is_running(self)) {
        return self->reason;
    }
    return self->link.reason == JP_ROUND_REASON_NONE ? jp_round_reason_of(self->round.reason) : self->link.reason;
}

static void tell_status(const struct jp_ecu_patrol_round *self, struct jp_can_frame *frame)
{
    const bool is_whole = self->link.state == JP_ROUND_LINK_WHOLE;
    const uint32_t visits = is_whole ? self->round.visits : 0U;
    const struct jp_can_round_status_t signals = {
        .round_id = self->link.id,
        .state = (uint8_t)told(self),
        .reason = (uint8_t)(is_whole ? reason_of_whole(self) : self->link.reason),
        .field = (uint8_t)self->link.field,
        .stop = (uint8_t)((is_running(self) ? self->round.stop : self->stop) & STOP_MASK),
        .received = self->link.frames,
        .visits = (uint16_t)(visits > UINT16_MAX ? UINT16_MAX : visits),
        .charges = jp_signal_count8(is_whole ? self->round.charges : 0U),
        .skipped = jp_signal_count8(is_whole ? self->round.skipped : 0U),
    };

    (void)jp_can_round_status_pack(frame->data, &signals, sizeof frame->data);
}

static void tell_battery(const struct jp_ecu_patrol_round *self, struct jp_can_frame *frame)
{
    const bool came_home = self->round.charges > 0U;
    const struct jp_can_round_battery_t signals = {
        .held = (uint32_t)((uint64_t)self->held >> CHARGE_SHIFT),
        .least_left = came_home ? (uint32_t)jp_fixed_of(self->round.least_left, JOULE) : UINT32_MAX};

    (void)jp_can_round_battery_pack(frame->data, &signals, sizeof frame->data);
}

static void tell_round(const void *context, struct jp_can_frame frames[JP_NAVIGATION_ROUND_FRAMES])
{
    const struct jp_ecu_patrol_round *self = context;

    tell_status(self, &frames[0]);
    tell_battery(self, &frames[1]);
}

/* Start. */

static const struct jp_wayfinder_rounds rounds = {
    .accept = accept, .ready = round_ready, .drop = drop_round, .begin = begin_round, .tell = tell_round};

struct jp_wayfinder jp_ecu_patrol_round_wayfinder(struct jp_ecu_patrol_round *round, struct jp_ecu_patrol *patrol)
{
    *round = (struct jp_ecu_patrol_round){.patrol = patrol, .way = jp_ecu_patrol_wayfinder(patrol)};
    return (struct jp_wayfinder){.self = round,
                                 .prepare = prepare,
                                 .forget = forget,
                                 .is_under_way = is_under_way,
                                 .see = see,
                                 .can_stand = can_stand,
                                 .go = go,
                                 .stop = stop,
                                 .work = work,
                                 .tell = tell,
                                 .rounds = &rounds};
}
