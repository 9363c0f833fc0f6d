/**
 * Tariff: a copy of a lattice in the caller's RAM, whose physical costs follow the parameters that the robot has
 * learned. All else is the lattice's own, in ROM.
 *
 * Moves are charged by three factors: their level part by `straight`, what a rise adds by `mass`, its losses in the
 * motors by mass². A slope where gravity pushes the robot against its rolling resistance moves by straight/mass. What
 * the electronics draw stays the least cost. Bases are charged by the factor `turning` where the factors are measured;
 * from two energy models each primitive gets the difference that they make at its own speed and turn rate,
 *
 *   cost' = cost + Δb1 length²/T + Δb2 σ²/T, in place: cost + Δa3 σ², at least what the electronics draw
 *
 * but never less than its moves. So bases are not negative, moves alone and bases alone remain lower bounds, and what
 * lattice.h promises of a lattice that passes its check holds for its copy. Equal parameters give equal costs, bit for
 * bit. The costs `paper` and `distance` are as before.
 *
 * On a map that tells grounds apart each class has factors of its own: the lattice is charged by the least of them,
 * and each class by what it takes more (lattice.h).
 *
 * A planner takes the copy at jp_planner_init() or jp_planner_set_lattice(). It must not use a copy that is being
 * written: a robot that keeps learning has two and writes them in turn. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_TARIFF_H
#define JOULEPATH_TARIFF_H

#include <joulepath/energy.h>
#include <joulepath/lattice.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Range of every factor. */
#define JP_TARIFF_FACTOR_MIN JP_Q16(0.25)
#define JP_TARIFF_FACTOR_MAX JP_Q16(4)

/** Measured: energy against that of the tables, JP_TARIFF_FACTOR_MIN…JP_TARIFF_FACTOR_MAX. */
struct jp_tariff_factors {
    uint32_t version; /**< of the parameters; the caller's count */
    jp_q16 straight;  /**< of driving straight on level ground, electronics included */
    jp_q16 turning;   /**< of the additional energy of turning */
    jp_q16 mass;      /**< of the robot with its payload */
};

/** Learned by a robot with an energy model, such as jp_learner_model(). */
struct jp_tariff_models {
    uint32_t version;
    const struct jp_energy_model *built_in; /**< of the lattice's tables; its electronics count for both */
    const struct jp_energy_model *learned;  /**< in the same unit */
    jp_q16 mass;                            /**< as above */
};

struct jp_tariff {
    struct jp_primitive *primitives; /**< the caller's, first_from[JP_HEADINGS] of the lattice: 20 bytes each */
    uint16_t primitives_max;
    struct jp_lattice lattice; /**< to plan on, as long as the tariff lives */
};

/**
 * Charges a lattice that passed jp_lattice_check() by factors.
 * JP_ERR_CONFIG: *field names the first factor out of range. JP_ERR_MEMORY: more primitives than fit.
 * JP_ERR_OVERFLOW: a cost does not fit its format. JP_ERR_ARGUMENT: a pointer is null. Then tariff->lattice is void.
 * Work: the primitives and their moves, and all rises of nine unit steps.
 */
enum jp_status jp_tariff_by_factors(struct jp_tariff *tariff, const struct jp_lattice *lattice,
                                    const struct jp_tariff_factors *factors, const char **field);

/** What grounds take. */
struct jp_tariff_grounds {
    const struct jp_tariff_factors *factors; /**< by class; all but the first one's version and mass are not read */
    uint8_t classes;   /**< that the map has, 1…JP_GROUND_CLASSES; those beyond them cost as class 0 */
    jp_q16 half_track; /**< of the robot's wheels, m; 0…JP_Q16(4): 0: all are in the middle */
};

/**
 * The same by factors of the classes of ground. JP_ERR_CONFIG also names "classes", "half_track", or the first factor
 * out of range of the first class that has one. Wheels are taken to be no further from the middle than the cells that
 * every primitive sweeps. Work: also 32 sines for each cell of half_track.
 */
enum jp_status jp_tariff_by_grounds(struct jp_tariff *tariff, const struct jp_lattice *lattice,
                                    const struct jp_tariff_grounds *grounds, const char **field);

/** The same by two models. JP_ERR_CONFIG also names what is wrong in a model, and "straight" where they differ by more
 *  than a factor may. The cruising speed is that of the fastest primitive. Work: also a division a primitive. */
enum jp_status jp_tariff_by_models(struct jp_tariff *tariff, const struct jp_lattice *lattice,
                                   const struct jp_tariff_models *models, const char **field);

#ifdef __cplusplus
}
#endif

#endif
