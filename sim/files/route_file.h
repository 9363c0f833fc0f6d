/**
 * A route to plan: the start, its heading and the targets.
 *
 * CSV: a line of column names, then a point a line; x_m and y_m are needed, heading_deg counts in the first line, other
 * columns are left alone, so that the routes of jp-plan serve too. JSON: {"points_m": [[x, y], …], "heading_deg": 0}.
 * The first point is the start; without a heading it is 0, along x.
 */
#ifndef JOULEPATH_SIM_FILES_ROUTE_FILE_H
#define JOULEPATH_SIM_FILES_ROUTE_FILE_H

#include <joulepath/segment.h>
#include <stdbool.h>
#include <stddef.h>

#define ROUTE_FILE_TARGETS_MAX 4096

/** Coordinates, m, and headings, degrees, are within these. */
#define ROUTE_FILE_COORDINATE_MAX 30000.0
#define ROUTE_FILE_HEADING_MAX    360.0

struct route_file {
    struct jp_point start;
    jp_angle heading;
    size_t count; /**< of targets, at least 1 */
    struct jp_point targets[ROUTE_FILE_TARGETS_MAX];
};

/** Reads a route; what is not *.json is CSV. False after one line on stderr: file, line or key, what, what to do. */
bool route_file_load(const char *path, struct route_file *route);

#endif
