/* The retained record in a file: it outlives a process that is killed; what cannot be such a file is refused. */
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "hal/linux/retained_file.h"
#include "unity.h"

static char folder[] = "/tmp/fault_retained_file.XXXXXX";
static char path[64];
static char error[256];
static struct jp_retained_file file;

void setUp(void)
{
    (void)unlink(path);
}

void tearDown(void)
{
    (void)unlink(path);
}

static void open_file(void)
{
    TEST_ASSERT_TRUE_MESSAGE(jp_retained_file_open(&file, path, error, sizeof error), error);
}

static void write_record(uint32_t resets)
{
    const union jp_retained_snapshot snapshot = {.balancer = {.balancing = true}};

    jp_retained_write(file.retained, JP_RETAINED_BALANCER, &snapshot, resets);
}

static void check_newest(uint32_t resets)
{
    const struct jp_retained_slot *newest = jp_retained_newest(file.retained);

    TEST_ASSERT_NOT_NULL(newest);
    TEST_ASSERT_EQUAL_UINT32(resets, newest->resets);
    TEST_ASSERT_TRUE(newest->snapshot.balancer.balancing);
}

static void check_refused(const char *name, const char *culprit)
{
    TEST_ASSERT_FALSE_MESSAGE(jp_retained_file_open(&file, name, error, sizeof error), name);
    TEST_ASSERT_TRUE_MESSAGE(strncmp(error, name, strlen(name)) == 0, error);
    TEST_ASSERT_TRUE_MESSAGE(strstr(error, culprit) != NULL, error);
    TEST_ASSERT_TRUE_MESSAGE(strchr(error, '\n') == NULL, error);
    TEST_ASSERT_NULL(file.retained);
}

static void write_bytes(size_t count, int byte)
{
    FILE *stream = fopen(path, "wb");

    TEST_ASSERT_NOT_NULL(stream);
    for (size_t i = 0; i < count; i++) {
        TEST_ASSERT_TRUE(fputc(byte, stream) == byte);
    }
    TEST_ASSERT_TRUE(fclose(stream) == 0);
}

static void test_a_new_file_holds_no_record(void)
{
    struct stat status;

    open_file();
    TEST_ASSERT_NULL(jp_retained_newest(file.retained));
    jp_retained_file_close(&file);
    TEST_ASSERT_TRUE(stat(path, &status) == 0);
    TEST_ASSERT_EQUAL_INT64(sizeof(struct jp_retained), status.st_size);
}

static void test_an_empty_file_is_a_new_one(void)
{
    write_bytes(0, 0);
    open_file();
    TEST_ASSERT_NULL(jp_retained_newest(file.retained));
    jp_retained_file_close(&file);
}

static void test_a_record_stays_when_the_file_is_closed(void)
{
    open_file();
    write_record(7);
    jp_retained_file_close(&file);
    open_file();
    check_newest(7);
    write_record(8);
    jp_retained_file_close(&file);
    open_file();
    check_newest(8);
    jp_retained_file_close(&file);
}

/* Kills a process that has written `writes` records. */
static void kill_a_writer(uint32_t writes)
{
    const pid_t child = fork();
    int status;

    TEST_ASSERT_TRUE(child >= 0);
    if (child == 0) {
        if (!jp_retained_file_open(&file, path, error, sizeof error)) {
            _exit(1);
        }
        for (uint32_t i = 1; i <= writes; i++) {
            write_record(i);
        }
        (void)raise(SIGKILL);
    }
    TEST_ASSERT_TRUE(waitpid(child, &status, 0) == child);
    TEST_ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
}

static void test_a_record_outlives_a_killed_process(void)
{
    for (uint32_t writes = 1; writes <= 5; writes++) {
        (void)unlink(path);
        kill_a_writer(writes);
        open_file();
        check_newest(writes);
        jp_retained_file_close(&file);
    }
}

/* A process that writes records without end; it has written `count` of them. */
static pid_t start_writer(uint32_t before, uint32_t count)
{
    int ends[2];
    char word;
    pid_t child;

    TEST_ASSERT_TRUE(pipe(ends) == 0);
    child = fork();
    TEST_ASSERT_TRUE(child >= 0);
    if (child == 0) {
        if (!jp_retained_file_open(&file, path, error, sizeof error)) {
            _exit(1);
        }
        for (uint32_t written = 1;; written++) {
            write_record(before + written);
            if (written == count && write(ends[1], "w", 1) != 1) {
                _exit(1);
            }
        }
    }
    (void)close(ends[1]);
    TEST_ASSERT_TRUE(read(ends[0], &word, 1) == 1);
    (void)close(ends[0]);
    return child;
}

/* A writer that is killed at any moment leaves a whole record. */
static void test_a_writer_may_be_killed_at_any_moment(void)
{
    uint32_t before = 0;

    for (uint32_t i = 0; i < 20; i++) {
        const uint32_t count = 1000 + i * 137;
        const pid_t child = start_writer(before, count);

        (void)kill(child, SIGKILL);
        TEST_ASSERT_TRUE(waitpid(child, NULL, 0) == child);
        open_file();
        TEST_ASSERT_NOT_NULL(jp_retained_newest(file.retained));
        TEST_ASSERT_TRUE(jp_retained_newest(file.retained)->resets >= before + count - 1);
        before = jp_retained_newest(file.retained)->resets;
        jp_retained_file_close(&file);
    }
}

static void test_a_file_of_right_size_but_of_garbage_holds_no_record(void)
{
    write_bytes(sizeof(struct jp_retained), 0xA5);
    open_file();
    TEST_ASSERT_NULL(jp_retained_newest(file.retained));
    write_record(1);
    check_newest(1);
    jp_retained_file_close(&file);
}

static void test_a_file_of_another_size_is_refused_and_kept(void)
{
    static const size_t sizes[] = {1, sizeof(struct jp_retained) - 1, sizeof(struct jp_retained) + 1, 100000};
    struct stat status;

    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        write_bytes(sizes[i], 'x');
        check_refused(path, "bytes, but the retained record has");
        TEST_ASSERT_TRUE(stat(path, &status) == 0);
        TEST_ASSERT_EQUAL_INT64(sizes[i], status.st_size);
    }
}

static void test_what_is_no_regular_file_is_refused(void)
{
    check_refused("/dev/null", "not a regular file");
    check_refused(folder, "cannot open this file: Is a directory");
    check_refused("/nowhere/retained", "cannot open this file: No such file or directory");
    check_refused("", "cannot open this file");
    TEST_ASSERT_TRUE(mkfifo(path, 0600) == 0);
    check_refused(path, "not a regular file");
}

static void test_a_file_in_use_is_refused(void)
{
    struct jp_retained_file first;

    open_file();
    first = file;
    check_refused(path, "another process keeps its retained record there");
    file = first;
    write_record(3);
    check_newest(3);
    jp_retained_file_close(&file);
    open_file();
    check_newest(3);
    jp_retained_file_close(&file);
}

static void test_files_give_everything_back(void)
{
    const int before = dup(0);
    int after;

    (void)close(before);
    for (int i = 0; i < 20; i++) {
        open_file();
        jp_retained_file_close(&file);
        (void)jp_retained_file_open(&file, "/dev/null", error, sizeof error);
    }
    after = dup(0);
    (void)close(after);
    TEST_ASSERT_EQUAL_INT(before, after);
}

int main(void)
{
    if (mkdtemp(folder) == NULL) {
        perror(folder);
        return 1;
    }
    (void)snprintf(path, sizeof path, "%s/retained", folder);
    UNITY_BEGIN();
    run_tests();
    (void)rmdir(folder);
    return UNITY_END();
}
