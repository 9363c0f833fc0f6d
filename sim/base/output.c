#include "sim/base/output.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "sim/base/error.h"

/* Beside the place of a file, until it is complete. */
#define PART_SUFFIX ".part-XXXXXX"

/* Digits of a number that is read back bit by bit. */
#define EXACT 17

/* A chain of symbolic links is at most so long. */
#define LINKS_MAX 40

struct file {
    FILE *stream;
    char path[OUTPUT_PATH_SIZE]; /* as it was asked for */
    char place[PATH_MAX];        /* where its links lead */
    char part[PATH_MAX + sizeof PART_SUFFIX];
    volatile sig_atomic_t has_part;
};

/* There is one set at a time, and here, because a signal's handler must find it. */
static struct file files[OUTPUT_FILES_MAX];
static size_t file_count;

static const int ending_signals[] = {SIGHUP, SIGINT, SIGPIPE, SIGTERM};
#define ENDING_SIGNALS (sizeof ending_signals / sizeof ending_signals[0])

/* ---- Standard output ---- */

static void occupy(int descriptor, const char *device, int flags)
{
    if (fcntl(descriptor, F_GETFD) < 0 && errno == EBADF) {
        (void)open(device, flags);
    }
}

bool output_is_said(void)
{
    static bool has_complained;

    errno = 0;
    if (fflush(stdout) == 0 && ferror(stdout) == 0) {
        return true;
    }
    if (!has_complained) {
        has_complained = true;
        error_line("standard output: cannot write: %s; send it elsewhere or make room",
                   errno != 0 ? strerror(errno) : "an earlier write failed");
    }
    return false;
}

static void check_at_exit(void)
{
    if (!output_is_said()) {
        _exit(ERROR_EXIT);
    }
}

void output_start(void)
{
    /* The lowest free descriptor is the closed one. */
    occupy(STDIN_FILENO, "/dev/null", O_RDONLY);
    occupy(STDOUT_FILENO, "/dev/full", O_WRONLY);
    occupy(STDERR_FILENO, "/dev/full", O_WRONLY);
    (void)atexit(check_at_exit);
}

/* ---- Folders ---- */

static bool make_directory(const char *path)
{
    struct stat status;

    if (mkdir(path, 0777) == 0) {
        return true;
    }
    if (errno == EEXIST && stat(path, &status) == 0 && S_ISDIR(status.st_mode)) {
        return true;
    }
    error_line("%s: cannot make this directory: %s; give another --output", path,
               errno == EEXIST ? "a file is in its place" : strerror(errno));
    return false;
}

bool output_directory(const char *path)
{
    char partial[OUTPUT_PATH_SIZE];
    size_t length = strlen(path);

    if (length == 0 || length >= sizeof partial) {
        error_line("output directory: 1 to %zu characters; give another --output", sizeof partial - 1);
        return false;
    }
    memcpy(partial, path, length + 1);
    for (char *slash = strchr(partial + 1, '/'); slash != NULL; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        if (!make_directory(partial)) {
            return false;
        }
        *slash = '/';
    }
    if (!make_directory(partial)) {
        return false;
    }
    if (access(path, W_OK | X_OK) != 0) {
        error_line("%s: cannot write there: %s; give another --output", path, strerror(errno));
        return false;
    }
    return true;
}

/* ---- Signals ---- */

static void hold_signals(sigset_t *before)
{
    sigset_t ending;

    (void)sigemptyset(&ending);
    for (size_t i = 0; i < ENDING_SIGNALS; i++) {
        (void)sigaddset(&ending, ending_signals[i]);
    }
    (void)sigprocmask(SIG_BLOCK, &ending, before);
}

static void release_signals(const sigset_t *before)
{
    (void)sigprocmask(SIG_SETMASK, before, NULL);
}

/* The signal is raised again and, its action being the default by now, ends the program. */
static void clean_up(int number)
{
    for (size_t i = 0; i < OUTPUT_FILES_MAX; i++) {
        if (files[i].has_part != 0) {
            (void)unlink(files[i].part);
        }
    }
    (void)raise(number);
}

/* A signal that is ignored, or that the program catches, stays so. */
static void catch_signals(void)
{
    const struct sigaction action = {.sa_handler = clean_up, .sa_flags = (int)SA_RESETHAND};

    for (size_t i = 0; i < ENDING_SIGNALS; i++) {
        struct sigaction before;

        if (sigaction(ending_signals[i], NULL, &before) == 0 && before.sa_handler == SIG_DFL) {
            (void)sigaction(ending_signals[i], &action, NULL);
        }
    }
}

/* ---- Opening ---- */

static bool failed(const struct file *file)
{
    error_line("%s: cannot write: %s; give another --output or make room", file->path,
               errno != 0 ? strerror(errno) : "an earlier write failed");
    return false;
}

/* Replaces a link by what it leads to, which is relative to the link's folder. */
static bool follow_link(char place[PATH_MAX])
{
    char target[PATH_MAX];
    const ssize_t length = readlink(place, target, sizeof target);
    const char *slash = strrchr(place, '/');
    const size_t folder = length > 0 && target[0] != '/' && slash != NULL ? (size_t)(slash - place) + 1 : 0;

    if (length < 0 || folder + (size_t)length >= PATH_MAX) {
        errno = length < 0 ? errno : ENAMETOOLONG;
        return false;
    }
    memcpy(place + folder, target, (size_t)length);
    place[folder + (size_t)length] = '\0';
    return true;
}

