/** Checks of one module's configuration, a static `config` of the including test. */
#ifndef JOULEPATH_TESTS_SUPPORT_CONFIG_CHECK_H
#define JOULEPATH_TESTS_SUPPORT_CONFIG_CHECK_H

#include <joulepath/robot.h>
#include <joulepath/tables.h>

#include "unity.h"

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

/** Defines expect_config(): the check of `module` names the field `expected`, or none if it is NULL, and refuses null
 *  pointers; then `config` is courier24's again. */
#define DEFINE_EXPECT_CONFIG(module)                                                                                   \
    static void expect_config(const char *expected)                                                                    \
    {                                                                                                                  \
        const char *field = "";                                                                                        \
        enum jp_status status = jp_##module##_check(&config, &field);                                                  \
        expect_status(status, field, expected);                                                                        \
        TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_##module##_check(NULL, &field));                                     \
        TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_##module##_check(&config, NULL));                                    \
        config = jp_robot_courier24.module;                                                                            \
    }

/** With this value of one field. */
#define FIELD(member, value, expected)                                                                                 \
    do {                                                                                                               \
        config.member = (value);                                                                                       \
        expect_config(expected);                                                                                       \
    } while (0)

#endif
