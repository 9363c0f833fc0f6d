#include "sim/missions/plan_parameters.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/balancer/energy_unit.h"
#include "sim/base/error.h"

/* Of an energy model (joulepath/energy.h). */
#define COEFFICIENT_MAX 4096.0

/* What a file holds; the strings and arrays belong to its JSON. */
struct parameters_text {
    const char *robot;
    json_int_t version;
    double straight;
    double turning;
    double mass;
    json_t *a; /* NULL: by factors */
    json_t *b;
};

static json_t *read_json(const char *path)
{
    json_error_t error;
    json_t *root = json_load_file(path, JSON_REJECT_DUPLICATES, &error);

    if (root == NULL && error.line < 1) {
        error_line("%s; give a file of parameters", error.text);
    } else if (root == NULL) {
        error_line("%s: line %d: %s; parameters are a JSON object", path, error.line, error.text);
    }
    return root;
}

/* Takes the value of a key by a format of json_unpack(). */
static bool take(const char *path, json_t *root, const char *key, const char *format, void *target)
{
    json_t *value = json_object_get(root, key);
    json_error_t error;

    if (value == NULL) {
        error_line("%s: %s: is missing; give robot, version and straight, turning or a, b", path, key);
        return false;
    }
    if (json_unpack_ex(value, &error, 0, format, target) != 0) {
        error_line("%s: %s: %s", path, key, error.text);
        return false;
    }
    return true;
}

static bool check_keys(const char *path, json_t *root, bool is_model)
{
    json_t *ignored;
    json_error_t error;

    if (json_unpack_ex(root, &error, JSON_STRICT, "{s?o, s?o, s?o, s?o, s?o}", "robot", &ignored, "version", &ignored,
                       "mass", &ignored, is_model ? "a" : "straight", &ignored, is_model ? "b" : "turning",
                       &ignored) != 0) {
        error_line("%s: %s; parameters are robot, version, mass and either straight, turning or a, b", path,
                   error.text);
        return false;
    }
    return true;
}

/* By factors, or by an energy model. */
static bool unpack(const char *path, json_t *root, struct parameters_text *text)
{
    const bool is_model = json_object_get(root, "a") != NULL || json_object_get(root, "b") != NULL;

    *text = (struct parameters_text){.mass = 1};
    if (!check_keys(path, root, is_model) || !take(path, root, "robot", "s", &text->robot) ||
        !take(path, root, "version", "I", &text->version) ||
        (json_object_get(root, "mass") != NULL && !take(path, root, "mass", "F", &text->mass))) {
        return false;
    }
    return is_model
               ? take(path, root, "a", "o", &text->a) && take(path, root, "b", "o", &text->b)
               : take(path, root, "straight", "F", &text->straight) && take(path, root, "turning", "F", &text->turning);
}

static bool check(const char *path, const struct parameters_text *text, const struct lattice_robot *robot)
{
    if (strcmp(text->robot, robot->name) != 0) {
        error_line("%s: robot: '%s' is not '%s', for which is planned; give a file of that robot", path, text->robot,
                   robot->name);
        return false;
    }
    if (text->version < 1 || text->version > UINT32_MAX) {
        error_line("%s: version: %" JSON_INTEGER_FORMAT " is not in 1…%u; 0 is that of the built-in parameters", path,
                   text->version, UINT32_MAX);
        return false;
    }
    if (text->a != NULL && robot->balancer.model == NULL) {
        error_line("%s: a: %s has no such energy model; give straight and turning", path, robot->name);
        return false;
    }
    return true;
}

/* Out of the format it is out of every range too. */
static jp_q16 to_q16(double value)
{
    return (jp_q16)lrint(fmax(INT32_MIN, fmin(INT32_MAX, value * JP_Q16_ONE)));
}

