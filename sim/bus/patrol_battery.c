#include "sim/bus/patrol_battery.h"

#include <math.h>

#include "hal/can/jp_can.h"
#include "hal/can/messages.h"
#include "sim/base/strict_math.h"

/* The contacts. */
#define CONTACT      0.15 /* m */
#define CONTACT_TURN (10 * M_PI / 180)
#define STANDING     0.02 /* m/s */

#define TELL_TICKS (FOUR_WHEEL_RATE_HZ / 10)

/* Of the signal. */
#define JOULE 16.0

void patrol_battery_init(struct patrol_battery *battery, double full_j, double charger_w,
                         const struct planar_pose *charger)
{
    *battery = (struct patrol_battery){
        .held_j = full_j, .full_j = full_j, .charger_w = charger_w, .charger = *charger, .is_at_charger = true};
}

static bool are_contacts_closed(const struct patrol_battery *battery, const struct four_wheel_state *state)
{
    const struct planar_pose *charger = &battery->charger;

    return strict_hypot(state->pose.x - charger->x, state->pose.y - charger->y) <= CONTACT &&
           fabs(planar_wrap(state->pose.heading - charger->heading)) <= CONTACT_TURN &&
           strict_hypot(state->forward, state->left) <= STANDING;
}

void patrol_battery_step(struct patrol_battery *battery, const struct four_wheel_state *state, double taken_j,
                         double seconds)
{
    battery->held_j -= taken_j;
    battery->is_at_charger = are_contacts_closed(battery, state);
    if (battery->is_at_charger) {
        battery->held_j = fmin(battery->held_j + battery->charger_w * seconds, battery->full_j);
    }
}

void patrol_battery_tell(struct patrol_battery *battery, uint64_t tick, const struct jp_can_port *port)
{
    const struct jp_can_battery_charge_t signals = {.held = (uint32_t)fmax(battery->held_j * JOULE, 0)};
    struct jp_can_frame frame = {.id = JP_CAN_BATTERY_CHARGE_FRAME_ID, .length = JP_CAN_BATTERY_CHARGE_LENGTH};

    if (!battery->is_at_charger || tick % TELL_TICKS != 0) {
        return;
    }
    (void)jp_can_battery_charge_pack(frame.data, &signals, sizeof frame.data);
    jp_e2e_protect(&battery->counter, JP_DATA_ID_BATTERY_CHARGE, frame.data, frame.length);
    (void)port->send(port->context, &frame);
}