static bool is_link(const char *path)
{
    struct stat status;

    return lstat(path, &status) == 0 && S_ISLNK(status.st_mode);
}

static bool find_place(struct file *file)
{
    unsigned links = 0;

    memcpy(file->place, file->path, sizeof file->path);
    while (is_link(file->place)) {
        if (++links > LINKS_MAX) {
            errno = ELOOP;
            return false;
        }
        if (!follow_link(file->place)) {
            return false;
        }
    }
    return true;
}

/* Has the permissions of the file that it shall replace, or those of a new one. */
static int make_part(struct file *file, const struct stat *old)
{
    const size_t length = strlen(file->place);
    const mode_t mask = umask(0);
    sigset_t before;

    (void)umask(mask);
    memcpy(file->part, file->place, length);
    memcpy(&file->part[length], PART_SUFFIX, sizeof PART_SUFFIX);
    hold_signals(&before);

    const int descriptor = mkstemp(file->part);

    file->has_part = descriptor >= 0;
    release_signals(&before);
    if (descriptor >= 0) {
        (void)fchmod(descriptor, old != NULL ? old->st_mode & 07777 : 0666 & ~mask);
    }
    return descriptor;
}

static FILE *open_stream(struct file *file)
{
    struct stat status;
    const bool exists = stat(file->place, &status) == 0;

    file->has_part = 0;
    if (exists && !S_ISREG(status.st_mode)) {
        return fopen(file->place, "w");
    }
    if (exists && access(file->place, W_OK) != 0) {
        return NULL;
    }

    const int descriptor = make_part(file, exists ? &status : NULL);

    return descriptor < 0 ? NULL : fdopen(descriptor, "w");
}

static void drop_part(struct file *file)
{
    if (file->has_part != 0) {
        (void)unlink(file->part);
        file->has_part = 0;
    }
}

FILE *output_open(const char *directory, const char *name)
{
    if (directory == NULL && strcmp(name, "-") == 0) {
        return stdout;
    }

    struct file *file = &files[file_count];
    const int length = snprintf(file->path, sizeof file->path, "%s%s%s", directory != NULL ? directory : "",
                                directory != NULL ? "/" : "", name);

    if (length < 0 || (size_t)length >= sizeof file->path) {
        error_line("%s: the path is too long; give another --output", file->path);
        return NULL;
    }
    catch_signals();
    file->stream = find_place(file) ? open_stream(file) : NULL;
    if (file->stream == NULL) {
        (void)failed(file);
        drop_part(file);
        return NULL;
    }
    file_count++;
    return file->stream;
}

bool output_json(const char *directory, const char *name, json_t *value)
{
    FILE *stream = output_open(directory, name);

    if (value == NULL) {
        error_line("%s: cannot write the result: no memory, or a number that is not finite", name);
    } else if (stream != NULL) {
        (void)json_dumpf(value, stream, JSON_INDENT(2) | JSON_REAL_PRECISION(EXACT));
        (void)fputc('\n', stream);
    }
    json_decref(value);
    return stream != NULL && value != NULL;
}

/* ---- The end ---- */

static bool complete(const struct file *file)
{
    errno = 0;
    return (fflush(file->stream) == 0 && ferror(file->stream) == 0) || failed(file);
}

static bool put_into_place(struct file *file)
{
    const bool is_closed = fclose(file->stream) == 0;

    file->stream = NULL;
    if (!is_closed || (file->has_part != 0 && rename(file->part, file->place) != 0)) {
        return failed(file);
    }
    file->has_part = 0;
    return true;
}

/* Others that write the same set wait, so that no set is mixed of two. */
static int lock_folder(void)
{
    char folder[PATH_MAX];
    char *slash;

    (void)snprintf(folder, sizeof folder, "%s", file_count > 0 ? files[0].place : "");
    slash = strrchr(folder, '/');
    if (slash == NULL) {
        (void)snprintf(folder, sizeof folder, ".");
    } else {
        slash[1] = '\0';
    }

    const int descriptor = open(folder, O_RDONLY | O_DIRECTORY);

    if (descriptor >= 0) {
        (void)flock(descriptor, LOCK_EX);
    }
    return descriptor;
}

static bool put_all_into_place(void)
{
    const int lock = lock_folder();
    bool done = true;
    sigset_t before;

    hold_signals(&before);
    for (size_t i = 0; i < file_count && done; i++) {
        done = put_into_place(&files[i]);
    }
    release_signals(&before);
    if (lock >= 0) {
        (void)close(lock);
    }
    return done;
}

bool output_commit(void)
{
    bool done = output_is_said();

    for (size_t i = 0; i < file_count && done; i++) {
        done = complete(&files[i]);
    }
    if (!done || !put_all_into_place()) {
        output_discard();
        return false;
    }
    file_count = 0;
    return true;
}

void output_discard(void)
{
    for (size_t i = 0; i < file_count; i++) {
        if (files[i].stream != NULL) {
            (void)fclose(files[i].stream);
            files[i].stream = NULL;
        }
        drop_part(&files[i]);
    }
    file_count = 0;
}
