/** State lattices from the JSON files that tools/design/lattice.py writes; its help describes them. */
#ifndef JOULEPATH_SIM_FILES_LATTICE_FILE_H
#define JOULEPATH_SIM_FILES_LATTICE_FILE_H

#include <joulepath/lattice.h>

#define LATTICE_FILE_NAME_SIZE 64

struct lattice_file {
    struct jp_lattice lattice;
    char name[LATTICE_FILE_NAME_SIZE]; /**< of the robot that it was priced for */
    struct jp_primitive *primitives;
    uint16_t *by_end;
    uint8_t *moves;
    struct jp_span *spans;
};

/** Loads a lattice, which then passes jp_lattice_check(). False after one line on stderr: file, what, what to do; then
 *  there is nothing to free. */
bool lattice_file_load(const char *path, struct lattice_file *file);

void lattice_file_free(struct lattice_file *file);

#endif
