/*
 * Command frames with flipped bits: 10⁷ of them, 1…16 flipped bits each, at receivers that are in step with their
 * sender; and whole routes with flipped bits somewhere. Prints figures as JSON, progress on stderr.
 *
 * What may slip through is known exactly. A receiver takes a message when its CRC fits and its counter is 1…7 ahead of
 * the last one: flips of weight k go unnoticed if they form a codeword of the CRC whose counter bits keep it in that
 * window. Those words are counted by dynamic programming over the bits of a message. The polynomial 0x12F is divisible
 * by x + 1, so that no odd number of flips is among them, and even ones pass twice as often as 2⁻⁸.
 */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/can/messages.h"
#include "hal/can/route_link.h"
#include "sim/base/progress.h"
#include "tests/bench/figures.h"
#include "tests/support/random.h"

enum { SEED = 20180905, FRAMES = 10000000, ROUTES = 1000000, FLIPS_MAX = 16, FLIPS_FOUND = 3, DEVIATIONS = 5 };

#define BYTES_MAX    (JP_SAMPLE_PARTS * JP_CAN_LENGTH_MAX)
#define COUNTERS     16U
#define COUNTER_BITS 4U
#define COUNTER_BYTE 1U
#define CRC_VALUES   256U

#define PROGRESS_STEP 1000U
#define COMMAND       "make figures"

static void fail(const char *what)
{
    (void)fprintf(stderr, "bench_flips: %s\n", what);
    exit(1);
}

/* Messages: commands, and the sample, whose CRC stands in CurrentSensors and goes on over the two other frames. Whether
 * such a group of 24 bytes holds two or three flips is not certain any more: the CRC's period is 127 bits. */

static const struct kind {
    unsigned length; /**< of all that the CRC covers, bytes */
    uint8_t data_id;
} kinds[] = {
    {8, JP_DATA_ID_MOTOR_COMMAND}, {4, JP_DATA_ID_OPERATOR_COMMAND}, {8, JP_DATA_ID_WAYPOINT},
    {8, JP_DATA_ID_GOAL},          {8, JP_DATA_ID_ROUTE_OFFER},      {BYTES_MAX, JP_DATA_ID_SAMPLE},
};
#define KINDS (sizeof kinds / sizeof kinds[0])

struct message {
    uint8_t bytes[BYTES_MAX];
};

/** A sender's random message. */
static void draw_message(const struct kind *kind, uint8_t *counter, struct message *message)
{
    const unsigned first = kind->length < JP_CAN_LENGTH_MAX ? kind->length : JP_CAN_LENGTH_MAX;

    for (unsigned i = 0; i < kind->length; i++) {
        message->bytes[i] = (uint8_t)below(256);
    }
    jp_e2e_protect_group(counter, kind->data_id, message->bytes, first, message->bytes + first, kind->length - first);
}

static enum jp_e2e_result check_message(struct jp_e2e_receiver *receiver, const struct kind *kind,
                                        const struct message *message)
{
    const unsigned first = kind->length < JP_CAN_LENGTH_MAX ? kind->length : JP_CAN_LENGTH_MAX;

    return jp_e2e_check_group(receiver, kind->data_id, message->bytes, first, message->bytes + first,
                              kind->length - first);
}

static void flip(uint8_t *bytes, unsigned length, unsigned flips)
{
    uint8_t mask[BYTES_MAX] = {0};

    while (flips > 0U) {
        const uint32_t bit = below(8U * length);

        if ((mask[bit / 8U] >> (bit % 8U) & 1U) == 0U) {
            mask[bit / 8U] |= (uint8_t)(1U << (bit % 8U));
            flips--;
        }
    }
    for (unsigned i = 0; i < length; i++) {
        bytes[i] ^= mask[i];
    }
}

/* What slips through. */

/** Ways to choose flips so far: by their number, by the CRC that they make, by the counter's flipped bits. */
typedef double ways[FLIPS_MAX + 1][CRC_VALUES][COUNTERS];

