/**
 * Files that appear whole or not at all: written beside their place, renamed into it when complete. Each failure is
 * one line on stderr that names the path and the reason.
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

/** Puts the file into its place. */
bool output_commit(struct output *output);

/** Drops what was written. */
void output_discard(struct output *output);

/** Writes directory/name and takes the reference to `value`. */
bool output_json(const char *directory, const char *name, json_t *value);

#endif
