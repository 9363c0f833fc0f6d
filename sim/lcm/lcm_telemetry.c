#include "sim/lcm/lcm_telemetry.h"

#include <jp_energy_t.h>
#include <jp_identification_t.h>
#include <jp_navigation_t.h>
#include <jp_plan_t.h>
#include <jp_state_t.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define PERIOD_US     20000U /* of JP_STATE and JP_ENERGY, at the least, on average */
#define MESSAGE_SIZE  16384  /* JP_PLAN with LCM_SEGMENTS_MAX segments takes 11 kB */
#define RAD_PER_TURN  (2 * M_PI)
#define JOULES_PER_WH 3600

_Static_assert(JP_STATE_T_TASK_IDLE == JP_OPERATOR_IDLE && JP_STATE_T_TASK_STANDING_UP == JP_OPERATOR_STANDING_UP &&
                   JP_STATE_T_TASK_UPLOADING == JP_OPERATOR_UPLOADING &&
                   JP_STATE_T_TASK_DRIVING == JP_OPERATOR_DRIVING && JP_STATE_T_TASK_DONE == JP_OPERATOR_DONE &&
                   JP_STATE_T_TASK_FAILED == JP_OPERATOR_FAILED,
               "jp_state_t.lcm numbers the states of a task as operator.h does");

/** The value of a signal, with as many fraction bits as its scale in joulepath.dbc says. */
static double value(int64_t raw, int fraction_bits)
{
    return ldexp((double)raw, -fraction_bits);
}

static double radians(int64_t raw, int fraction_bits)
{
    return RAD_PER_TURN * value(raw, fraction_bits);
}

void lcm_telemetry_start(struct lcm_telemetry *telemetry, lcm_t *lcm, const struct lcm_operator *operator)
{
    *telemetry = (struct lcm_telemetry){.lcm = lcm, .operator= operator};
    jp_route_link_start(&telemetry->routes, 1000U);
    jp_operator_link_start(&telemetry->commands, 1000U / JP_CAN_MOTOR_COMMAND_CYCLE_TIME_MS);
}

/* Publishing. */

static void publish(struct lcm_telemetry *telemetry, const char *channel, const uint8_t *message, int size)
{
    if (size < 0 || lcm_publish(telemetry->lcm, channel, message, (unsigned)size) != 0) {
        telemetry->unsent++;
    }
}

/** Takes the turn of a message if it has come, so that they come every PERIOD_US at the least on average. */
static bool take_turn(uint64_t *due_us, uint64_t time_us)
{
    if (time_us < *due_us) {
        return false;
    }
    /* Frames jitter, so one may come a period early. */
    *due_us = *due_us + 2 * PERIOD_US > time_us ? *due_us + PERIOD_US : time_us;
    return true;
}

static void put_motion(const struct ecu_view *view, jp_state_t *state)
{
    state->x = value(view->pose.x, 16);
    state->y = value(view->pose.y, 16);
    state->heading = radians(view->pose.heading, 12);
    state->speed = value(view->motion.speed, 12);
    state->turn_rate = radians(view->motion.yaw_rate, 12);
    state->pitch = radians(view->motion.pitch, 16);
    state->pitch_rate = radians(view->motion.pitch_rate, 12);
    state->reference_speed = value(view->reference.speed, 12);
    state->reference_turn_rate = radians(view->reference.yaw_rate, 12);
    state->reference_heading = radians(view->reference.heading, 16);
    state->segment_time_left = value(view->reference.segment_time_left, 6);
}

static void put_motors(const struct lcm_telemetry *telemetry, jp_state_t *state)
{
    const struct jp_can_motors_t *motors = &telemetry->view.motors;

    state->voltage_left = value(motors->voltage_left, 7);
    state->voltage_right = value(motors->voltage_right, 7);
    state->current_left = value(telemetry->currents.current_left, 8);
    state->current_right = value(telemetry->currents.current_right, 8);
    state->saturated_ticks = motors->saturated_ticks;
}

static void put_ecu(const struct ecu_view *view, jp_state_t *state)
{
    state->robot_state = (int8_t)view->status.state;
    state->mode = (int8_t)view->status.mode;
    state->operator_state = (int8_t)view->status.operator_state;
    state->resets = view->status.resets;
    state->faults = view->errors.faults;
    state->route_id = view->route.route_id;
    state->route_state = (int8_t)view->route.state;
    state->route_reason = (int8_t)view->route.reason;
    state->route_length = view->route.length;
    state->segment = view->route.segment;
    state->segments_ended = view->route.segments_ended;
    state->plan_status = view->route.plan_status;
}