/** What a flip of this bit adds to the difference of the CRCs, expected and sent. */
static uint8_t syndrome(const struct kind *kind, unsigned byte, unsigned bit)
{
    uint8_t zeros[BYTES_MAX + 1] = {0};
    uint8_t flipped[BYTES_MAX + 1] = {0};

    if (byte == 0U) {
        return (uint8_t)(1U << bit);
    }
    flipped[byte] = (uint8_t)(1U << bit);
    /* From byte 1 on, with the data id at the end. */
    return (uint8_t)(jp_e2e_crc(0, zeros + 1, kind->length) ^ jp_e2e_crc(0, flipped + 1, kind->length));
}

static void add_bit(ways all, uint8_t crc, unsigned counter)
{
    for (unsigned flips = FLIPS_MAX; flips > 0U; flips--) {
        for (unsigned c = 0; c < CRC_VALUES; c++) {
            for (unsigned n = 0; n < COUNTERS; n++) {
                all[flips][c][n] += all[flips - 1U][c ^ crc][n ^ counter];
            }
        }
    }
}

/** Of all differences of counters that a flip of these bits can make, the share that a receiver in step takes: all
 *  counters are equally frequent, and the message is the next one. */
static double share_in_window(unsigned flipped_bits)
{
    unsigned taken = 0;

    for (unsigned sent = 0; sent < COUNTERS; sent++) {
        const unsigned step = ((sent ^ flipped_bits) - sent + 1U) % COUNTERS;

        taken += step >= 1U && step <= JP_E2E_GAP_MAX + 1U ? 1U : 0U;
    }
    return (double)taken / COUNTERS;
}

static double binomial(unsigned n, unsigned k)
{
    return round(exp(lgamma(n + 1.0) - lgamma(k + 1.0) - lgamma(n - k + 1.0)));
}

/** Probability that a message with so many flips, equally likely anywhere, is taken. */
static void predict(const struct kind *kind, double taken[FLIPS_MAX + 1])
{
    static ways all;

    memset(all, 0, sizeof all);
    all[0][0][0] = 1;
    for (unsigned byte = 0; byte < kind->length; byte++) {
        for (unsigned bit = 0; bit < 8U; bit++) {
            const bool counts = byte == COUNTER_BYTE && bit < COUNTER_BITS;

            add_bit(all, syndrome(kind, byte, bit), counts ? 1U << bit : 0U);
        }
    }
    for (unsigned flips = 1; flips <= FLIPS_MAX; flips++) {
        double words = 0;

        for (unsigned n = 0; n < COUNTERS; n++) {
            words += all[flips][0][n] * share_in_window(n);
        }
        taken[flips] = words / binomial(8U * kind->length, flips);
    }
}

/* Single messages. */

struct tally {
    unsigned long sent;
    unsigned long taken;
    double expected;
    double variance;
};

static void add(struct tally *tally, bool taken, double probability)
{
    tally->sent++;
    tally->taken += taken ? 1U : 0U;
    tally->expected += probability;
    tally->variance += probability * (1 - probability);
}

/** One sound message, so that the receiver is in step, then one with flipped bits. Each is different from what was
 *  sent: it is taken or not. */
static bool is_taken(const struct kind *kind, uint8_t *counter, unsigned flips)
{
    struct jp_e2e_receiver receiver = {.counter = *counter, .synchronised = true};
    struct message message;

    draw_message(kind, counter, &message);
    flip(message.bytes, kind->length, flips);
    return check_message(&receiver, kind, &message) == JP_E2E_OK;
}

