/** Maps and lattices in JSON with any content: each is taken and whole, or refused with one line on stderr. */
#include "sim/files/lattice_file.h"
#include "sim/files/map_file.h"
#include "tests/fuzz/fuzz_file.h"

static bool load_map(const char *path)
{
    static struct map_file map;

    if (!map_file_load(path, &map)) {
        return false;
    }

    const struct jp_terrain *terrain = &map.terrain;

    for (int32_t y = -1; y <= (int32_t)terrain->config.height; y++) {
        for (int32_t x = -1; x <= (int32_t)terrain->config.width; x++) {
            fuzz_require(jp_terrain_cell(terrain, x, y) <= JP_CELL_UNKNOWN, "a cell that is none");
            fuzz_require(jp_terrain_class(terrain, x, y) < JP_GROUND_CLASSES, "a class that is none");
        }
    }
    map_file_free(&map);
    return true;
}

static bool load_lattice(const char *path)
{
    static struct lattice_file lattice;
    const char *field = NULL;

    if (!lattice_file_load(path, &lattice)) {
        return false;
    }
    fuzz_require(jp_lattice_check(&lattice.lattice, &field) == JP_OK, "a lattice that the core refuses");
    lattice_file_free(&lattice);
    return true;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    fuzz_file_load(bytes, size, load_map);
    fuzz_file_load(bytes, size, load_lattice);
    return 0;
}
