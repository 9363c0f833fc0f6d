/** Result of every call that can fail: 0 is ok, a positive value is progress, a negative one a failure; each has one
 *  meaning. */
#ifndef JOULEPATH_STATUS_H
#define JOULEPATH_STATUS_H

enum jp_status {
    JP_OK = 0,
    JP_WORKING = 1,          /**< there is more to do: call again */
    JP_ARRIVED = 2,          /**< at the end of the path: there is nothing more to do */
    JP_HELD = 3,             /**< nothing was measured in this tick: the last measurement goes on */
    JP_ERR_ARGUMENT = -1,    /**< a pointer is null or an argument is outside its stated range */
    JP_ERR_CONFIG = -2,      /**< a configuration field is outside its range; the call names the field */
    JP_ERR_INFEASIBLE = -3,  /**< no motion satisfies every limit */
    JP_ERR_ZERO_LENGTH = -4, /**< start and target coincide: there is no segment to drive */
    JP_ERR_MODEL = -5,       /**< the energy model's least energy is not above 0: its parameters are not physical */
    JP_ERR_OVERFLOW = -6,    /**< the result does not fit its format; the saturated value is stored */
    JP_ERR_STATE = -7,       /**< not allowed in the present state */
    JP_ERR_BUSY = -8,        /**< an earlier command still waits to start */
    JP_ERR_HARDWARE = -9,    /**< the HAL could not read or write */
    JP_ERR_MEMORY = -10,     /**< the memory handed in is too small */
    JP_ERR_ALIGNMENT = -11,  /**< the memory handed in is not aligned to 8 bytes */
    JP_ERR_OUTSIDE = -12,    /**< a cell is outside the map */
    JP_ERR_BLOCKED = -13,    /**< the robot's footprint does not fit there */
    JP_ERR_UNRELIABLE = -14, /**< too much of what a sensor read is missing */
    JP_ERR_NO_PLAN = -15,    /**< there is no path or plan to give */
    JP_ERR_EMPTY = -16       /**< nothing is stored there */
};

#endif
