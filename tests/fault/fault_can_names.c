/* Names of CAN links on a host: every one that cannot be opened, and what may stand where a pseudo-terminal is to be
 * linked to. */
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include "tests/support/can_links.h"

/* ---- Names that cannot be opened ---- */

static void check_refused(const char *name, const char *culprit)
{
    struct jp_can_link link;

    memset(error, 'x', sizeof error);
    TEST_ASSERT_FALSE_MESSAGE(jp_can_link_open(&link, name, error, sizeof error), name);
    TEST_ASSERT_TRUE_MESSAGE(memchr(error, '\0', sizeof error) != NULL, name);
    TEST_ASSERT_TRUE_MESSAGE(strchr(error, '\n') == NULL, error);
    TEST_ASSERT_TRUE_MESSAGE(strstr(error, culprit) != NULL, error);
}

static void test_names_of_no_kind(void)
{
    check_refused("", "can:<interface>");
    check_refused("vcan0", "vcan0: not a CAN bus");
    check_refused("CAN:vcan0", "not a CAN bus");
    check_refused("/dev/ttyACM0", "slcan:<serial line>");
}

static void test_empty_and_long_names(void)
{
    static const char *const prefixes[] = {"can:", "slcan:", "pty:"};
    char name[6000];

    for (size_t i = 0; i < sizeof prefixes / sizeof prefixes[0]; i++) {
        check_refused(prefixes[i], "characters; give one");
        memset(name, 'a', sizeof name - 1);
        name[sizeof name - 1] = '\0';
        memcpy(name, prefixes[i], strlen(prefixes[i]));
        check_refused(name, "characters; give one");
    }
    memset(name, 'a', sizeof name - 1);
    check_refused(name, "not a CAN bus");
    check_refused("can:sixteen_letters_", "1 to 15 characters");
}

static void test_serial_lines_that_are_none(void)
{
    check_refused("slcan:/nowhere/tty", "slcan:/nowhere/tty: cannot open this serial line: No such file");
    check_refused("slcan:/dev/null", "slcan:/dev/null: not a serial line");
    check_refused("slcan:/etc/passwd", "not a serial line");
    check_refused("slcan:/", "Is a directory");
}

/* What the kernel of this machine says; tests/vcan has the rest. */
static void test_interfaces_that_are_missing(void)
{
    const int can = socket(PF_CAN, SOCK_RAW, 1);

    if (can >= 0) {
        (void)close(can);
        check_refused("can:nowhere0", "ip link add dev nowhere0 type vcan; ip link set nowhere0 up");
    } else {
        check_refused("can:nowhere0", "tools/operate/with_vcan.sh");
    }
}

static void test_an_error_fits_whatever_room_there_is(void)
{
    struct jp_can_link link;

    for (unsigned size = 1; size < 40; size++) {
        char *room = malloc(size);

        TEST_ASSERT_FALSE(jp_can_link_open(&link, "slcan:/dev/null", room, size));
        TEST_ASSERT_EQUAL_UINT(size - 1, strlen(room));
        free(room);
    }
}

/* ---- The name of a pseudo-terminal ---- */

static void check_kept(const char *content)
{
    char found[16] = "";
    const int file = open(path, O_RDONLY);

    TEST_ASSERT_TRUE(file >= 0);
    TEST_ASSERT_TRUE(read(file, found, sizeof found - 1) == (ssize_t)strlen(content));
    TEST_ASSERT_EQUAL_STRING(content, found);
    (void)close(file);
}

static void make_file(const char *name)
{
    const int file = open(name, O_WRONLY | O_CREAT, 0600);

    TEST_ASSERT_TRUE(file >= 0 && write(file, "mine", 4) == 4 && close(file) == 0);
}

static void test_a_file_is_not_replaced(void)
{
    make_file(path);
    check_refused(pty_name, "there is something of that name; remove it");
    check_kept("mine");
}

static void test_a_folder_is_not_replaced(void)
{
    TEST_ASSERT_TRUE(mkdir(path, 0700) == 0);
    check_refused(pty_name, "there is something of that name");
    TEST_ASSERT_TRUE(rmdir(path) == 0);
}

static void test_a_link_to_something_is_not_replaced(void)
{
    char target[80];

    (void)snprintf(target, sizeof target, "%s/target", folder);
    make_file(target);
    TEST_ASSERT_TRUE(symlink(target, path) == 0);
    check_refused(pty_name, "there is something of that name");
    check_kept("mine");
    (void)unlink(target);
}

static void test_the_terminal_of_another_process_is_not_replaced(void)
{
    open_link(&adapter, pty_name);
    check_refused(pty_name, "there is something of that name");
    open_link(&host, slcan_name);
    await_state(&host, JP_CAN_ON);
    check_both_talk();
}

static void test_a_link_that_leads_nowhere_is_replaced(void)
{
    TEST_ASSERT_TRUE(symlink("/nowhere/pts", path) == 0);
    open_both();
    check_both_talk();
}

/* A killed process leaves its link, and the next terminal may get the same number. */
static void test_a_link_to_the_new_terminal_itself_is_replaced(void)
{
    char target[64];
    ssize_t length;

    open_link(&adapter, pty_name);
    length = readlink(path, target, sizeof target - 1);
    TEST_ASSERT_TRUE(length > 0);
    target[length] = '\0';
    close_link(&adapter);
    TEST_ASSERT_TRUE(symlink(target, path) == 0);
    open_both();
    check_both_talk();
}

static void test_a_name_that_was_taken_over_is_left_alone_at_the_close(void)
{
    open_link(&adapter, pty_name);
    TEST_ASSERT_TRUE(unlink(path) == 0);
    make_file(path);
    close_link(&adapter);
    check_kept("mine");
}

static void test_a_name_in_no_folder(void)
{
    check_refused("pty:/nowhere/ecu", "pty:/nowhere/ecu: cannot make this link to the pseudo-terminal: No such file");
}

static void test_links_give_everything_back(void)
{
    int before = dup(0);
    int after;

    (void)close(before);
    for (int i = 0; i < 20; i++) {
        open_both();
        close_link(&host);
        close_link(&adapter);
        (void)jp_can_link_open(&host, "slcan:/dev/null", error, sizeof error);
        (void)jp_can_link_open(&host, "can:nowhere0", error, sizeof error);
        (void)jp_can_link_open(&host, "pty:/nowhere/ecu", error, sizeof error);
    }
    after = dup(0);
    (void)close(after);
    TEST_ASSERT_EQUAL_INT(before, after);
}

int main(void)
{
    if (!make_folder()) {
        return 1;
    }
    UNITY_BEGIN();
    run_tests();
    (void)rmdir(folder);
    return UNITY_END();
}