static void publish_state(struct lcm_telemetry *telemetry, uint64_t time_us)
{
    char text[256];
    jp_state_t state = {
        .utime = (int64_t)time_us, .task = (int8_t)lcm_operator_phase(telemetry->operator), .task_reason = text};
    uint8_t message[1024];

    if (!take_turn(&telemetry->state_due_us, time_us)) {
        return;
    }
    (void)snprintf(text, sizeof text, "%s", lcm_operator_failure_text(telemetry->operator));
    put_motion(&telemetry->view, &state);
    put_motors(telemetry, &state);
    put_ecu(&telemetry->view, &state);
    publish(telemetry, "JP_STATE", message, jp_state_t_encode(message, 0, sizeof message, &state));
}

static void put_points(const struct jp_route_message *route, jp_point_t points[JP_ROUTE_LENGTH_MAX])
{
    for (unsigned i = 0; i < route->length; i++) {
        points[i] = (jp_point_t){.x = value(route->points[i].x, 16), .y = value(route->points[i].y, 16)};
    }
}

static void publish_plan(struct lcm_telemetry *telemetry, uint64_t time_us)
{
    const struct jp_route_message *route = &telemetry->routes.driven;
    jp_point_t points[JP_ROUTE_LENGTH_MAX];
    uint8_t message[MESSAGE_SIZE];
    const jp_plan_t plan = {.utime = (int64_t)time_us,
                            .route_id = route->id,
                            .point_count = route->length,
                            .points = points,
                            .route_segment = telemetry->route_segment,
                            .segment_count = telemetry->planned,
                            .segments = telemetry->segments};

    put_points(route, points);
    publish(telemetry, "JP_PLAN", message, jp_plan_t_encode(message, 0, sizeof message, &plan));
}

static void publish_energy(struct lcm_telemetry *telemetry, uint64_t *due_us, uint64_t time_us)
{
    const jp_residual_t *last = telemetry->ended > 0 ? &telemetry->residuals[telemetry->ended - 1] : NULL;
    const struct jp_can_battery_status_t *battery = &telemetry->battery;
    const jp_energy_t energy = {.utime = (int64_t)time_us,
                                .spent = value(telemetry->view.spent.energy, 32),
                                .drawn = value(telemetry->view.drawn.energy, 32),
                                .battery_voltage = value(battery->voltage, 7),
                                .battery_current = value(battery->current, 8),
                                .state_of_charge = value(battery->state_of_charge, 15),
                                .battery_energy = JOULES_PER_WH * value(battery->energy_left, 6),
                                .segment = last == NULL ? 0 : last->segment,
                                .segment_forecast = last == NULL ? 0 : last->forecast,
                                .segment_spent = last == NULL ? 0 : last->measured,
                                .segment_drawn = last == NULL ? 0 : telemetry->last_drawn};
    uint8_t message[256];

    if (!take_turn(due_us, time_us)) {
        return;
    }
    publish(telemetry, "JP_ENERGY", message, jp_energy_t_encode(message, 0, sizeof message, &energy));
}

static bool knows_parameters(const struct lcm_telemetry *telemetry)
{
    return telemetry->parameters_heard == (1U << LCM_PARAMETERS) - 1U;
}

static void publish_identification(struct lcm_telemetry *telemetry, uint64_t time_us)
{
    const double *parameters = telemetry->parameters;
    jp_identification_t identification = {.utime = (int64_t)time_us,
                                          .electronics_power = parameters[15],
                                          .settling_time = parameters[16],
                                          .voltage_per_speed = parameters[17],
                                          .voltage_per_turn_rate = parameters[18],
                                          .motor_resistance = parameters[19],
                                          .segment_count = telemetry->ended,
                                          .residuals = telemetry->residuals};
    uint8_t message[MESSAGE_SIZE];

    memcpy(identification.a, parameters, sizeof identification.a);
    memcpy(identification.b, parameters + 13, sizeof identification.b);
    publish(telemetry, "JP_IDENTIFICATION", message,
            jp_identification_t_encode(message, 0, sizeof message, &identification));
}

/* Segments. */

/** The slot of the segment whose plan a frame is part of; NULL: the number is not valid. */
static jp_segment_t *announce(struct lcm_telemetry *telemetry, uint8_t segment)
{
    if (segment < 1U) {
        return NULL;
    }
    if (segment != telemetry->announced) {
        if (segment == 1U) {
            telemetry->planned = 0;
            telemetry->ended = 0;
        }
        /* Also those whose frames were all lost. */
        for (int i = telemetry->planned < segment ? telemetry->planned + 1 : segment; i <= segment; i++) {
            telemetry->segments[i - 1] = (jp_segment_t){(int16_t)i, NAN, NAN, NAN, NAN, NAN};
        }
        telemetry->planned = segment;
        telemetry->announced = segment;
    }
    return &telemetry->segments[segment - 1];
}

