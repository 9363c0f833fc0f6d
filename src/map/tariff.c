#include <joulepath/tariff.h>
#include <stddef.h>
#include <string.h>

#include "src/base/config_check.h"
#include "src/base/integer.h"

enum { FRACTION_BITS = 16, MS_PER_S = 1000, MM2_PER_MS_IN_M2_PER_S = 1000 };

#define SPEED_SQUARE_MAX JP_Q16(64) /* m²/s²: that of jp_motion */
#define QUARTER_TURN     ((jp_angle)1 << 30)
#define TURN_IN_Q24_RAD  INT64_C(105414357) /* 2π */

/** By what the bases are computed. */
struct prices {
    jp_q16 straight;
    jp_q16 mass;
    jp_q16 turning;                        /* without models */
    const struct jp_tariff_models *models; /* NULL: by factors */
};

/** Multiplies a value by a factor, rounded down. False when the product does not fit. */
static bool scale(int32_t *value, jp_q16 factor)
{
    const int64_t product = ((int64_t)*value * factor) >> FRACTION_BITS;

    *value = jp_saturate32(product);
    return *value == product;
}

static bool scale_polynomial(struct jp_polynomial *polynomial, const struct prices *prices)
{
    const bool constant_fits = scale(&polynomial->constant, prices->straight);
    const bool linear_fits = scale(&polynomial->linear, prices->mass);
    const bool quadratic_fits = scale(&polynomial->quadratic, jp_q16_multiply(prices->mass, prices->mass));

    return constant_fits && linear_fits && quadratic_fits;
}

static bool scale_move(struct jp_slope_cost *cost, const struct prices *prices)
{
    const int64_t bend = (int64_t)cost->bend * prices->straight / prices->mass;
    const bool climb_fits = scale_polynomial(&cost->climb, prices);
    const bool descend_fits = scale_polynomial(&cost->descend, prices);

    cost->bend = (int16_t)jp_clamp32((int32_t)bend, INT16_MIN, INT16_MAX);
    return climb_fits && descend_fits && jp_slope_cost_is_valid(cost);
}

static bool scale_moves(struct jp_lattice *lattice, const struct prices *prices)
{
    for (unsigned move = 0; move < (unsigned)JP_MOVE_KINDS; move++) {
        if (!scale_move(&lattice->move_costs[JP_COST_PHYSICAL][move], prices)) {
            return false;
        }
    }
    return true;
}

static bool is_straight(const struct jp_lattice *lattice, const struct jp_primitive *primitive)
{
    const uint8_t *moves = &lattice->moves[primitive->first_move];

    for (unsigned i = 1; i < primitive->move_count; i++) {
        if (moves[i] != moves[0]) {
            return false;
        }
    }
    return primitive->move_count > 0U && primitive->start == primitive->end;
}

/** A base by factors. The base of a straight primitive only rounds up the cost of its moves. */
static int64_t scaled_base(const struct jp_lattice *lattice, const struct prices *prices,
                           const struct jp_primitive *primitive)
{
    const jp_q16 factor = is_straight(lattice, primitive) ? prices->straight : prices->turning;

    return ((int64_t)primitive->base[JP_COST_PHYSICAL] * factor + JP_Q16_ONE - 1) >> FRACTION_BITS;
}

/** σ², rad² in Q16. */
static int64_t turn_square(const struct jp_lattice *lattice, const struct jp_primitive *primitive)
{
    const int32_t turn = (int32_t)(lattice->heading[primitive->end] - lattice->heading[primitive->start]);
    const int64_t radians = (turn * TURN_IN_Q24_RAD) >> 32; /* Q24 */

    return (radians * radians) >> 32;
}

/** Change of the cost by a parameter of the energy model: (learned − built-in) · regressor, in 2⁻¹⁶ of a cost unit of
 * which the model's unit of energy has JP_COST_PER_JOULE. */
static int64_t difference(jp_q16 built_in, jp_q16 learned, int64_t regressor)
{
    return ((learned - (int64_t)built_in) * jp_saturate32(regressor)) >> FRACTION_BITS;
}

