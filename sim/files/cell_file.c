#include "sim/files/cell_file.h"

#include <stddef.h>
#include <stdio.h>

#include "sim/base/error.h"
#include "sim/files/config_fields.h"

#define PATH_SIZE 128

#define FIELD(member) offsetof(struct cell_constants, member)
#define REAL(key, member, min, max, unit)                                                                              \
    {                                                                                                                  \
        key, FIELD(member), 1, CONFIG_FIELD_REAL, min, max, unit, false                                                \
    }
#define CURVE(key, member, count, min, max, unit)                                                                      \
    {                                                                                                                  \
        key, FIELD(member), count, CONFIG_FIELD_REAL, min, max, unit, false                                            \
    }

static const struct config_field cell_fields[] = {
    {"name", FIELD(name), CELL_NAME_SIZE, CONFIG_FIELD_TEXT, 0, 0, "", false},
    REAL("cell.capacity_ah", capacity_ah, 0.01, 1000, "Ah"),
    REAL("cell.mass_kg", mass_kg, 0.001, 100, "kg"),
    CURVE("cell.charge", charge, CELL_POINTS, 0, 1, "1"),
    CURVE("cell.open_circuit_v", open_circuit_v, CELL_POINTS, 0.5, 10, "V"),
    CURVE("resistance.charge", resistance.charge, CELL_RESISTANCE_POINTS, 0, 1, "1"),
    CURVE("resistance.ohmic_ohm", resistance.ohmic_ohm, CELL_RESISTANCE_POINTS, 1e-6, 10, "Ω"),
    REAL("resistance.ohmic_activation_k", resistance.ohmic_activation_k, 0, 10000, "K"),
    REAL("resistance.polarisation_ohm", resistance.polarisation_ohm, 1e-6, 10, "Ω"),
    REAL("resistance.polarisation_s", resistance.polarisation_s, 0.1, 10000, "s"),
    REAL("resistance.polarisation_activation_k", resistance.polarisation_activation_k, 0, 10000, "K"),
    REAL("resistance.reference_c", resistance.reference_c, -40, 80, "°C"),
    REAL("ageing.capacity_per_cycle", ageing.capacity_per_cycle, 0, 0.01, "1"),
    REAL("ageing.resistance_per_cycle", ageing.resistance_per_cycle, 0, 0.1, "1"),
    REAL("heat.capacity_j_per_kg_k", heat.capacity_j_per_kg_k, 1, 10000, "J/(kg·K)"),
    REAL("heat.to_air_w_per_k", heat.to_air_w_per_k, 0, 100, "W/K"),
    REAL("spread.capacity", spread.capacity, 0.001, 0.5, "1"),
    REAL("spread.capacity_per_root_h", spread.capacity_per_root_h, 0, 1, "1/√h"),
    REAL("spread.resistance", spread.resistance, 0.001, 1, "1"),
    REAL("spread.resistance_per_root_h", spread.resistance_per_root_h, 0, 1, "1/√h"),
    REAL("spread.polarisation", spread.polarisation, 0.001, 1, "1"),
    REAL("spread.polarisation_per_root_h", spread.polarisation_per_root_h, 0, 1, "1/√h"),
    REAL("spread.curve_v", spread.curve_v, 0, 0.5, "V"),
    REAL("spread.curve_length", spread.curve_length, 0.001, 1, "1"),
    REAL("spread.voltage_v", spread.voltage_v, 0.005, 1, "V"),
    REAL("spread.load_share", spread.load_share, 0, 1, "1"),
};

static const struct config_kind cell_kind = {NULL, 0, cell_fields, sizeof cell_fields / sizeof cell_fields[0]};

/* A curve goes over the whole charge. */
static bool check_charges(const char *path, const char *key, const double *charge, int count)
{
    bool rises = charge[0] == 0 && charge[count - 1] == 1;

    for (int i = 1; i < count; i++) {
        rises = rises && charge[i] > charge[i - 1];
    }
    if (!rises) {
        error_line("%s: %s: must rise from 0 to 1; correct the curve", path, key);
    }
    return rises;
}

static bool check_curve(const char *path, const struct cell_constants *cell)
{
    for (int i = 1; i < CELL_POINTS; i++) {
        if (cell->open_circuit_v[i] <= cell->open_circuit_v[i - 1]) {
            error_line("%s: cell.open_circuit_v[%d] = %g: must be above %g, the one before it; correct the curve", path,
                       i, cell->open_circuit_v[i], cell->open_circuit_v[i - 1]);
            return false;
        }
    }
    return true;
}

bool cell_file_load(const char *path, struct cell_constants *cell)
{
    *cell = (struct cell_constants){0};
    return config_fields_load(path, &cell_kind, cell) &&
           check_charges(path, "cell.charge", cell->charge, CELL_POINTS) &&
           check_charges(path, "resistance.charge", cell->resistance.charge, CELL_RESISTANCE_POINTS) &&
           check_curve(path, cell);
}

struct pack {
    char cell[CELL_NAME_SIZE];
    struct cell_wiring wiring;
};

static const struct config_field pack_fields[] = {
    {"cell", offsetof(struct pack, cell), CELL_NAME_SIZE, CONFIG_FIELD_TEXT, 0, 0, "", false},
    {"series", offsetof(struct pack, wiring.series), 1, CONFIG_FIELD_WHOLE, 1, 200, "1", false},
    {"parallel", offsetof(struct pack, wiring.parallel), 1, CONFIG_FIELD_WHOLE, 1, 1000, "1", false},
    {"wiring_ohm", offsetof(struct pack, wiring.wiring_ohm), 1, CONFIG_FIELD_REAL, 0, 100, "Ω", false},
    {"offset_a", offsetof(struct pack, wiring.offset_a), 1, CONFIG_FIELD_REAL, 0, 100, "A", false},
};

static const struct config_kind pack_kind = {NULL, 0, pack_fields, sizeof pack_fields / sizeof pack_fields[0]};

/* folder/name.cfg; false after one line on stderr. */
static bool path_of(const char *folder, const char *name, char path[PATH_SIZE])
{
    if (snprintf(path, PATH_SIZE, "%s/%s.cfg", folder, name) >= PATH_SIZE) {
        error_line("%s: the name is too long: %s", folder, name);
        return false;
    }
    return true;
}

bool pack_file_load(const char *path, struct cell_constants *cell, struct cell_wiring *wiring)
{
    struct pack pack = {.cell = ""};
    char cell_path[PATH_SIZE];

    if (!config_fields_load(path, &pack_kind, &pack) || !path_of("sim/robots/cells", pack.cell, cell_path) ||
        !cell_file_load(cell_path, cell)) {
        return false;
    }
    *wiring = pack.wiring;
    return true;
}

bool pack_file_load_robot(const char *robot, struct cell_constants *cell, struct cell_wiring *wiring)
{
    char path[PATH_SIZE];

    return path_of("sim/robots/packs", robot, path) && pack_file_load(path, cell, wiring);
}
