/** The pieces (four_wheel_energy.h) that a robot with four steered wheels has driven, by its encoders: for the learner,
 *  and for identification. Integers; for the control tick. */
#ifndef JOULEPATH_FOUR_WHEEL_TRIP_H
#define JOULEPATH_FOUR_WHEEL_TRIP_H

#include <joulepath/four_wheel.h>
#include <joulepath/four_wheel_energy.h>

#ifdef __cplusplus
extern "C" {
#endif

struct jp_four_wheel_trip_config {
    struct jp_four_wheel_config wheels; /**< passed its check */
    uint32_t tick_rate;                 /**< 1/s; 10…10 000 */
    uint16_t piece_ticks;               /**< of a piece; 1…1 000, at most 25 s */
};

/** Private. */
struct jp_four_wheel_trip {
    struct jp_four_wheel_trip_config config;
    struct jp_twist start; /**< at the start of the piece */
    struct jp_twist now;
    struct jp_wheels wheels; /**< of the last tick */
    bool is_begun;
    uint16_t ticks;  /**< of the piece */
    uint64_t travel; /**< of steering, 2⁻³² turn */
    int64_t grade;   /**< sums */
    int64_t bank;
};

/** Starts with no piece. JP_ERR_CONFIG: *field names the first field out of range. JP_ERR_ARGUMENT: a pointer is null.
 */
enum jp_status jp_four_wheel_trip_init(struct jp_four_wheel_trip *trip, const struct jp_four_wheel_trip_config *config,
                                       const char **field);

/** One tick at these wheels, as the encoders say, on this slope (0: level, or not known). True: a piece is complete.
 *  The first tick only says how it starts. Pointers are not checked. Work: that of jp_four_wheel_forward(), and two
 *  divisions. */
bool jp_four_wheel_trip_tick(struct jp_four_wheel_trip *trip, const struct jp_wheels *wheels, jp_q24 grade, jp_q24 bank,
                             struct jp_four_wheel_piece *piece);

/** Ends the piece that was begun; the next starts here. False: there is none. */
bool jp_four_wheel_trip_end(struct jp_four_wheel_trip *trip, struct jp_four_wheel_piece *piece);

#ifdef __cplusplus
}
#endif

#endif