/** What is counted by the unit of the models' energy, by joules. */
static int64_t in_joules(const struct jp_tariff_models *models, int64_t number)
{
    return jp_times_power(number, models->built_in->unit_exponent);
}

/** By how much a primitive on level ground costs more by the learned model than by the built-in one: cost units,
 * rounded up. */
static int64_t learned_change(const struct jp_lattice *lattice, const struct jp_tariff_models *models,
                              const struct jp_primitive *primitive)
{
    const struct jp_energy_model *built_in = models->built_in;
    const struct jp_energy_model *learned = models->learned;
    const int64_t turn = turn_square(lattice, primitive) * JP_COST_PER_JOULE;
    const int64_t length = primitive->length;
    const int64_t square = length * length * ((int64_t)JP_COST_PER_JOULE << FRACTION_BITS) / MM2_PER_MS_IN_M2_PER_S;
    const int64_t time = primitive->duration;     /* ms */
    const int64_t duration = time > 0 ? time : 1; /* a table may have no times */
    const int64_t change = primitive->move_count == 0U
                               ? difference(built_in->a[2], learned->a[2], turn)
                               : difference(built_in->b[0], learned->b[0], square / duration) +
                                     difference(built_in->b[1], learned->b[1], turn * MS_PER_S / duration);

    return (in_joules(models, change) + JP_Q16_ONE - 1) >> FRACTION_BITS;
}

/** By how much the moves of a primitive on level ground cost more than before. */
static int64_t moves_change(const struct jp_lattice *before, const struct jp_lattice *after,
                            const struct jp_primitive *primitive)
{
    const uint8_t *moves = &before->moves[primitive->first_move];
    int64_t change = 0;

    for (unsigned i = 0; i < primitive->move_count; i++) {
        const enum jp_move_kind kind = jp_move_kind_of(moves[i]);
        change += (int64_t)jp_move_cost(&after->move_costs[JP_COST_PHYSICAL][kind], 0) -
                  (int64_t)jp_move_cost(&before->move_costs[JP_COST_PHYSICAL][kind], 0);
    }
    return change;
}

/** Least base of a primitive: 0 where its moves cost something; in place what the electronics draw, at least 1. */
static int64_t least_base(const struct jp_tariff_models *models, const struct jp_primitive *primitive)
{
    const int64_t duration = primitive->duration;
    const int64_t in_unit = models->built_in->electronics_power * duration * JP_COST_PER_JOULE / MS_PER_S;
    const int64_t draw = in_joules(models, in_unit);

    if (primitive->move_count > 0U) {
        return 0;
    }
    return draw >= JP_Q16_ONE ? draw >> FRACTION_BITS : 1;
}

/** A base such that the primitive costs what the learned model says. */
static int64_t learned_base(const struct jp_lattice *before, const struct jp_lattice *after,
                            const struct jp_tariff_models *models, const struct jp_primitive *primitive)
{
    const int64_t base = (int64_t)primitive->base[JP_COST_PHYSICAL] + learned_change(before, models, primitive) -
                         moves_change(before, after, primitive);
    const int64_t least = least_base(models, primitive);

    return base > least ? base : least;
}

/** False when a base does not fit. */
static bool write_bases(struct jp_tariff *tariff, const struct jp_lattice *lattice, const struct prices *prices)
{
    for (unsigned i = 0; i < lattice->first_from[JP_HEADINGS]; i++) {
        const struct jp_primitive *primitive = &lattice->primitives[i];
        const int64_t base = prices->models == NULL
                                 ? scaled_base(lattice, prices, primitive)
                                 : learned_base(lattice, &tariff->lattice, prices->models, primitive);
        if (base > (int64_t)UINT16_MAX) {
            return false;
        }
        tariff->primitives[i] = *primitive;
        tariff->primitives[i].base[JP_COST_PHYSICAL] = (uint16_t)base;
    }
    return true;
}

