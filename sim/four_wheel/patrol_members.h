/** The configurations that sim/four_wheel/patrol_config.h makes, member by member: to show, to make tables of and to
 * compare. */
#ifndef JOULEPATH_SIM_FOUR_WHEEL_PATROL_MEMBERS_H
#define JOULEPATH_SIM_FOUR_WHEEL_PATROL_MEMBERS_H

#include <stddef.h>

enum patrol_format {
    PATROL_FLOAT,
    PATROL_Q16,
    PATROL_Q24,
    PATROL_Q32,   /**< int32_t, 2⁻³² of the unit */
    PATROL_ANGLE, /**< int32_t, 2⁻³² turn */
    PATROL_WHOLE, /**< uint8_t, uint16_t or uint32_t */
    PATROL_FLAG,
    PATROL_FORMATS
};

/** "float", "q24" and so on. */
extern const char *const patrol_format_names[PATROL_FORMATS];

struct patrol_member {
    const char *key; /**< its name in C, with those of the structs that it is in: teb.weights.path */
    size_t offset;   /**< in the configuration */
    size_t size;
    enum patrol_format format;
    const char *unit; /**< of patrol_member_quantity() */
};

/** Of struct jp_patrol_config, in its order. */
extern const struct patrol_member patrol_members[];
extern const size_t patrol_member_count;

/** Of struct jp_pure_pursuit_config, in its order. */
extern const struct patrol_member patrol_pursuit_members[];
extern const size_t patrol_pursuit_member_count;

/** Of struct jp_localiser_config, in its order, but for the map; of struct jp_patrol_scanner; and of struct
 * jp_four_wheel_robot_config. */
extern const struct patrol_member patrol_localiser_members[];
extern const size_t patrol_localiser_member_count;
extern const struct patrol_member patrol_scanner_members[];
extern const size_t patrol_scanner_member_count;
extern const struct patrol_member patrol_robot_members[];
extern const size_t patrol_robot_member_count;

/** As it is stored; exact. */
double patrol_member_value(const void *config, const struct patrol_member *member);

/** In its unit. */
double patrol_member_quantity(const void *config, const struct patrol_member *member);

#endif
