#include "sim/missions/patrol_round_record.h"

#include <math.h>

#include "sim/base/strict_math.h"

#define DEGREES (180 / M_PI)

#define TICK (1.0 / FOUR_WHEEL_RATE_HZ)

/* After this time away from the charger all has been told of it, s. */
#define SETTLED 1.0

/* From a line of the log to the next, s. */
#define LINE_PERIOD 0.5

const char *const patrol_journey_ends[PATROL_JOURNEY_ENDS] = {
    [PATROL_JOURNEY_ARRIVED] = "arrived",   [PATROL_JOURNEY_TURNED_HOME] = "turned home",
    [PATROL_JOURNEY_LEFT_OUT] = "left out", [PATROL_JOURNEY_NO_WAY] = "no way",
    [PATROL_JOURNEY_CUT] = "cut short",
};

void patrol_round_record_init(struct patrol_round_record *record, FILE *log, unsigned stops,
                              const struct patrol_body *body)
{
    *record = (struct patrol_round_record){.log = log,
                                           .stops = stops,
                                           .energy_before_j = body->plant.ledger.battery,
                                           .place = stops,
                                           .pose = body->plant.state.pose};
    (void)fprintf(log, "t_s,x_m,y_m,heading_deg,held_j,told_j,state,stop\n");
}

/* Journeys. */

static struct patrol_journey *last_of(struct patrol_round_record *record)
{
    return &record->journeys[record->journey_count - 1];
}

static void end_journey(struct patrol_round_record *record, enum patrol_journey_end end, const struct patrol_body *body)
{
    struct patrol_journey *journey = last_of(record);

    record->is_under_way = false;
    journey->end = end;
    journey->time_s = record->time_s - journey->begin_s;
    journey->length_m = record->length_m - journey->length_m;
    journey->taken_j = record->energy_j - journey->taken_j;
    journey->left_j = body->battery->held_j;
    record->place = journey->to;
}

static void begin_journey(struct patrol_round_record *record, unsigned to)
{
    if (record->journey_count == PATROL_JOURNEYS_MAX) {
        return;
    }
    record->is_under_way = true;
    record->journey_count++;
    *last_of(record) = (struct patrol_journey){.from = record->place,
                                               .to = to,
                                               .begin_s = record->time_s,
                                               .length_m = record->length_m,
                                               .taken_j = record->energy_j};
}

static bool is_journey(const struct patrol_round_told *told)
{
    return told->state == JP_ROUND_TOLD_LEAVING || told->state == JP_ROUND_TOLD_HOMING;
}

static enum patrol_journey_end end_of(const struct patrol_round_told *before, const struct patrol_round_told *told)
{
    if (told->visits > before->visits || told->charges > before->charges) {
        return PATROL_JOURNEY_ARRIVED;
    }
    if (told->state == JP_ROUND_TOLD_HOMING) {
        return PATROL_JOURNEY_TURNED_HOME;
    }
    if (told->state == JP_ROUND_TOLD_WAITING) {
        return PATROL_JOURNEY_NO_WAY;
    }
    return told->skipped > before->skipped ? PATROL_JOURNEY_LEFT_OUT : PATROL_JOURNEY_CUT;
}

/* By its first plan. */
static void note_forecast(struct patrol_round_record *record, const struct patrol_round_told *told)
{
    struct patrol_journey *journey = last_of(record);

    if (journey->foretold_j <= 0 && told->left_j > 0) {
        journey->foretold_j = record->energy_j - journey->taken_j + told->left_j;
        journey->deviation_j = told->deviation_j;
    }
}

static void note_journeys(struct patrol_round_record *record, const struct patrol_round_told *told,
                          const struct patrol_body *body)
{
    const bool is_another = told->state != record->told.state || told->stop != record->told.stop;

    if (record->is_under_way && is_another) {
        end_journey(record, end_of(&record->told, told), body);
    }
    if (is_journey(told) && is_another) {
        begin_journey(record, told->stop);
    } else if (record->is_under_way) {
        note_forecast(record, told);
    }
}

/* A tick. */

static void write_line(const struct patrol_round_record *record, const struct patrol_body *body)
{
    const struct planar_pose *const pose = &body->plant.state.pose;

    (void)fprintf(record->log, "%.2f,%.3f,%.3f,%.1f,%.1f,%.1f,%d,%u\n", record->time_s, pose->x, pose->y,
                  pose->heading * DEGREES, body->battery->held_j, record->told.held_j, (int)record->told.state,
                  record->told.stop);
}

/* Away from the charger, whose last word must have come. */
static void note_account(struct patrol_round_record *record, const struct patrol_body *body)
{
    const double error = fabs(record->told.held_j - body->battery->held_j);

    record->away_s = body->battery->is_at_charger ? 0 : record->away_s + TICK;
    if (record->away_s > SETTLED) {
        record->account_error_j = fmax(record->account_error_j, error);
    }
}

void patrol_round_record_tick(struct patrol_round_record *record, const struct patrol_round_told *told,
                              const struct patrol_body *body, double reserve_j)
{
    const struct planar_pose *const pose = &body->plant.state.pose;

    record->time_s += TICK;
    record->length_m += strict_hypot(pose->x - record->pose.x, pose->y - record->pose.y);
    record->pose = *pose;
    record->energy_j = body->plant.ledger.battery - record->energy_before_j;
    note_journeys(record, told, body);
    record->below_reserve += told->charges > record->told.charges && body->battery->held_j < reserve_j;
    record->told = *told;
    note_account(record, body);
    if (record->time_s >= record->next_line_s) {
        record->next_line_s += LINE_PERIOD;
        write_line(record, body);
    }
}

void patrol_round_record_end(struct patrol_round_record *record, const struct patrol_body *body)
{
    if (record->is_under_way) {
        end_journey(record, PATROL_JOURNEY_CUT, body);
    }
    write_line(record, body);
}
