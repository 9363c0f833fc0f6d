/**
 * Whoever commands the robot: listens to OperatorCommand and notices when it falls silent.
 *
 * Stand is obeyed at once. Off, Drive and Navigate are obeyed when JP_OPERATOR_CONFIRMATIONS of them follow each other
 * without a gap, so that no corrupt or late frame switches the motors off or sets the robot moving. After Off and after
 * a silence Drive and Navigate are obeyed only once a valid Stand has come.
 *
 * Anybody may stop the robot: a Stand whose counter does not follow that of the operator stops it, too, and Drive and
 * Navigate are then obeyed only when JP_OPERATOR_CONFIRMATIONS of them follow each other with no Stand of anybody
 * between them.
 */
#ifndef JOULEPATH_HAL_CAN_OPERATOR_LINK_H
#define JOULEPATH_HAL_CAN_OPERATOR_LINK_H

#include "hal/can/messages.h"

#ifdef __cplusplus
extern "C" {
#endif

#define JP_OPERATOR_CONFIRMATIONS 3U

/** Silence that counts as lost, ms; OperatorCommand is sent every 100 ms. */
#define JP_OPERATOR_TIMEOUT_MS 500U

/** Values of Mode in joulepath.dbc. */
enum jp_operator_mode { JP_MODE_OFF, JP_MODE_STAND, JP_MODE_DRIVE, JP_MODE_NAVIGATE };

/** Values of Operator in joulepath.dbc. */
enum jp_operator_state { JP_OPERATOR_NONE, JP_OPERATOR_ALIVE, JP_OPERATOR_LOST };

struct jp_operator_link {
    struct jp_e2e_receiver receiver;
    enum jp_operator_state state;
    enum jp_operator_mode mode; /**< obeyed now */
    uint8_t route;              /**< that Drive means, or goal that Navigate means */
    enum jp_operator_mode heard;
    uint8_t heard_route;
    uint8_t confirmations; /**< commands of this mode and route in a row, up to JP_OPERATOR_CONFIRMATIONS */
    uint32_t silence;      /**< ticks since the last valid command */
    uint32_t timeout;      /**< ticks */
};

enum jp_operator_result {
    JP_OPERATOR_OK, /**< obeyed, counted towards being obeyed, or the first */
    JP_OPERATOR_CRC,
    JP_OPERATOR_SEQUENCE, /**< repeated, late or out of order: nothing but a stop was obeyed */
    JP_OPERATOR_MALFORMED /**< a signal is out of range */
};

/** Nobody yet, mode off. tick_rate 100…10 000 Hz. */
void jp_operator_link_start(struct jp_operator_link *link, uint32_t tick_rate);

/** Takes an OperatorCommand of the right length. Constant time. */
enum jp_operator_result jp_operator_link_accept(struct jp_operator_link *link, const struct jp_can_frame *frame);

/** `ticks` have passed. True when the operator has just been lost: the mode is then stand, or stays off. */
bool jp_operator_link_pass(struct jp_operator_link *link, uint32_t ticks);

#ifdef __cplusplus
}
#endif

#endif
