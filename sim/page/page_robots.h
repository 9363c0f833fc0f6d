/** The robots of the page: constants of their files, which sim/page/robot_bytes.c writes down when the page is made. */
#ifndef JOULEPATH_SIM_PAGE_PAGE_ROBOTS_H
#define JOULEPATH_SIM_PAGE_PAGE_ROBOTS_H

#include <stddef.h>

#include "sim/balancer/robot_constants.h"
#include "sim/four_wheel/four_wheel_constants.h"
#include "sim/skid_steer/skid_steer_model.h"

extern const struct robot_file *const page_balancers[];
extern const size_t page_balancer_count;

extern const struct skid_steer_model *const page_skid_robots[];
extern const size_t page_skid_robot_count;

extern const struct four_wheel_file *const page_patrol_robots[];
extern const size_t page_patrol_robot_count;

/* In the same order: the steepest ground on which each may be, rise over run (lattice_robot.h). */
extern const double page_balancer_grades[];
extern const double page_skid_robot_grades[];

#endif
