/** The robot that the image is for: `make firmware ROBOT=name`. */
#ifndef JOULEPATH_HAL_STM32F4_FIRMWARE_ROBOT_H
#define JOULEPATH_HAL_STM32F4_FIRMWARE_ROBOT_H

#include <joulepath/learner.h>
#include <joulepath/robot.h>
#include <joulepath/tables.h>

#ifndef FIRMWARE_ROBOT_NAME
#error "FIRMWARE_ROBOT_NAME is set by the Makefile"
#endif

#define ROBOT_JOIN(prefix, name)   prefix##name
#define ROBOT_SYMBOL(prefix, name) ROBOT_JOIN(prefix, name)
#define FIRMWARE_ROBOT             ROBOT_SYMBOL(jp_robot_, FIRMWARE_ROBOT_NAME)
#define FIRMWARE_ENERGY_MODEL      ROBOT_SYMBOL(jp_energy_model_, FIRMWARE_ROBOT_NAME)

/** It learns if there are tables of the robot: the Makefile says so. */
#ifdef FIRMWARE_LEARNS
#define FIRMWARE_LEARNING ROBOT_SYMBOL(jp_learning_, FIRMWARE_ROBOT_NAME)
#endif

/** It finds its way if there are tables for that: likewise. */
#ifdef FIRMWARE_NAVIGATES
#define FIRMWARE_LATTICE    ROBOT_SYMBOL(jp_lattice_, FIRMWARE_ROBOT_NAME)
#define FIRMWARE_NAVIGATION ROBOT_SYMBOL(jp_navigation_, FIRMWARE_ROBOT_NAME)
#endif

#endif
