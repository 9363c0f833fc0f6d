/**
 * Between the structs of the library and the frames of joulepath.dbc, with their end-to-end protection.
 *
 * A sample is what struct jp_sensors holds, in three frames; values beyond a signal's range saturate. Constant time.
 */
#ifndef JOULEPATH_HAL_CAN_MESSAGES_H
#define JOULEPATH_HAL_CAN_MESSAGES_H

#include <joulepath/e2e.h>
#include <joulepath/segment.h>
#include <joulepath/sensors.h>

#include "hal/can/can.h"

#ifdef __cplusplus
extern "C" {
#endif

/** E2EDataId of joulepath.dbc. */
enum jp_data_id {
    JP_DATA_ID_MOTOR_COMMAND = 0x4D,
    JP_DATA_ID_SAMPLE = 0x53,
    JP_DATA_ID_OPERATOR_COMMAND = 0x4F,
    JP_DATA_ID_ROUTE_OFFER = 0x52,
    JP_DATA_ID_WAYPOINT = 0x57,
    JP_DATA_ID_GOAL = 0x47,
    JP_DATA_ID_MAP_OFFER = 0x41,
    JP_DATA_ID_MAP_DATA = 0x44,
    JP_DATA_ID_CELL_CHANGES = 0x43,
    JP_DATA_ID_MAP_GOAL = 0x4E,
    JP_DATA_ID_WHEEL_TARGET = 0x54,
    JP_DATA_ID_WHEEL_FEEDBACK = 0x46,
    JP_DATA_ID_SUPPLY_SENSORS = 0x55,
    JP_DATA_ID_SCAN_BEGIN = 0x42,
    JP_DATA_ID_SCAN_END = 0x45,
    JP_DATA_ID_BATTERY_CHARGE = 0x48,
    JP_DATA_ID_ROUND_OFFER = 0x50,
    JP_DATA_ID_ROUND_DATA = 0x51
};

/** Frames of a sample, in the order in which they are sent. */
enum jp_sample_part { JP_SAMPLE_WHEELS, JP_SAMPLE_BALANCE, JP_SAMPLE_CURRENTS, JP_SAMPLE_PARTS };

/** Bits of the encoder counts that a sample carries. */
#define JP_SAMPLE_COUNT_BITS 22U

/** Energies of SegmentResult are in Q16 of 2⁴ J. */
#define JP_SEGMENT_RESULT_EXPONENT 4

/** MotorCommand. */
void jp_message_from_actuation(struct jp_can_frame *frame, uint8_t *counter, const struct jp_actuation *actuation);

/** *actuation is written only with JP_E2E_OK. */
enum jp_e2e_result jp_message_to_actuation(struct jp_e2e_receiver *receiver, const struct jp_can_frame *frame,
                                           struct jp_actuation *actuation);

/** WheelSensors, BalanceSensors, CurrentSensors. */
void jp_message_from_sensors(struct jp_can_frame frames[JP_SAMPLE_PARTS], uint8_t *counter,
                             const struct jp_sensors *sensors);

/** *sensors is written only with JP_E2E_OK; its encoder counts are those nearest to what stands there. */
enum jp_e2e_result jp_message_to_sensors(struct jp_e2e_receiver *receiver,
                                         const struct jp_can_frame frames[JP_SAMPLE_PARTS], struct jp_sensors *sensors);

/** What RouteCrc of an empty route is, and goes on with one more waypoint: CRC-32 as in zlib. 16 table look-ups. */
#define JP_ROUTE_CRC_START 0U
uint32_t jp_route_crc(uint32_t crc, const struct jp_point *waypoint);

#ifdef __cplusplus
}
#endif

#endif
