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

/** Defines expect_config(): `check` of the configuration names the field `expected`, or none if it is NULL, and refuses
 *  null pointers; then `config` is `usual` again. */
#define DEFINE_EXPECT_CONFIG_OF(check, usual)                                                                          \
    static void expect_config(const char *expected)                                                                    \
    {                                                                                                                  \
        const char *field = "";                                                                                        \
        enum jp_status status = check(&config, &field);                                                                \
        expect_status(status, field, expected);                                                                        \
        field = "untouched";                                                                                           \
        TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, check(NULL, &field));                                                   \
        TEST_ASSERT_EQUAL_STRING("untouched", field);                                                                  \
        TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, check(&config, NULL));                                                  \
        config = usual;                                                                                                \
    }

/** The same of a part of courier24. */
#define DEFINE_EXPECT_CONFIG(module) DEFINE_EXPECT_CONFIG_OF(jp_##module##_check, jp_robot_courier24.module)

/** With this value of one field. */
#define FIELD(member, value, expected)                                                                                 \
    do {                                                                                                               \
        config.member = (value);                                                                                       \
        expect_config(expected);                                                                                       \
    } while (0)

/** The least and the most that the field may be; its name follows `path`. */
#define AT_LEAST(path, member, low)                                                                                    \
    do {                                                                                                               \
        FIELD(member, (low)-1, path #member);                                                                          \
        FIELD(member, low, NULL);                                                                                      \
    } while (0)

#define AT_MOST(path, member, high)                                                                                    \
    do {                                                                                                               \
        FIELD(member, high, NULL);                                                                                     \
        FIELD(member, (high) + 1, path #member);                                                                       \
    } while (0)

#define RANGE(path, member, low, high)                                                                                 \
    do {                                                                                                               \
        AT_LEAST(path, member, low);                                                                                   \
        AT_MOST(path, member, high);                                                                                   \
    } while (0)

#endif
