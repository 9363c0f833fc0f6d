/** A round between places as bytes, as RoundData in joulepath.dbc tells it. Single-precision floating point. */
#ifndef JOULEPATH_HAL_CAN_ROUND_CODE_H
#define JOULEPATH_HAL_CAN_ROUND_CODE_H

#include <joulepath/patrol_round.h>

#include "hal/can/round_link.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Reads the bytes of 1…JP_ROUND_STOPS_MAX stops; the standing power stays 0. Work: the stops. */
void jp_round_decode(const uint8_t *bytes, uint8_t stops, struct jp_patrol_round_config *config);

/** Writes JP_ROUND_BYTES(config->stop_count) bytes of a round that jp_patrol_round_check() takes, rounded down to what
 *  the bytes hold; more than that is saturated. */
void jp_round_encode(const struct jp_patrol_round_config *config, uint8_t *bytes);

#ifdef __cplusplus
}
#endif

#endif
