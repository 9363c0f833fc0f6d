/**
 * An energy model as a JSON file: the fields of struct jp_energy_model by their names, in the units of
 * joulepath/energy.h.
 *
 *   {"a": [13 numbers], "b": [2 numbers], "electronics_power": 6, "settling_time": 5.4, "voltage_per_speed": 8.35,
 *    "voltage_per_turn_rate": 1.46, "motor_resistance": 6.69}
 */
#ifndef JOULEPATH_SIM_FILES_MODEL_FILE_H
#define JOULEPATH_SIM_FILES_MODEL_FILE_H

#include <jansson.h>
#include <joulepath/energy.h>
#include <stdbool.h>

/** Reads and checks a model. False after one line on stderr: file, key, what, what to do. */
bool model_file_load(const char *path, struct jp_energy_model *model);

/** What such a file holds; the caller's reference. */
json_t *model_file_json(const struct jp_energy_model *model);

#endif
