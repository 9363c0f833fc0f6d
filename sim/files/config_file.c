#include "sim/files/config_file.h"

#include <ctype.h>
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/error.h"

#define FILE_SIZE_MAX 65536

/* The whole file as text, to be freed; libconfig itself would end the process at a directory. NULL after an error. */
static char *read_text(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        error_line("%s: %s; give the path of a readable file", path, strerror(errno));
        return NULL;
    }
    char *text = malloc(FILE_SIZE_MAX + 1);
    if (text == NULL) {
        error_line("%s: no memory to read the file", path);
        (void)fclose(file);
        return NULL;
    }
    const size_t size = fread(text, 1, FILE_SIZE_MAX + 1, file);
    const int failure = ferror(file) ? errno : 0;
    (void)fclose(file);

    if (failure != 0) {
        error_line("%s: %s; give the path of a file", path, strerror(failure));
    } else if (size == 0) {
        error_line("%s: the file is empty; start from a copy of one in sim/", path);
    } else if (size > FILE_SIZE_MAX) {
        error_line("%s: more than %d bytes; this is no file of this kind", path, FILE_SIZE_MAX);
    } else if (memchr(text, '\0', size) != NULL) {
        error_line("%s: holds zero bytes; this is no text file", path);
    } else {
        text[size] = '\0';
        return text;
    }
    free(text);
    return NULL;
}

/* The first integer of a line that libconfig would silently wrap at 32 bits, or NULL. */
static const char *oversized_integer(const char *line)
{
    const char *end = line + strcspn(line, "#\n");
    bool inside = false; /* a word, or the fraction of a number */
    for (const char *c = line; c < end; c++) {
        if (isdigit((unsigned char)*c) && !inside) {
            char *stop;
            const unsigned long long value = strtoull(c, &stop, 0);
            const bool real = *stop == '.' || *stop == 'e' || *stop == 'E';
            if (!real && value > INT32_MAX) {
                return c;
            }
        }
        inside = isalnum((unsigned char)*c) || *c == '_' || *c == '.';
    }
    return NULL;
}

/* What libconfig itself would not refuse properly: it ends the process at an included directory. */
static bool check_text(const char *path, const char *text)
{
    int number = 1;
    for (const char *line = text; *line != '\0'; number++) {
        if (strncmp(line + strspn(line, " \t\r"), "@include", 8) == 0) {
            error_line("%s: line %d: @include is not supported; write the values into this file", path, number);
            return false;
        }
        const char *integer = oversized_integer(line);
        if (integer != NULL) {
            error_line("%s: line %d: %.*s does not fit 32 bits; correct the value", path, number,
                       (int)strspn(integer, "0123456789abcdefxABCDEFXL"), integer);
            return false;
        }
        line += strcspn(line, "\n");
        line += *line == '\n';
    }
    return true;
}

/* Past a string or a comment that begins here; NULL when none does. */
static char *skip_quoted(char *text)
{
    if (*text == '"') {
        for (text++; *text != '"' && *text != '\0'; text++) {
            text += *text == '\\' && text[1] != '\0';
        }
        return text + (*text == '"');
    }
    if (*text == '#' || strncmp(text, "//", 2) == 0) {
        return text + strcspn(text, "\n");
    }
    if (strncmp(text, "/*", 2) == 0) {
        char *end = strstr(text + 2, "*/");
        return end == NULL ? text + strlen(text) : end + 2;
    }
    return NULL;
}

/* Elements of libconfig's arrays must be all whole or all real; those of its lists may be either. */
static void make_lists_of_arrays(char *text)
{
    while (*text != '\0') {
        char *end = skip_quoted(text);
        if (end != NULL) {
            text = end;
            continue;
        }
        *text = *text == '[' ? '(' : *text == ']' ? ')' : *text;
        text++;
    }
}

bool config_file_parse(const char *path, config_t *config)
{
    char *text = read_text(path);
    if (text == NULL) {
        return false;
    }
    bool parsed = false;
    if (check_text(path, text)) {
        make_lists_of_arrays(text);
        parsed = config_read_string(config, text) == CONFIG_TRUE;
        if (!parsed) {
            error_line("%s: line %d: %s; correct the line or the one before it", path, config_error_line(config),
                       config_error_text(config));
        }
    }
    free(text);
    return parsed;
}

bool config_file_number(const config_setting_t *setting, double *value)
{
    switch (config_setting_type(setting)) {
    case CONFIG_TYPE_INT:
        *value = config_setting_get_int(setting);
        return true;
    case CONFIG_TYPE_INT64:
        *value = (double)config_setting_get_int64(setting);
        return true;
    case CONFIG_TYPE_FLOAT:
        *value = config_setting_get_float(setting);
        return true;
    default:
        return false;
    }
}
