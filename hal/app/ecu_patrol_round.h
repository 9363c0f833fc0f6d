/**
 * Hours of patrol of a robot with four steered wheels on CAN: takes a round between places of its map in frames, drives
 * it while the operator says so (patrol_round.h), and tells how it goes. Whatever the operator commands ends it.
 *
 * What the battery holds its charger or its management tells in BatteryCharge; from then on the robot's own meter of
 * the bus counts what leaves it. All of it runs in the background.
 */
#ifndef JOULEPATH_HAL_APP_ECU_PATROL_ROUND_H
#define JOULEPATH_HAL_APP_ECU_PATROL_ROUND_H

#include <joulepath/patrol_round.h>

#include "hal/app/ecu_patrol_way.h"
#include "hal/can/round_link.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Values of State in RoundStatus. */
enum jp_round_told {
    JP_ROUND_TOLD_NONE,
    JP_ROUND_TOLD_RECEIVING,
    JP_ROUND_TOLD_REJECTED,
    JP_ROUND_TOLD_READY,
    JP_ROUND_TOLD_SURVEYING,
    JP_ROUND_TOLD_CHARGING,
    JP_ROUND_TOLD_LEAVING,
    JP_ROUND_TOLD_DWELLING,
    JP_ROUND_TOLD_HOMING,
    JP_ROUND_TOLD_WAITING,
    JP_ROUND_TOLD_FAILED,
    JP_ROUND_TOLD_STOPPED
};

/** As told, of a round that is driven. */
enum jp_round_told jp_round_told_of(enum jp_patrol_round_state state);
enum jp_round_reason jp_round_reason_of(enum jp_patrol_round_reason reason);

/** The caller's memory; the members are private. */
struct jp_ecu_patrol_round {
    struct jp_ecu_patrol *patrol;
    struct jp_wayfinder way; /* to single goals */
    struct jp_round_link link;
    struct jp_patrol_round_config config;                         /* of the round that is whole */
    struct jp_patrol_round round;                                 /* all zero before it has begun */
    enum { JP_ROUND_WAITS, JP_ROUND_RUNS, JP_ROUND_ENDED } phase; /* of the round that is whole */
    bool has_failed;                                              /* else it was stopped */
    enum jp_round_reason reason;
    uint16_t stop;       /* of the reason */
    uint32_t tick;       /* of the last slice of the round */
    bool knows_charge;   /* BatteryCharge has come */
    bool is_charge_new;  /* it is not in the account yet */
    uint32_t charge;     /* that was told last, 2⁻⁴ J */
    jp_energy full_then; /* what the battery holds and what has left it, together */
    jp_energy held;
};

/** Finds its way on maps and goes round, for jp_navigation_init_with(); both must stay. */
struct jp_wayfinder jp_ecu_patrol_round_wayfinder(struct jp_ecu_patrol_round *round, struct jp_ecu_patrol *patrol);

#ifdef __cplusplus
}
#endif

#endif
