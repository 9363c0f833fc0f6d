#include "sim/files/parameters_file.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "sim/base/error.h"

static bool refused(const char *path, const char *what)
{
    error_line("%s: cannot %s: %s; give another --parameters", path, what, strerror(errno));
    return false;
}

bool parameters_file_load(const char *path, uint32_t identity, struct jp_parameters *parameters, enum jp_stored *stored)
{
    uint8_t record[JP_STORE_LENGTH_MAX];
    FILE *stream = fopen(path, "rb");
    size_t length = 0;

    if (stream == NULL && errno != ENOENT) {
        return refused(path, "open this file");
    }
    if (stream != NULL) {
        length = fread(record, 1, sizeof record, stream);
        if (ferror(stream) != 0) {
            (void)refused(path, "read this file");
            (void)fclose(stream);
            return false;
        }
        (void)fclose(stream);
    }
    *stored = jp_parameters_start(parameters, identity, record, (uint16_t)length);
    return true;
}

static bool write_record(const char *path, const uint8_t *record, size_t length)
{
    FILE *stream = fopen(path, "wb");
    bool whole;

    if (stream == NULL) {
        return false;
    }
    whole = fwrite(record, 1, length, stream) == length && fflush(stream) == 0 && fsync(fileno(stream)) == 0;
    return fclose(stream) == 0 && whole;
}

bool parameters_file_save(const char *path, uint32_t identity, const struct jp_parameters *parameters)
{
    uint8_t record[JP_PARAMETERS_LENGTH];
    char temporary[PATH_MAX];
    const int length = snprintf(temporary, sizeof temporary, "%s.new", path);

    if (length < 0 || (size_t)length >= sizeof temporary) {
        errno = ENAMETOOLONG;
        return refused(path, "write this file");
    }
    jp_parameters_encode(parameters, identity, record);
    if (!write_record(temporary, record, sizeof record) || rename(temporary, path) != 0) {
        (void)refused(path, "write this file");
        (void)remove(temporary);
        return false;
    }
    return true;
}
