/* A tick that comes while a command is handed over: it finds the whole of one, or none. */
#include "src/base/request.h"

static void post(uint8_t *flag, uint8_t value);

#define jp_post post
#define wake    wake_robot
#include "src/skid_steer/skid_robot.c"
#undef wake
#undef jp_post
#include "tests/support/skid_robot_rig.h"

static uint8_t values[4];
static unsigned count;

static void post(uint8_t *flag, uint8_t value)
{
    jp_post(flag, value);
    if (flag == &robot.internal.next_full && count < sizeof values) {
        values[count] = value;
        count++;
    }
}

/* What waits is withdrawn before another one takes its place. */
static void expect_withdrawn_first(void)
{
    TEST_ASSERT_EQUAL_UINT(2, count);
    TEST_ASSERT_EQUAL_UINT8(0, values[0]);
    TEST_ASSERT_TRUE(values[1] != 0U);
}

static void test_a_command_that_waits_is_withdrawn_first(void)
{
    make_standing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &one_second));
    count = 0;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &one_second));
    expect_withdrawn_first();
}

static void test_a_path_takes_the_place_of_a_command_alike(void)
{
    static struct jp_path_piece pieces[1];
    const struct jp_lattice_path path = {.pieces = pieces, .places = 1, .count = 1};

    make_standing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &one_second));
    count = 0;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_follow(&robot, &path));
    expect_withdrawn_first();
}
