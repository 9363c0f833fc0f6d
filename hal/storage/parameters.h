/**
 * What a robot learns and calibrates, kept over power-off: a record of fixed bytes, little-endian, in a store.
 *
 * It belongs to one robot under one controller, whose identity is in it: jp_robot_identity(). All calls are for
 * the background loop.
 */
#ifndef JOULEPATH_HAL_STORAGE_PARAMETERS_H
#define JOULEPATH_HAL_STORAGE_PARAMETERS_H

#include <joulepath/four_wheel_robot.h>
#include <joulepath/learner.h>
#include <joulepath/robot.h>
#include <joulepath/skid_robot.h>

#include "hal/storage/store.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Of the record's format; one more with every change of it. */
#define JP_PARAMETERS_VERSION 3U

/** Bytes of the record: version, robot, 23 numbers of what was learned about energy, gyro bias, 2 zeros of currents,
 *  scale of the gyro and its deviation. */
#define JP_PARAMETERS_LENGTH (4U + 4U + 4U * 23U + 8U + 2U * 2U + 4U * 2U)

/** A gyro with more bias is broken: 0.05 turn/s (18 °/s), in 2⁻⁵⁶ turn/s. */
#define JP_PARAMETERS_GYRO_BIAS_MAX ((int64_t)JP_Q24(0.05) * ((int64_t)1 << 32))

struct jp_parameters {
    struct jp_learned_state energy;  /**< what was learned of the energy model that is built in */
    int64_t gyro_bias;               /**< as in struct jp_estimator, 2⁻⁵⁶ turn/s; ±JP_PARAMETERS_GYRO_BIAS_MAX */
    uint16_t current_zero_left;      /**< the converter's reading without current, counts; 0: not calibrated */
    uint16_t current_zero_right;     /**< counts */
    struct jp_gyro_scale gyro_scale; /**< of a robot that its sides steer */
};

/** What a start found of stored parameters. */
enum jp_stored {
    JP_STORED_NOTHING,       /**< nothing was stored */
    JP_STORED_TAKEN,         /**< they are in use; these do not fit and are not: */
    JP_STORED_OTHER_VERSION, /**< of another format of the record */
    JP_STORED_OTHER_ROBOT,   /**< of another robot or controller */
    JP_STORED_OTHER_TABLES,  /**< learned with other tables: jp_learning.identity */
    JP_STORED_DAMAGED        /**< of a wrong length, or a field is out of range */
};

/** CRC-32 over name and all fields of the configuration: the same on every core. About 190 bytes. */
uint32_t jp_robot_identity(const struct jp_robot_config *config);

/** The same of a skid-steered or differential-drive robot. */
uint32_t jp_skid_robot_identity(const struct jp_skid_robot_config *config);

/** The same of a robot with four steered wheels. */
uint32_t jp_four_wheel_robot_identity(const struct jp_four_wheel_robot_config *config);

/** Nothing learned of energy, no bias, currents not calibrated, and nothing known of the gyro's scale. */
void jp_parameters_default(struct jp_parameters *parameters);

/**
 * Checks every field, but whether the zeros suit the board, which knows it, and whether the energy was learned with the
 * learning that is built in: jp_learner_restore() does. JP_ERR_CONFIG: *field names the first one out of range.
 * JP_ERR_ARGUMENT: a pointer is null.
 */
enum jp_status jp_parameters_check(const struct jp_parameters *parameters, const char **field);

/** Whether they are worth a write: anything learned since, a bias that is 0.0001 turn/s (0.036 °/s) off, a zero that is
 *  4 counts off, or a scale or its deviation that is 0.0005 off. */
bool jp_parameters_differ(const struct jp_parameters *a, const struct jp_parameters *b);

void jp_parameters_encode(const struct jp_parameters *parameters, uint32_t identity,
                          uint8_t record[JP_PARAMETERS_LENGTH]);

/**
 * The parameters of a record. *parameters is written on JP_OK only. JP_ERR_CONFIG: *field says what does not fit:
 * "version" (another format), "length", "robot" (of another robot or controller), or the first field out of range.
 */
enum jp_status jp_parameters_decode(struct jp_parameters *parameters, uint32_t identity, const uint8_t *record,
                                    uint16_t length, const char **field);

/** The parameters to start with: those of the record, or defaults if they do not fit or `length` is 0, and which of
 *  them. Whether the tables are others the learner finds. */
enum jp_stored jp_parameters_start(struct jp_parameters *parameters, uint32_t identity, const uint8_t *record,
                                   uint16_t length);

/** Those of an open store. As jp_parameters_decode(), and JP_ERR_EMPTY: nothing is stored. */
enum jp_status jp_parameters_load(struct jp_parameters *parameters, uint32_t identity, const struct jp_store *store,
                                  const char **field);

/** Checks and stores them. As jp_parameters_check() and jp_store_write(). */
enum jp_status jp_parameters_save(const struct jp_parameters *parameters, uint32_t identity, struct jp_store *store,
                                  const char **field);

#ifdef __cplusplus
}
#endif

#endif
