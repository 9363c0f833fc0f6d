/**
 * Files that appear whole and together or not at all: written beside their places, renamed into them when all are
 * complete. Each failure is one line on stderr that names the path and the reason.
 */
#ifndef JOULEPATH_SIM_OUTPUT_H
#define JOULEPATH_SIM_OUTPUT_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

#define OUTPUT_PATH_SIZE 1024

struct output {
    FILE *stream;
    char path[OUTPUT_PATH_SIZE];
    char temporary[OUTPUT_PATH_SIZE + 8];
};

/** Makes a directory and those above it; true when it can be written to. */
bool output_directory(const char *path);

/** Opens directory/name for writing. */
bool output_open(struct output *output, const char *directory, const char *name);

/** Opens directory/name, writes `value` and takes the reference to it. */
bool output_open_json(struct output *output, const char *directory, const char *name, json_t *value);

/** Puts `count` files into their places once all of them are complete; otherwise drops them all. */
bool output_commit(struct output *outputs, size_t count);

/** Drops what was written. */
void output_discard(struct output *outputs, size_t count);

#endif