static void take_segment_motion(struct lcm_telemetry *telemetry)
{
    const struct jp_can_segment_motion_t *motion = &telemetry->view.segment_motion;
    jp_segment_t *segment = announce(telemetry, motion->segment);

    if (segment != NULL) {
        segment->speed = value(motion->speed, 24);
        segment->turn_rate = value(motion->turn_rate, 24);
    }
}

static void take_segment_shape(struct lcm_telemetry *telemetry)
{
    const struct jp_can_segment_shape_t *shape = &telemetry->view.segment_shape;
    jp_segment_t *segment = announce(telemetry, shape->segment);

    if (segment != NULL) {
        segment->turn = value(shape->turn, 24);
        segment->duration = value(shape->duration, 16);
    }
}

/** The last frame of a plan. */
static void take_segment_forecast(struct lcm_telemetry *telemetry, uint64_t time_us)
{
    const struct jp_can_segment_forecast_t *forecast = &telemetry->view.segment_forecast;
    jp_segment_t *segment = announce(telemetry, forecast->segment);

    if (segment == NULL) {
        return;
    }
    segment->energy = value(forecast->energy, 16);
    telemetry->announced = 0;
    if (telemetry->route_is_new) {
        telemetry->route_is_new = false;
        telemetry->route_segment = forecast->segment;
    }
    publish_plan(telemetry, time_us);
}

static void take_segment_result(struct lcm_telemetry *telemetry, uint64_t time_us)
{
    const struct jp_can_segment_result_t *result = &telemetry->view.segment_result;
    const double forecast = result->segment >= 1U && result->segment <= telemetry->planned
                                ? telemetry->segments[result->segment - 1U].energy
                                : NAN;
    const double measured = segment_joules(result->spent);

    if (telemetry->ended >= LCM_SEGMENTS_MAX) {
        return;
    }
    telemetry->residuals[telemetry->ended] = (jp_residual_t){
        .segment = result->segment, .forecast = forecast, .measured = measured, .residual = forecast - measured};
    telemetry->ended++;
    telemetry->last_drawn = segment_joules(result->drawn);
    publish_energy(telemetry, &telemetry->result_due_us, time_us);
    if (knows_parameters(telemetry)) {
        publish_identification(telemetry, time_us);
    }
}

/* The energy model. */

static void take_parameter(struct lcm_telemetry *telemetry, const struct jp_can_frame *frame, uint64_t time_us)
{
    struct jp_can_energy_parameter_t parameter;

    if (jp_can_energy_parameter_unpack(&parameter, frame->data, frame->length) != 0 ||
        parameter.count != LCM_PARAMETERS || parameter.index >= LCM_PARAMETERS) {
        return;
    }
    telemetry->parameters[parameter.index] = value(parameter.value, 16);
    telemetry->parameters_heard |= 1U << parameter.index;
    if (parameter.index == LCM_PARAMETERS - 1U && knows_parameters(telemetry)) {
        publish_identification(telemetry, time_us);
    }
}

/* The navigator. */

static void publish_navigation(struct lcm_telemetry *telemetry, uint64_t time_us)
{
    const struct jp_can_navigation_status_t *status = &telemetry->view.navigation;
    const struct jp_can_navigation_progress_t *left = &telemetry->view.left;
    struct jp_point ends[COURSE_VIEW_LEGS];
    jp_point_t legs[COURSE_VIEW_LEGS];
    uint8_t message[MESSAGE_SIZE];
    const unsigned count = course_view_read(&telemetry->course, status, ends);

    for (unsigned i = 0; i < count; i++) {
        legs[i] = (jp_point_t){.x = value(ends[i].x, 16), .y = value(ends[i].y, 16)};
    }
    const jp_navigation_t navigation = {.utime = (int64_t)time_us,
                                        .map_state = (int8_t)telemetry->view.map.state,
                                        .map_id = telemetry->view.map.map_id,
                                        .goal_id = status->goal_id,
                                        .answer = (int8_t)status->answer,
                                        .state = (int8_t)status->state,
                                        .reason = (int8_t)status->reason,
                                        .vehicle_status = status->vehicle_status,
                                        .replans = status->replans,
                                        .course = status->course,
                                        .forgets = (int8_t)status->forgets,
                                        .distance = value(left->distance, 6),
                                        .duration = value(left->duration, 4),
                                        .energy = value((int64_t)left->energy, 3),
                                        .deviation = value(left->deviation, 3),
                                        .home_state = (int8_t)telemetry->view.home.home_state,
                                        .home_probability = value(telemetry->view.home.probability, 16),
                                        .home_energy = value(telemetry->view.home.way, 3),
                                        .home_deviation = value(telemetry->view.home.way_deviation, 3),
                                        .battery_energy = value(telemetry->view.home_battery.left, 4),
                                        .battery_deviation = value(telemetry->view.home_battery.left_deviation, 4),
                                        .leg_count = (int32_t)count,
                                        .legs = legs};

    publish(telemetry, "JP_NAVIGATION", message, jp_navigation_t_encode(message, 0, sizeof message, &navigation));
}

