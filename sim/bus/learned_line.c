#include "sim/bus/learned_line.h"

#include <inttypes.h>
#include <stdio.h>

#define Q16_ONE 65536.0

static double value(jp_q16 number)
{
    return number / Q16_ONE;
}

static const char *misfit(enum jp_stored stored)
{
    switch (stored) {
    case JP_STORED_OTHER_VERSION:
        return "of another version of the firmware";
    case JP_STORED_OTHER_ROBOT:
        return "of another robot";
    case JP_STORED_OTHER_TABLES:
        return "learned with other tables";
    case JP_STORED_DAMAGED:
    case JP_STORED_NOTHING:
    case JP_STORED_TAKEN:
    default:
        return "damaged";
    }
}

void learned_line_start(const struct ecu_node *node, const char *path)
{
    const struct jp_ecu *ecu = &node->lockstep.ecu;
    struct jp_ecu_lessons lessons;

    jp_ecu_read_lessons(ecu, &lessons);
    if (jp_ecu_learned_state(ecu) == NULL) {
        (void)printf("%s: not used: there are no tables to learn with for this robot and model\n", path);
    } else if (lessons.stored == JP_STORED_NOTHING) {
        (void)printf("%s: nothing learned yet\n", path);
    } else if (lessons.stored == JP_STORED_TAKEN) {
        (void)printf("%s: learned from %" PRIu32 " segments\n", path, lessons.version);
    } else {
        (void)printf("%s: not used: %s; the built-in model serves\n", path, misfit(lessons.stored));
    }
}

/** A balancer's ground and payload, which its learner tells apart. */
static void print_cause(const struct jp_learner *learner)
{
    jp_q16 friction;
    jp_q16 friction_deviation;
    jp_q16 payload;
    jp_q16 payload_deviation;

    jp_learner_causes(learner, &friction, &payload);
    jp_learner_cause_deviations(learner, &friction_deviation, &payload_deviation);
    if (learner->cause == JP_CAUSE_GROUND) {
        (void)printf("surface changed, friction %.2f ± %.2f of the robot file's\n", value(friction),
                     value(friction_deviation));
    } else {
        (void)printf("payload changed, %+.2f ± %.2f kg of the robot file's\n", value(payload),
                     value(payload_deviation));
    }
}

static void print_change(const struct ecu_node *node, enum jp_cause cause)
{
    switch (cause) {
    case JP_CAUSE_GROUND:
    case JP_CAUSE_PAYLOAD:
        print_cause(&node->balancer.robot.pilot.learner);
        break;
    case JP_CAUSE_OTHER:
        (void)printf("robot changed, neither surface nor payload\n");
        break;
    case JP_CAUSE_NONE:
    default:
        (void)printf("surface or robot changed, learning anew\n");
        break;
    }
}

static const char *cause_name(enum jp_cause cause)
{
    switch (cause) {
    case JP_CAUSE_GROUND:
        return "ground";
    case JP_CAUSE_PAYLOAD:
        return "payload";
    case JP_CAUSE_OTHER:
        return "other";
    case JP_CAUSE_NONE:
    default:
        return "none";
    }
}

static json_t *change_json(const struct ecu_node *node, enum jp_cause cause, double seconds)
{
    json_t *object = json_pack("{s:f, s:s}", "t_s", seconds, "cause", cause_name(cause));
    const struct jp_learner *learner = &node->balancer.robot.pilot.learner;
    jp_q16 friction;
    jp_q16 friction_deviation;
    jp_q16 payload;
    jp_q16 payload_deviation;

    if (cause != JP_CAUSE_GROUND && cause != JP_CAUSE_PAYLOAD) {
        return object;
    }
    jp_learner_causes(learner, &friction, &payload);
    jp_learner_cause_deviations(learner, &friction_deviation, &payload_deviation);
    (void)json_object_set_new(object, "friction", json_real(value(friction)));
    (void)json_object_set_new(object, "friction_deviation", json_real(value(friction_deviation)));
    (void)json_object_set_new(object, "payload_kg", json_real(value(payload)));
    (void)json_object_set_new(object, "payload_deviation_kg", json_real(value(payload_deviation)));
    return object;
}

void learned_line_print(struct learned_line *last, const struct ecu_node *node)
{
    const struct jp_ecu *ecu = &node->lockstep.ecu;
    struct jp_ecu_lessons lessons;

    jp_ecu_read_lessons(ecu, &lessons);
    if (lessons.changes == last->changes && lessons.cause == last->cause) {
        return;
    }
    last->changes = lessons.changes;
    last->cause = lessons.cause;
    if (lessons.changes > 0U) {
        const double seconds = (double)ecu->tick / jp_ecu_tick_rate(ecu);

        (void)json_array_append_new(last->told, change_json(node, lessons.cause, seconds));
        (void)printf("%.1f s: ", seconds);
        print_change(node, lessons.cause);
        (void)fflush(stdout);
    }
}
