#include "sim/lattice/lattice_sets.h"

#include <stdlib.h>

#include "sim/base/error.h"
#include "sim/lattice/lattice_sweep.h"

static struct lattice_cells *new_cells(void)
{
    struct lattice_cells *cells = calloc(1, sizeof *cells);
    if (cells == NULL) {
        error_line("no memory for the cells of the lattice");
    }
    return cells;
}

static bool sweep(const struct lattice *lattice, const struct lattice_path *path, struct lattice_cells *cells)
{
    const struct lattice_footprint footprint = {lattice->robot->length_m / lattice->resolution_m,
                                                lattice->robot->width_m / lattice->resolution_m,
                                                lattice->robot->radius_m / lattice->resolution_m};

    if (!lattice_sweep(path, &footprint, cells)) {
        error_line("%s: the robot sweeps cells farther than %d from its start; choose larger cells or shorter "
                   "primitives",
                   lattice->robot->name, LATTICE_REACH);
        return false;
    }
    return true;
}

static bool cover_primitives(struct lattice *lattice)
{
    for (size_t i = 0; i < lattice->count; i++) {
        struct lattice_primitive *primitive = &lattice->primitives[i];
        primitive->swept = new_cells();
        if (primitive->swept == NULL || !sweep(lattice, &primitive->path, primitive->swept)) {
            return false;
        }
    }
    return true;
}

static bool cover_headings(struct lattice *lattice)
{
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        const struct lattice_path stand = {.poses = {{0, 0, lattice->headings[heading]}}, .count = 1};
        lattice->footprint[heading] = new_cells();
        if (lattice->footprint[heading] == NULL || !sweep(lattice, &stand, lattice->footprint[heading])) {
            return false;
        }
    }
    return true;
}

static void unite(struct lattice_cells *sum, const struct lattice_cells *cells)
{
    for (int i = 0; i < LATTICE_SIDE * LATTICE_SIDE; i++) {
        sum->at[i / LATTICE_SIDE][i % LATTICE_SIDE] |= cells->at[i / LATTICE_SIDE][i % LATTICE_SIDE];
    }
}

static bool unite_reaches(struct lattice *lattice)
{
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        lattice->reach[heading] = new_cells();
        if (lattice->reach[heading] == NULL) {
            return false;
        }
    }
    for (size_t i = 0; i < lattice->count; i++) {
        unite(lattice->reach[lattice->primitives[i].start], lattice->primitives[i].swept);
    }
    return true;
}

/* Removes from the core what is not swept when the core stands on (x, y). */
static void confine(struct lattice_cells *core, const struct lattice_cells *swept, int x, int y)
{
    for (int row = -LATTICE_REACH; row <= LATTICE_REACH; row++) {
        for (int column = -LATTICE_REACH; column <= LATTICE_REACH; column++) {
            bool *at = &core->at[row + LATTICE_REACH][column + LATTICE_REACH];
            *at = *at && lattice_has_cell(swept, column + x, row + y);
        }
    }
}

static bool intersect_core(struct lattice *lattice)
{
    lattice->core = new_cells();
    if (lattice->core == NULL) {
        return false;
    }
    *lattice->core = *lattice->primitives[0].swept;
    for (size_t i = 0; i < lattice->count; i++) {
        const struct lattice_primitive *primitive = &lattice->primitives[i];
        int x = 0;
        int y = 0;
        confine(lattice->core, primitive->swept, x, y);
        for (size_t move = 0; move < primitive->move_count; move++) {
            x += jp_move_offsets[primitive->moves[move]].dx;
            y += jp_move_offsets[primitive->moves[move]].dy;
            confine(lattice->core, primitive->swept, x, y);
        }
    }
    if (!lattice_has_cell(lattice->core, 0, 0)) {
        error_line("%s: the unit steps of a primitive leave the cells that it sweeps; choose larger cells",
                   lattice->robot->name);
        return false;
    }
    return true;
}

bool lattice_cover(struct lattice *lattice)
{
    return cover_primitives(lattice) && cover_headings(lattice) && unite_reaches(lattice) && intersect_core(lattice);
}

void lattice_free(struct lattice *lattice)
{
    for (size_t i = 0; i < lattice->count; i++) {
        free(lattice->primitives[i].swept);
    }
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        free(lattice->footprint[heading]);
        free(lattice->reach[heading]);
    }
    free(lattice->core);
    free(lattice->primitives);
}
