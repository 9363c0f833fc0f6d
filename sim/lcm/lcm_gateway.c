#include "sim/lcm/lcm_gateway.h"

#include <inttypes.h>

#include "sim/base/error.h"

/* Most that is taken in one pass, so that a flood on one side does not silence the other. */
#define FRAMES_A_PASS  256
#define PACKETS_A_PASS 16

#define SAY_AGAIN_US 1000000U
#define US_PER_MS    1000U
#define US_PER_S     1000000U

/* LCM to CAN. */

static void drop(struct lcm_gateway *gateway, const char *channel, enum lcm_task_result why)
{
    const bool first = gateway->dropped[why] == 0;

    gateway->dropped[why]++;
    if (first || gateway->wall_us - gateway->said_us[why] >= SAY_AGAIN_US) {
        gateway->said_us[why] = gateway->wall_us;
        error_line("%s: %s; dropped (%" PRIu64 " so far)", channel, lcm_task_text(why), gateway->dropped[why]);
    }
}

static void take(struct lcm_gateway *gateway, const lcm_recv_buf_t *packet, const char *channel,
                 lcm_operator_take *take_packet)
{
    const enum lcm_task_result result = take_packet(&gateway->operator, packet->data, packet->data_size);

    if (result != LCM_TASK_OK) {
        drop(gateway, channel, result);
    }
}

static void take_goal(const lcm_recv_buf_t *packet, const char *channel, void *gateway)
{
    take(gateway, packet, channel, lcm_operator_goal);
}

static void take_route(const lcm_recv_buf_t *packet, const char *channel, void *gateway)
{
    take(gateway, packet, channel, lcm_operator_route);
}

static void take_map(const lcm_recv_buf_t *packet, const char *channel, void *gateway)
{
    take(gateway, packet, channel, lcm_operator_map);
}

static void take_cells(const lcm_recv_buf_t *packet, const char *channel, void *gateway)
{
    take(gateway, packet, channel, lcm_operator_cells);
}

static void take_map_goal(const lcm_recv_buf_t *packet, const char *channel, void *gateway)
{
    take(gateway, packet, channel, lcm_operator_map_goal);
}

/** The operator's port: telemetry hears what the operator sends, which the bus does not echo. */
static enum jp_status send(void *context, const struct jp_can_frame *frame)
{
    struct lcm_gateway *gateway = context;
    const struct jp_can_port *port = &gateway->link.port;
    const enum jp_status status = port->send(port->context, frame);

    if (status == JP_OK) {
        lcm_telemetry_accept(&gateway->telemetry, frame, gateway->time_us);
    }
    return status;
}

static enum jp_can_state bus_state(void *context)
{
    const struct lcm_gateway *gateway = context;

    return gateway->link.port.state(gateway->link.port.context);
}

static void tick(struct lcm_gateway *gateway)
{
    const struct jp_can_port port = {.context = gateway, .send = send, .state = bus_state};

    lcm_operator_tick(&gateway->operator, (uint32_t)(gateway->operator_us / US_PER_MS), &port);
}

/* Time. */

static void forget_robot(struct lcm_gateway *gateway)
{
    const uint64_t unsent = gateway->telemetry.unsent;

    lcm_telemetry_start(&gateway->telemetry, gateway->lcm, &gateway->operator);
    gateway->telemetry.unsent = unsent;
}

/** Time that goes back belongs to a new simulation: what is known of the robot is forgotten, the operator's task stays.
 */
static void set_time(struct lcm_gateway *gateway, uint64_t time_us)
{
    if (time_us < gateway->time_us) {
        forget_robot(gateway);
    } else {
        gateway->operator_us += time_us - gateway->time_us;
    }
    gateway->time_us = time_us;
}

/** Without power the ECU gets a tick that says nothing of the time, and nobody knows when a tick without a rate is. */
static void take_sim_time(struct lcm_gateway *gateway, const struct jp_can_frame *frame)
{
    struct jp_can_sim_time_t time;

    if (jp_can_sim_time_unpack(&time, frame->data, frame->length) != 0 || time.power == 0U || time.rate == 0U) {
        return;
    }
    gateway->lockstep = true;
    set_time(gateway, (uint64_t)time.tick * US_PER_S / time.rate);
    tick(gateway);
}

/* CAN to LCM. */

static void take_frame(struct lcm_gateway *gateway, const struct jp_can_frame *frame)
{
    if (frame->id == JP_CAN_SIM_TIME_FRAME_ID) {
        take_sim_time(gateway, frame);
        return;
    }
    lcm_operator_accept(&gateway->operator, frame);
    lcm_telemetry_accept(&gateway->telemetry, frame, gateway->time_us);
}

bool lcm_gateway_start(struct lcm_gateway *gateway, const struct jp_can_link *link, lcm_t *lcm)
{
    *gateway = (struct lcm_gateway){.link = *link, .lcm = lcm};
    lcm_telemetry_start(&gateway->telemetry, lcm, &gateway->operator);
    return lcm_subscribe(lcm, "JP_GOAL", take_goal, gateway) != NULL &&
           lcm_subscribe(lcm, "JP_ROUTE", take_route, gateway) != NULL &&
           lcm_subscribe(lcm, "JP_MAP", take_map, gateway) != NULL &&
           lcm_subscribe(lcm, "JP_CELLS", take_cells, gateway) != NULL &&
           lcm_subscribe(lcm, "JP_MAP_GOAL", take_map_goal, gateway) != NULL;
}

void lcm_gateway_free(struct lcm_gateway *gateway)
{
    lcm_operator_free(&gateway->operator);
}

void lcm_gateway_pass(struct lcm_gateway *gateway, uint64_t wall_us)
{
    const struct jp_can_link *link = &gateway->link;
    struct jp_can_frame frame;

    gateway->wall_us = wall_us;
    if (!gateway->lockstep) {
        set_time(gateway, wall_us);
    }
    for (int i = 0; i < FRAMES_A_PASS && link->receive(link->port.context, &frame); i++) {
        take_frame(gateway, &frame);
    }
    for (int i = 0; i < PACKETS_A_PASS && lcm_handle_timeout(gateway->lcm, 0) > 0; i++) {
    }
    if (!gateway->lockstep) {
        tick(gateway);
    }
}
