/** Checks of one module's configuration, a static `config` of the including test. */
#ifndef TESTS_UNIT_CONFIG_CHECK_H
#define TESTS_UNIT_CONFIG_CHECK_H

#include <joulepath/robot.h>

#include "unity.h"

extern const struct jp_robot_config jp_robot_courier24;

static inline void expect_status(enum jp_status status, const char *field, const char *expected)
{
    if (expected == NULL) {
        TEST_ASSERT_EQUAL_INT(JP_OK, status);
        TEST_ASSERT_NULL(field);
    } else {
        TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, status);
        TEST_ASSERT_EQUAL_STRING(expected, field);
    }
}

/** Defines expect_config(): the check of `module` names the field `expected`, or none if it is NULL; then `config` is
 *  courier24's again. */
#define DEFINE_EXPECT_CONFIG(module)                                                                                   \
    static void expect_config(const char *expected)                                                                    \
    {                                                                                                                  \
        const char *field = "";                                                                                        \
        enum jp_status status = jp_##module##_check(&config, &field);                                                  \
        expect_status(status, field, expected);                                                                        \
        config = jp_robot_courier24.module;                                                                            \
    }

/** With this value of one field. */
#define FIELD(member, value, expected)                                                                                 \
    do {                                                                                                               \
        config.member = (value);                                                                                       \
        expect_config(expected);                                                                                       \
    } while (0)

#endif
