#include "sim/lcm/lcm_operator.h"

/* Tasks. */

/** From now on it is silent, and the commander has the task. */
static void dismiss_navigator(struct lcm_operator *self)
{
    if (self->navigates) {
        self->navigator = (struct jp_navigation_operator){.phase = JP_NAVIGATION_IDLE};
        self->navigates = false;
        self->is_given = false;
    }
}

static void dismiss_commander(struct lcm_operator *self)
{
    if (!self->navigates) {
        self->commander = (struct jp_operator){.phase = JP_OPERATOR_IDLE};
        self->navigates = true;
    }
}

static void drive(struct lcm_operator *self, const struct jp_route_message *route)
{
    dismiss_navigator(self);
    (void)jp_operator_route(&self->commander, route->points, route->length);
}

enum lcm_task_result lcm_operator_goal(struct lcm_operator *self, const void *packet, size_t size)
{
    struct jp_route_message route;
    const enum lcm_task_result result = lcm_task_goal(packet, size, &route);

    if (result == LCM_TASK_OK) {
        drive(self, &route);
    }
    return result;
}

enum lcm_task_result lcm_operator_route(struct lcm_operator *self, const void *packet, size_t size)
{
    struct jp_route_message route;
    const enum lcm_task_result result = lcm_task_route(packet, size, &route);

    if (result == LCM_TASK_OK) {
        drive(self, &route);
    }
    return result;
}

enum lcm_task_result lcm_operator_map(struct lcm_operator *self, const void *packet, size_t size)
{
    bool is_new = false;
    const enum lcm_task_result result = lcm_map_read(&self->map, packet, size, &is_new);

    if (result == LCM_TASK_OK && is_new) {
        self->is_given = false;
        lcm_operator_stop(self);
    }
    return result;
}

enum lcm_task_result lcm_operator_cells(struct lcm_operator *self, const void *packet, size_t size)
{
    return lcm_map_read_cells(&self->map, packet, size);
}

/** With the map as it is known: an ECU that restarts before it gets it knows all that was seen. */
enum lcm_task_result lcm_operator_map_goal(struct lcm_operator *self, const void *packet, size_t size)
{
    struct jp_map_goal goal;
    const enum lcm_task_result result = lcm_map_read_goal(&self->map, packet, size, &goal);
    uint8_t *bytes = self->streams[1U - self->stream];

    if (result != LCM_TASK_OK) {
        return result;
    }

    const size_t length = lcm_map_encode(&self->map, bytes, sizeof self->streams[0]);
    const struct jp_map_stream stream = {.bytes = bytes, .length = (uint16_t)length, .id = self->map.id};

    if (length == 0) {
        return LCM_TASK_STREAM;
    }
    self->stream = 1U - self->stream;
    dismiss_commander(self);
    self->is_given = true;
    (void)jp_navigation_operator_go(&self->navigator, &stream, &goal);
    return LCM_TASK_OK;
}

void lcm_operator_stop(struct lcm_operator *self)
{
    if (self->navigates) {
        jp_navigation_operator_stop(&self->navigator);
    } else {
        jp_operator_stop(&self->commander);
    }
}

void lcm_operator_free(struct lcm_operator *self)
{
    lcm_map_free(&self->map);
}

/* The bus. */

bool lcm_operator_is_commanding(const struct lcm_operator *self)
{
    return self->navigates ? self->navigator.commanding : self->commander.commanding;
}

void lcm_operator_accept(struct lcm_operator *self, const struct jp_can_frame *frame)
{
    jp_operator_accept(&self->commander, frame);
    jp_navigation_operator_accept(&self->navigator, frame);
}

static bool tell(void *context, uint16_t x, uint16_t y, enum jp_cell cell)
{
    return jp_navigation_operator_see(context, x, y, cell) == JP_OK;
}

void lcm_operator_tick(struct lcm_operator *self, uint32_t time_ms, const struct jp_can_port *port)
{
    if (self->is_given) {
        lcm_map_tell_cells(&self->map, tell, &self->navigator);
    }
    jp_operator_tick(&self->commander, time_ms, port);
    jp_navigation_operator_tick(&self->navigator, time_ms, port);
}

/* What is told of the task. */

enum jp_operator_phase lcm_operator_phase(const struct lcm_operator *self)
{
    static const enum jp_operator_phase phases[] = {
        [JP_NAVIGATION_IDLE] = JP_OPERATOR_IDLE,         [JP_NAVIGATION_STANDING_UP] = JP_OPERATOR_STANDING_UP,
        [JP_NAVIGATION_SENDING] = JP_OPERATOR_UPLOADING, [JP_NAVIGATION_ASKING] = JP_OPERATOR_UPLOADING,
        [JP_NAVIGATION_DRIVING] = JP_OPERATOR_DRIVING,   [JP_NAVIGATION_DONE] = JP_OPERATOR_DONE,
        [JP_NAVIGATION_FAILED] = JP_OPERATOR_FAILED};

    return self->navigates ? phases[self->navigator.phase] : self->commander.phase;
}

static const char *map_text(const struct jp_navigation_operator *navigator)
{
    switch (navigator->map.reason) {
    case JP_MAP_REASON_TOO_LARGE:
        return "the map is too large for the robot's memory: send a smaller window of it";
    case JP_MAP_REASON_CELL_SIZE:
        return "the map's resolution is not that of the robot's lattice: send it with cells of that size";
    default:
        return jp_navigation_failure_text(JP_NAVIGATION_MAP);
    }
}

static const char *goal_text(const struct jp_navigation_operator *navigator)
{
    switch (navigator->navigator.answer) {
    case JP_GOAL_OUTSIDE:
        return "the goal is not on the robot's map: give another one";
    case JP_GOAL_BLOCKED:
        return "the robot cannot stand at the goal: give another one";
    default:
        return jp_navigation_failure_text(JP_NAVIGATION_GOAL);
    }
}

static const char *navigation_text(const struct jp_navigation_operator *navigator)
{
    switch (navigator->failure) {
    case JP_NAVIGATION_NO_FAILURE:
        return "";
    case JP_NAVIGATION_MAP:
        return map_text(navigator);
    case JP_NAVIGATION_GOAL:
        return goal_text(navigator);
    default:
        return jp_navigation_failure_text(navigator->failure);
    }
}

const char *lcm_operator_failure_text(const struct lcm_operator *self)
{
    const char *text =
        self->navigates ? navigation_text(&self->navigator) : jp_operator_failure_text(self->commander.failure);

    return text == NULL ? "" : text;
}