static void bench_messages(struct tally commands[FLIPS_MAX + 1], struct tally samples[FLIPS_MAX + 1])
{
    static double taken[KINDS][FLIPS_MAX + 1];
    uint8_t counters[KINDS] = {0};

    for (unsigned i = 0; i < KINDS; i++) {
        predict(&kinds[i], taken[i]);
    }
    for (unsigned i = 0; i < FRAMES; i++) {
        const unsigned kind = i % KINDS;
        const unsigned flips = 1U + below(FLIPS_MAX);

        struct tally *tallies = kinds[kind].data_id == JP_DATA_ID_SAMPLE ? samples : commands;

        add(&tallies[flips], is_taken(&kinds[kind], &counters[kind], flips), taken[kind][flips]);
        if (i % PROGRESS_STEP == 0U) {
            progress_show("flipped bits", i, FRAMES);
        }
    }
    progress_end();
}

/* Whole routes. */

struct upload {
    struct jp_route_message route;
    struct jp_can_frame frames[1 + JP_ROUTE_LENGTH_MAX]; /**< the offer, then the waypoints */
};

static void put(struct jp_can_frame *frame, unsigned first, uint64_t value)
{
    for (unsigned i = first / 8U; i < JP_CAN_LENGTH_MAX; i++) {
        frame->data[i] |= (uint8_t)(8U * i >= first ? value >> (8U * i - first) : value << (first - 8U * i));
    }
}

#define POINT_MASK ((1U << 26) - 1U)

static struct jp_point draw_point(void)
{
    return (struct jp_point){(int32_t)below(POINT_MASK) - (1 << 25), (int32_t)below(POINT_MASK) - (1 << 25)};
}

static void draw_upload(struct upload *upload)
{
    uint8_t offers = (uint8_t)below(COUNTERS);
    uint8_t waypoints = (uint8_t)below(COUNTERS);
    uint32_t crc = JP_ROUTE_CRC_START;

    upload->route = (struct jp_route_message){.id = (uint8_t)(1U + below(255)), .length = (uint8_t)(1U + below(32))};
    for (unsigned i = 0; i < upload->route.length; i++) {
        struct jp_point *point = &upload->route.points[i];
        struct jp_can_frame *frame = &upload->frames[1U + i];

        *point = draw_point();
        crc = jp_route_crc(crc, point);
        *frame = (struct jp_can_frame){.length = JP_CAN_LENGTH_MAX};
        put(frame, 12, (uint64_t)((uint32_t)point->y & POINT_MASK) << 26 | ((uint32_t)point->x & POINT_MASK));
        jp_e2e_protect(&waypoints, JP_DATA_ID_WAYPOINT, frame->data, frame->length);
    }
    upload->frames[0] = (struct jp_can_frame){.length = JP_CAN_LENGTH_MAX};
    put(&upload->frames[0], 16, (uint64_t)crc << 16 | (uint64_t)upload->route.length << 8 | upload->route.id);
    jp_e2e_protect(&offers, JP_DATA_ID_ROUTE_OFFER, upload->frames[0].data, JP_CAN_LENGTH_MAX);
}

static void flip_upload(struct upload *upload, unsigned flips)
{
    uint8_t mask[1 + JP_ROUTE_LENGTH_MAX][JP_CAN_LENGTH_MAX] = {{0}};

    while (flips > 0U) {
        const uint32_t frame = below(1U + upload->route.length);
        const uint32_t bit = below(8U * JP_CAN_LENGTH_MAX);
        uint8_t *byte = &mask[frame][bit / 8U];

        if ((*byte >> (bit % 8U) & 1U) == 0U) {
            *byte |= (uint8_t)(1U << (bit % 8U));
            upload->frames[frame].data[bit / 8U] ^= (uint8_t)(1U << (bit % 8U));
            flips--;
        }
    }
}

static void receive(struct jp_route_link *link, const struct upload *upload)
{
    jp_route_link_start(link, 1000);
    (void)jp_route_link_accept_offer(link, &upload->frames[0]);
    for (unsigned i = 1; i <= upload->route.length; i++) {
        (void)jp_route_link_accept_waypoint(link, &upload->frames[i]);
    }
}

static bool is_same(const struct jp_route_message *a, const struct jp_route_message *b)
{
    return a->id == b->id && a->length == b->length &&
           memcmp(a->points, b->points, a->length * sizeof a->points[0]) == 0;
}