/* What operators send. */

static void take_operator_command(struct lcm_telemetry *telemetry, const struct jp_can_frame *frame)
{
    struct jp_operator_link *commands = &telemetry->commands;

    (void)jp_operator_link_accept(commands, frame);
    if (commands->mode == JP_MODE_DRIVE && jp_route_link_take(&telemetry->routes, commands->route) != NULL) {
        telemetry->route_is_new = true;
    }
}

static void take_command(struct lcm_telemetry *telemetry, const struct jp_can_frame *frame)
{
    if (frame->id == JP_CAN_OPERATOR_COMMAND_FRAME_ID && frame->length == JP_CAN_OPERATOR_COMMAND_LENGTH) {
        take_operator_command(telemetry, frame);
    } else if (frame->id == JP_CAN_ROUTE_OFFER_FRAME_ID && frame->length == JP_CAN_ROUTE_OFFER_LENGTH) {
        (void)jp_route_link_accept_offer(&telemetry->routes, frame);
    } else if (frame->id == JP_CAN_WAYPOINT_FRAME_ID && frame->length == JP_CAN_WAYPOINT_LENGTH) {
        (void)jp_route_link_accept_waypoint(&telemetry->routes, frame);
    } else if (frame->id == JP_CAN_GOAL_FRAME_ID && frame->length == JP_CAN_GOAL_LENGTH) {
        (void)jp_route_link_accept_goal(&telemetry->routes, frame);
    }
}

/* All frames. */

static void take_robot_frame(struct lcm_telemetry *telemetry, const struct jp_can_frame *frame, uint64_t time_us)
{
    switch (frame->id) {
    case JP_CAN_MOTORS_FRAME_ID:
        publish_state(telemetry, time_us);
        break;
    case JP_CAN_ENERGY_SPENT_FRAME_ID:
        publish_energy(telemetry, &telemetry->energy_due_us, time_us);
        break;
    case JP_CAN_SEGMENT_MOTION_FRAME_ID:
        take_segment_motion(telemetry);
        break;
    case JP_CAN_SEGMENT_SHAPE_FRAME_ID:
        take_segment_shape(telemetry);
        break;
    case JP_CAN_SEGMENT_FORECAST_FRAME_ID:
        take_segment_forecast(telemetry, time_us);
        break;
    case JP_CAN_SEGMENT_RESULT_FRAME_ID:
        take_segment_result(telemetry, time_us);
        break;
    case JP_CAN_NAVIGATION_PROGRESS_FRAME_ID:
        publish_navigation(telemetry, time_us);
        break;
    case JP_CAN_COURSE_LEG_FRAME_ID:
        course_view_take(&telemetry->course, &telemetry->view.leg);
        break;
    default:
        break;
    }
}

void lcm_telemetry_accept(struct lcm_telemetry *telemetry, const struct jp_can_frame *frame, uint64_t time_us)
{
    if (frame->length != JP_CAN_LENGTH_MAX) {
        take_command(telemetry, frame);
        return;
    }
    switch (frame->id) {
    case JP_CAN_CURRENT_SENSORS_FRAME_ID:
        (void)jp_can_current_sensors_unpack(&telemetry->currents, frame->data, frame->length);
        break;
    case JP_CAN_BATTERY_STATUS_FRAME_ID:
        (void)jp_can_battery_status_unpack(&telemetry->battery, frame->data, frame->length);
        break;
    case JP_CAN_ENERGY_PARAMETER_FRAME_ID:
        take_parameter(telemetry, frame, time_us);
        break;
    default:
        take_command(telemetry, frame);
        ecu_view_accept(&telemetry->view, frame);
        take_robot_frame(telemetry, frame, time_us);
        break;
    }
}