/* `model` tells the unit of the energies among them, of which only a13 is none. */
static bool read_numbers(const char *path, const char *key, const json_t *array, double low, size_t count,
                         const struct jp_energy_model *model, jp_q16 *numbers)
{
    if (json_array_size(array) != count) {
        error_line("%s: %s: must be a list of %zu numbers", path, key, count);
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        const json_t *value = json_array_get(array, i);
        const double number = json_number_value(value);
        const double unit = i == ENERGY_UNIT_TIME_TERM ? 1 : energy_unit_joules(model, JP_Q16_ONE);

        if (!json_is_number(value) || !(number >= low * unit && number <= COEFFICIENT_MAX * unit)) {
            error_line("%s: %s%zu: must be a number from %g to %g", path, key, i + 1, low * unit,
                       COEFFICIENT_MAX * unit);
            return false;
        }
        numbers[i] = to_q16(number / unit);
    }
    return true;
}

static bool accept(const char *path, enum jp_status status, const char *field)
{
    if (status == JP_ERR_CONFIG) {
        error_line("%s: %s: out of range: straight, turning and mass take %g…%g, also straight by a and b", path, field,
                   (double)JP_TARIFF_FACTOR_MIN / JP_Q16_ONE, (double)JP_TARIFF_FACTOR_MAX / JP_Q16_ONE);
    } else if (status != JP_OK) {
        error_line("%s: too dear for the tables of the lattice; give smaller factors", path);
    }
    return status == JP_OK;
}

static bool charge_by_model(const char *path, const struct parameters_text *text,
                            const struct jp_energy_model *built_in, const struct jp_lattice *lattice,
                            struct jp_tariff *tariff)
{
    struct jp_energy_model learned = *built_in;
    const struct jp_tariff_models models = {(uint32_t)text->version, built_in, &learned, to_q16(text->mass)};
    const char *field = NULL;

    if (!read_numbers(path, "a", text->a, -COEFFICIENT_MAX, JP_ENERGY_TERMS, built_in, learned.a) ||
        !read_numbers(path, "b", text->b, 0, sizeof learned.b / sizeof learned.b[0], built_in, learned.b)) {
        return false;
    }
    const enum jp_status status = jp_tariff_by_models(tariff, lattice, &models, &field);
    return accept(path, status, field);
}

static bool charge_by_factors(const char *path, const struct parameters_text *text, const struct jp_lattice *lattice,
                              struct jp_tariff *tariff)
{
    const struct jp_tariff_factors factors = {(uint32_t)text->version, to_q16(text->straight), to_q16(text->turning),
                                              to_q16(text->mass)};
    const char *field = NULL;
    const enum jp_status status = jp_tariff_by_factors(tariff, lattice, &factors, &field);

    return accept(path, status, field);
}

static bool charge(const char *path, json_t *root, const struct lattice_robot *robot, const struct jp_lattice *lattice,
                   struct jp_tariff *tariff)
{
    struct parameters_text text;

    if (!unpack(path, root, &text) || !check(path, &text, robot)) {
        return false;
    }
    return text.a != NULL ? charge_by_model(path, &text, robot->balancer.model, lattice, tariff)
                          : charge_by_factors(path, &text, lattice, tariff);
}

bool plan_parameters_load(const char *path, const struct lattice_robot *robot, const struct jp_lattice *lattice,
                          struct jp_tariff *tariff)
{
    const uint16_t count = lattice->first_from[JP_HEADINGS];

    *tariff = (struct jp_tariff){.primitives = calloc(count, sizeof *tariff->primitives), .primitives_max = count};
    if (tariff->primitives == NULL) {
        error_line("%s: no memory for the lattice", path);
        return false;
    }
    json_t *root = read_json(path);
    const bool is_charged = root != NULL && charge(path, root, robot, lattice, tariff);
    json_decref(root);
    return is_charged;
}

void plan_parameters_free(struct jp_tariff *tariff)
{
    free(tariff->primitives);
    *tariff = (struct jp_tariff){.primitives = NULL};
}