static enum jp_status charge(struct jp_tariff *tariff, const struct jp_lattice *lattice, const struct prices *prices,
                             uint32_t version)
{
    if (lattice->first_from[JP_HEADINGS] > tariff->primitives_max) {
        return JP_ERR_MEMORY;
    }
    tariff->lattice = *lattice;
    tariff->lattice.primitives = tariff->primitives;
    tariff->lattice.version = version;
    return scale_moves(&tariff->lattice, prices) && write_bases(tariff, lattice, prices) ? JP_OK : JP_ERR_OVERFLOW;
}

#define FIELD(member, low, high) JP_CONFIG_FIELD("", struct prices, member, low, high)

static enum jp_status check(const struct prices *prices, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(straight, JP_TARIFF_FACTOR_MIN, JP_TARIFF_FACTOR_MAX),
        FIELD(turning, JP_TARIFF_FACTOR_MIN, JP_TARIFF_FACTOR_MAX),
        FIELD(mass, JP_TARIFF_FACTOR_MIN, JP_TARIFF_FACTOR_MAX),
    };

    return jp_config_check(prices, fields, JP_CONFIG_COUNT(fields), field);
}

enum jp_status jp_tariff_by_factors(struct jp_tariff *tariff, const struct jp_lattice *lattice,
                                    const struct jp_tariff_factors *factors, const char **field)
{
    if (tariff == NULL || tariff->primitives == NULL || lattice == NULL || factors == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    const struct prices prices = {.straight = factors->straight, .mass = factors->mass, .turning = factors->turning};
    const enum jp_status status = check(&prices, field);

    return status == JP_OK ? charge(tariff, lattice, &prices, factors->version) : status;
}

static jp_q16 lesser(jp_q16 a, jp_q16 b)
{
    return a < b ? a : b;
}

/** What a factor is more than the least one, in 1/JP_GROUND_ONE, rounded down. */
static uint16_t share_of(jp_q16 factor, jp_q16 least)
{
    const int64_t share = ((int64_t)factor - least) * (int64_t)JP_GROUND_ONE / least;

    return (uint16_t)share;
}

static void price_grounds(struct jp_lattice *lattice, const struct jp_tariff_grounds *grounds,
                          const struct jp_tariff_factors *least)
{
    for (unsigned k = 0; k < JP_GROUND_CLASSES; k++) {
        const struct jp_tariff_factors *of = &grounds->factors[k < grounds->classes ? k : 0U];

        lattice->ground[k].straight = share_of(of->straight, least->straight);
        lattice->ground[k].turning = share_of(of->turning, least->turning);
    }
}

/** How many cells it is to that in which the way ends along an axis, m, from the middle of a cell. */
static int8_t cells_of(const struct jp_lattice *lattice, jp_q16 way, jp_q31 share)
{
    return (int8_t)jp_clamp32(jp_divide(jp_multiply_shift(way, share, 31), lattice->resolution), -INT8_MAX, INT8_MAX);
}

static bool is_side(const struct jp_lattice *lattice, struct jp_cell_offset side)
{
    return jp_lattice_core_holds(lattice, side.dx, side.dy) && jp_lattice_core_holds(lattice, -side.dx, -side.dy);
}

/** Where the left wheels are, as far as all primitives sweep it. */
static struct jp_cell_offset side_along(const struct jp_lattice *lattice, unsigned direction, jp_q16 half_track)
{
    const jp_angle across = lattice->heading[direction] + QUARTER_TURN;
    struct jp_cell_offset side;

    do {
        side = (struct jp_cell_offset){cells_of(lattice, half_track, jp_cos(across)),
                                       cells_of(lattice, half_track, jp_sin(across))};
        half_track -= lattice->resolution;
    } while (half_track >= 0 && !is_side(lattice, side));
    return is_side(lattice, side) ? side : (struct jp_cell_offset){0, 0};
}

static void place_wheels(struct jp_lattice *lattice, jp_q16 half_track)
{
    lattice->half_track = half_track;
    for (unsigned i = 0; i < (unsigned)JP_MOVE_DIRECTIONS; i++) {
        lattice->sides[i] = side_along(lattice, i, half_track);
    }
}

static enum jp_status check_factors(const struct jp_tariff_factors *factors, const char **field)
{
    const struct prices prices = {.straight = factors->straight, .mass = factors->mass, .turning = factors->turning};

    return check(&prices, field);
}

static enum jp_status check_grounds(const struct jp_tariff_grounds *grounds, const char **field)
{
    enum jp_status status = JP_OK;

    if (grounds->classes < 1U || grounds->classes > JP_GROUND_CLASSES) {
        return jp_config_refuse("classes", field);
    }
    if (grounds->half_track < 0 || grounds->half_track > JP_Q16(4)) {
        return jp_config_refuse("half_track", field);
    }
    for (unsigned k = 0; k < grounds->classes && status == JP_OK; k++) {
        status = check_factors(&grounds->factors[k], field);
    }
    return status;
}

enum jp_status jp_tariff_by_grounds(struct jp_tariff *tariff, const struct jp_lattice *lattice,
                                    const struct jp_tariff_grounds *grounds, const char **field)
{
    if (tariff == NULL || lattice == NULL || grounds == NULL || grounds->factors == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    enum jp_status status = check_grounds(grounds, field);

    if (status != JP_OK) {
        return status;
    }
    struct jp_tariff_factors least = grounds->factors[0];

    for (unsigned k = 1; k < grounds->classes; k++) {
        least.straight = lesser(least.straight, grounds->factors[k].straight);
        least.turning = lesser(least.turning, grounds->factors[k].turning);
    }
    status = jp_tariff_by_factors(tariff, lattice, &least, field);
    if (status == JP_OK) {
        price_grounds(&tariff->lattice, grounds, &least);
        place_wheels(&tariff->lattice, grounds->half_track);
    }
    return status;
}

/** Of the fastest primitive, which drives straight; m²/s² in Q16. */
static int64_t cruising_speed_square(const struct jp_lattice *lattice)
{
    uint64_t length = 0;
    uint64_t duration = 1;

    for (unsigned i = 0; i < lattice->first_from[JP_HEADINGS]; i++) {
        const struct jp_primitive *primitive = &lattice->primitives[i];
        if (primitive->duration > 0U && primitive->length * duration > length * primitive->duration) {
            length = primitive->length;
            duration = primitive->duration;
        }
    }
    const uint64_t square = ((length * length) << FRACTION_BITS) / (duration * duration);

    return square < (uint64_t)SPEED_SQUARE_MAX ? (int64_t)square : SPEED_SQUARE_MAX;
}

/** Power of driving straight on level ground by the learned model against that by the built-in one; Q16. */
static int64_t learned_straight(const struct jp_lattice *lattice, const struct jp_tariff_models *models)
{
    const int64_t square = cruising_speed_square(lattice);
    const int64_t electronics = models->built_in->electronics_power;
    const int64_t before = electronics + ((models->built_in->b[0] * square) >> FRACTION_BITS);
    const int64_t after = electronics + ((models->learned->b[0] * square) >> FRACTION_BITS);

    return after * JP_Q16_ONE / before;
}

enum jp_status jp_tariff_by_models(struct jp_tariff *tariff, const struct jp_lattice *lattice,
                                   const struct jp_tariff_models *models, const char **field)
{
    if (tariff == NULL || tariff->primitives == NULL || lattice == NULL || models == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    enum jp_status status = jp_energy_model_check(models->built_in, field);
    if (status == JP_OK) {
        status = jp_energy_model_check(models->learned, field);
    }
    if (status != JP_OK) {
        return status;
    }
    if (models->built_in->unit_exponent != models->learned->unit_exponent) {
        return jp_config_refuse("model.unit_exponent", field);
    }
    const int64_t straight = learned_straight(lattice, models);
    const struct prices prices = {
        .straight = jp_saturate32(straight), .mass = models->mass, .turning = JP_Q16_ONE, .models = models};

    status = check(&prices, field);
    return status == JP_OK ? charge(tariff, lattice, &prices, models->version) : status;
}