/** Routes that were taken although they are not what was sent. */
static unsigned long bench_routes(void)
{
    static struct jp_route_link link;
    static struct upload upload;
    unsigned long wrong = 0;

    for (unsigned i = 0; i < ROUTES; i++) {
        draw_upload(&upload);
        receive(&link, &upload);
        if (link.state != JP_ROUTE_READY || !is_same(&link.offered, &upload.route)) {
            fail("a sound route was refused");
        }
        flip_upload(&upload, 1U + below(FLIPS_MAX));
        receive(&link, &upload);
        wrong += link.state == JP_ROUTE_READY && !is_same(&link.offered, &upload.route) ? 1U : 0U;
        if (i % PROGRESS_STEP == 0U) {
            progress_show("routes", i, ROUTES);
        }
    }
    progress_end();
    return wrong;
}

/* Figures. */

static void sum(struct tally *total, const struct tally *tally)
{
    total->sent += tally->sent;
    total->taken += tally->taken;
    total->expected += tally->expected;
    total->variance += tally->variance;
}

/** By the number of flips: on stderr, for whoever wonders. */
static void print_tallies(const char *name, const struct tally tallies[FLIPS_MAX + 1])
{
    (void)fprintf(stderr, "%-8s %10s %10s %10s %10s\n", name, "sent", "taken", "expected", "deviation");
    for (unsigned flips = 1; flips <= FLIPS_MAX; flips++) {
        const struct tally *tally = &tallies[flips];

        (void)fprintf(stderr, "%-8u %10lu %10lu %10.1f %10.1f\n", flips, tally->sent, tally->taken, tally->expected,
                      sqrt(tally->variance));
    }
}

static double percent(const struct tally *tally)
{
    return 100.0 * (double)tally->taken / (double)tally->sent;
}

/** Of what is expected to slip through, with room for chance. */
static void add_against_expected(json_t *figures, const char *name, const struct tally *tally)
{
    figures_add(figures, COMMAND, (double)tally->taken / tally->expected, "",
                at_most(1 + DEVIATIONS * sqrt(tally->variance) / tally->expected), "%s", name);
}

static json_t *figures_of(const struct tally commands[FLIPS_MAX + 1], const struct tally samples[FLIPS_MAX + 1],
                          unsigned long wrong_routes)
{
    const double residual_rate = 100.0 / CRC_VALUES;
    json_t *figures = json_array();
    struct tally few = {0};
    struct tally many = {0};
    struct tally all_samples = {0};

    for (unsigned flips = 1; flips <= FLIPS_MAX; flips++) {
        sum(flips <= FLIPS_FOUND ? &few : &many, &commands[flips]);
        sum(&all_samples, &samples[flips]);
    }
    figures_add(figures, COMMAND, (double)few.taken, "", equal_to(0),
                "bit flips, 1…3 in a command frame: taken as another command");
    figures_add(figures, COMMAND, percent(&many), "%", at_most(residual_rate),
                "bit flips, 4…16 in a command frame: taken as another command");
    add_against_expected(figures, "bit flips, 4…16 in a command frame: taken, of what the CRC's codewords let through",
                         &many);
    figures_add(figures, COMMAND, percent(&all_samples), "%", at_most(residual_rate),
                "bit flips, 1…16 in the three frames of a sample: taken as another sample");
    add_against_expected(figures, "bit flips, 1…16 in a sample: taken, of what the CRC's codewords let through",
                         &all_samples);
    figures_add(figures, COMMAND, (double)wrong_routes, "", equal_to(0),
                "bit flips, 1…16 in the frames of a route, 1 000 000 routes: taken as another route");
    return figures;
}

int main(void)
{
    static struct tally commands[FLIPS_MAX + 1];
    static struct tally samples[FLIPS_MAX + 1];

    random_state = SEED;
    bench_messages(commands, samples);
    print_tallies("command", commands);
    print_tallies("sample", samples);
    figures_print(figures_of(commands, samples, bench_routes()));
    return 0;
}
