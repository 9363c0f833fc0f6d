#include <joulepath/drive_watch.h>

#include <joulepath/count.h>
#include <stddef.h>

/** No transients are left after so long, s. */
#define STAND_MAX JP_Q16(60)

void jp_drive_watch_start(struct jp_drive_watch *watch, struct jp_learner *learner, uint32_t tick_rate, bool of_battery)
{
    *watch =
        (struct jp_drive_watch){.learner = learner, .tick_rate = tick_rate, .of_battery = of_battery, .known = true};
}

void jp_drive_watch_command(struct jp_drive_watch *watch, const struct jp_segment_command *command)
{
    watch->next = *command;
    watch->commanded = true;
}

/** Since the present segment or stand began, s; at least what the horizon can tell. */
static jp_q16 elapsed(const struct jp_drive_watch *watch, const struct jp_telemetry *telemetry)
{
    const struct jp_horizon *horizon = watch->learner->horizon;
    const uint64_t seconds = ((uint64_t)(telemetry->tick - watch->begin_tick) << 16) / watch->tick_rate;
    const jp_q16 least = horizon == NULL ? 0 : horizon->duration_min;

    return seconds > (uint64_t)STAND_MAX ? STAND_MAX : jp_clamp32((int32_t)seconds, least, STAND_MAX);
}

/** How the robot moves after so long of the present command; false: not known. */
static bool end_after(const struct jp_drive_watch *watch, jp_q16 duration, struct jp_energy_start *end)
{
    const struct jp_learner *learner = watch->learner;
    struct jp_segment_command command = watch->command;
    jp_q16 energy;

    command.duration = duration;
    *end = (struct jp_energy_start){.motion = command.motion};
    return jp_energy_forecast(learner->built_in, learner->horizon, &watch->start, &command, &energy, end) == JP_OK &&
           watch->known;
}

/** How the robot moves now. */
static bool end_now(const struct jp_drive_watch *watch, const struct jp_telemetry *telemetry,
                    struct jp_energy_start *end)
{
    const jp_q16 duration = elapsed(watch, telemetry);

    if (!watch->driving && !watch->known && duration >= watch->learner->built_in->settling_time) {
        *end = (struct jp_energy_start){0};
        return true;
    }
    return end_after(watch, duration, end);
}

bool jp_drive_watch_next_start(const struct jp_drive_watch *watch, const struct jp_telemetry *telemetry,
                               struct jp_energy_start *start)
{
    return watch->driving ? end_after(watch, watch->command.duration, start) : end_now(watch, telemetry, start);
}

static bool was_cut(const struct jp_drive_watch *watch, const struct jp_telemetry *telemetry)
{
    return telemetry->segments_ended == watch->segment.segments_ended;
}

static void learn(struct jp_drive_watch *watch, const struct jp_telemetry *telemetry)
{
    const jp_energy measured = watch->of_battery ? telemetry->segment_energy_battery : telemetry->segment_energy_model;

    if (jp_learner_update(watch->learner, &watch->start, &watch->command, jp_energy_to_q16(measured),
                          &watch->learned) == JP_OK) {
        watch->learned_from = jp_one_more32(watch->learned_from);
    } else {
        watch->left_out = jp_one_more32(watch->left_out);
    }
}

static void end_segment(struct jp_drive_watch *watch, const struct jp_telemetry *telemetry)
{
    watch->evidence = jp_segment_evidence(&watch->segment, telemetry, watch->of_battery);
    if (watch->evidence == JP_EVIDENCE_GOOD && watch->known) {
        learn(watch, telemetry);
    } else {
        watch->left_out = jp_one_more32(watch->left_out);
    }
}

static bool is_same(const struct jp_motion *a, const struct jp_motion *b)
{
    return a->speed == b->speed && a->turn_rate == b->turn_rate;
}

/** The motion tells whether it is the segment that was told. */
static void begin_segment(struct jp_drive_watch *watch, const struct jp_telemetry *telemetry)
{
    watch->known = watch->known && watch->commanded && is_same(&watch->next.motion, &telemetry->command);
    watch->commanded = false;
    watch->command = watch->next;
    watch->command.motion = telemetry->command;
    jp_segment_watch_begin(&watch->segment, telemetry);
}

/** From one segment to the next, or between a segment and a stand. */
static void change(struct jp_drive_watch *watch, const struct jp_telemetry *telemetry, bool driving)
{
    struct jp_energy_start start;
    const bool known = watch->driving && was_cut(watch, telemetry)
                           ? end_now(watch, telemetry, &start)
                           : jp_drive_watch_next_start(watch, telemetry, &start);

    if (watch->driving) {
        end_segment(watch, telemetry);
    }
    watch->start = start;
    watch->known = known;
    watch->begin_tick = telemetry->tick;
    watch->driving = driving;
    if (driving) {
        begin_segment(watch, telemetry);
    } else {
        watch->command = (struct jp_segment_command){.duration = 0};
    }
}

/** Motors off: when they are switched on again the robot begins at rest. */
static void rest(struct jp_drive_watch *watch, const struct jp_telemetry *telemetry)
{
    watch->start = (struct jp_energy_start){.motion = {.speed = 0, .turn_rate = 0}};
    watch->known = true;
    watch->begin_tick = telemetry->tick;
}

bool jp_drive_watch_update(struct jp_drive_watch *watch, const struct jp_telemetry *telemetry, uint8_t battery_flags,
                           uint8_t current_findings)
{
    const bool driving = telemetry->state == JP_ROBOT_DRIVING;
    /* The same in every tick of a segment. */
    const uint32_t end_tick = telemetry->tick + telemetry->segment_ticks_left;
    const bool changed = driving != watch->driving || (driving && end_tick != watch->end_tick);

    jp_segment_watch_note(&watch->segment, battery_flags, current_findings);
    if (changed) {
        change(watch, telemetry, driving);
    }
    if (!driving && telemetry->state != JP_ROBOT_BALANCING) {
        rest(watch, telemetry);
    }
    watch->end_tick = end_tick;
    return changed && driving;
}
