/**
 * What a program writes: a set of files that appear whole and together or not at all, and standard output.
 *
 * A file is written beside its place, under a name of its own, and renamed into it when all are complete; a signal that
 * ends the program takes it away. A symbolic link stays one: what it leads to is written. What is no regular file, such
 * as a device or a pipe, is written straight to. Two runs into one folder leave the whole set of one of them.
 *
 * Each failure is one line on stderr that names the path and the reason.
 */
#ifndef JOULEPATH_SIM_BASE_OUTPUT_H
#define JOULEPATH_SIM_BASE_OUTPUT_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

#define OUTPUT_PATH_SIZE 1024

/** Files of a set. */
#define OUTPUT_FILES_MAX 8

/** To be called first: a standard stream that was closed takes no file's place, and at the end of the program what
 * could not be written to standard output is said, with ERROR_EXIT. */
void output_start(void);

/** Whether all of standard output has been written so far. */
bool output_is_said(void);

/** Makes a directory and those above it; true when it can be written to. */
bool output_directory(const char *path);

/** Opens directory/name, or name alone when the directory is NULL, as the next file of the set; "-" alone is standard
 * output, which is in no set. NULL: not. */
FILE *output_open(const char *directory, const char *name);

/** The same, writes `value` with all bits of its numbers and takes the reference to it. */
bool output_json(const char *directory, const char *name, json_t *value);

/** Puts the files into their places once all of them, and standard output, are complete; otherwise drops them. */
bool output_commit(void);

/** Drops what was written. */
void output_discard(void);

#endif
