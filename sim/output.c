#include "output.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "error.h"

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

static bool failed(const struct output *output)
{
    error_line("%s: cannot write: %s; give another --output or make room", output->path, strerror(errno));
    return false;
}

bool output_open(struct output *output, const char *directory, const char *name)
{
    int length = snprintf(output->path, sizeof output->path, "%s/%s", directory, name);

    if (length < 0 || (size_t)length >= sizeof output->path) {
        error_line("%s/%s: the path is too long; give another --output", directory, name);
        return false;
    }
    (void)snprintf(output->temporary, sizeof output->temporary, "%s.part", output->path);
    output->stream = fopen(output->temporary, "w");
    return output->stream != NULL || failed(output);
}

bool output_open_json(struct output *output, const char *directory, const char *name, json_t *value)
{
    bool opened = output_open(output, directory, name);

    if (opened) {
        (void)json_dumpf(value, output->stream, JSON_INDENT(2) | JSON_REAL_PRECISION(12));
        (void)fputc('\n', output->stream);
    }
    json_decref(value);
    return opened;
}

static bool complete(struct output *output)
{
    bool written = fflush(output->stream) == 0 && ferror(output->stream) == 0;

    if (!written) {
        (void)failed(output);
    }
    return written;
}

static bool put_into_place(struct output *output)
{
    bool closed = fclose(output->stream) == 0;

    output->stream = NULL;
    return (closed && rename(output->temporary, output->path) == 0) || failed(output);
}

bool output_commit(struct output *outputs, size_t count)
{
    bool done = true;

    for (size_t i = 0; i < count && done; i++) {
        done = complete(&outputs[i]);
    }
    for (size_t i = 0; i < count && done; i++) {
        done = put_into_place(&outputs[i]);
    }
    if (!done) {
        output_discard(outputs, count);
    }
    return done;
}

void output_discard(struct output *outputs, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (outputs[i].stream != NULL) {
            (void)fclose(outputs[i].stream);
        }
        (void)remove(outputs[i].temporary);
    }
}
