/** The robot that the image is for: `make firmware ROBOT=name`. Of its kind is firmware_balancer.c,
 *  firmware_skid.c or firmware_patrol.c. */
#ifndef JOULEPATH_HAL_FIRMWARE_FIRMWARE_ROBOT_H
#define JOULEPATH_HAL_FIRMWARE_FIRMWARE_ROBOT_H

#include <joulepath/tables.h>

#include "hal/app/ecu.h"
#include "hal/app/navigation_memory.h"

#ifndef FIRMWARE_ROBOT_NAME
#error "FIRMWARE_ROBOT_NAME is set by the Makefile"
#endif

/* FIRMWARE_SKID_NAME is the same name, for tools that read the files of both kinds. FIRMWARE_LATTICE_NAME is, too,
 * unless the robot finds its way on a lattice of its own. */

#define ROBOT_JOIN(prefix, name)   prefix##name
#define ROBOT_SYMBOL(prefix, name) ROBOT_JOIN(prefix, name)

/** It finds its way if there are tables for that: the Makefile says so. */
#ifdef FIRMWARE_NAVIGATES
#define FIRMWARE_LATTICE    ROBOT_SYMBOL(jp_lattice_, FIRMWARE_LATTICE_NAME)
#define FIRMWARE_NAVIGATION ROBOT_SYMBOL(jp_navigation_, FIRMWARE_ROBOT_NAME)
#endif

/** What a start has besides the robot's tables. */
struct jp_firmware_start {
    const struct jp_can_port *port;
    struct jp_retained *retained;
    const struct jp_parameters *parameters;
    enum jp_stored stored;            /**< what was found of them */
    struct jp_navigation *navigation; /**< NULL: it has none */
    const struct jp_navigation_config *navigation_config;
};

/** Prepares robot and application. Tables of learning, cells or navigation that are refused do not keep the robot
 *  from driving. As jp_robot_init(). */
enum jp_status jp_firmware_boot(struct jp_ecu *ecu, const struct jp_firmware_start *start, const char **field);

/** Of its control interrupt, Hz. */
uint32_t jp_firmware_tick_rate(void);

/** Of the record of parameters that is the robot's. */
uint32_t jp_firmware_identity(void);

/** After a boot, before the first tick: a bias that was learned earlier, 2⁻⁵⁶ turn/s. */
void jp_firmware_know_gyro_bias(int64_t bias);

/** As learned now. */
int64_t jp_firmware_gyro_bias(void);
struct jp_gyro_scale jp_firmware_gyro_scale(void);

#endif
