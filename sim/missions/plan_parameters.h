/**
 * Parameters that a robot has learned, as a JSON file, and the lattice charged by them.
 *
 * Measured factors (joulepath/tariff.h), for any robot; mass is 1 unless given:
 *   {"robot": "zhang2018", "version": 3, "straight": 1.1, "turning": 2.0, "mass": 1.0}
 * or, for a robot with an energy model, its a1…a13 and b1, b2 (joulepath/energy.h):
 *   {"robot": "gao2018", "version": 3, "a": [...], "b": [...], "mass": 1.0}
 */
#ifndef JOULEPATH_SIM_MISSIONS_PLAN_PARAMETERS_H
#define JOULEPATH_SIM_MISSIONS_PLAN_PARAMETERS_H

#include <joulepath/tariff.h>

#include "sim/lattice/lattice_robot.h"

/** Charges the robot's lattice by a file: tariff->lattice is to be planned on until plan_parameters_free(), also after
 * a failure. False after one line on stderr. */
bool plan_parameters_load(const char *path, const struct lattice_robot *robot, const struct jp_lattice *lattice,
                          struct jp_tariff *tariff);

void plan_parameters_free(struct jp_tariff *tariff);

#endif
