/**
 * A pack of lithium-ion cells, in double precision: what each cell does is
 *
 *   V = U(z) − v − R₀ i      dv/dt = (R₁ i − v)/τ      dz/dt = −i/Q      C dT/dt = R₀ i² + v i − G (T − air)
 *
 * with the open-circuit voltage U over the charge z, the ohmic resistance R₀ over charge and temperature, the voltage v
 * of polarisation, and temperature T. Resistances fall with temperature (Arrhenius). With each full cycle of throughput
 * the capacity Q falls and the resistances grow. All cells of a pack are alike.
 */
#ifndef JOULEPATH_SIM_BASE_CELL_PACK_H
#define JOULEPATH_SIM_BASE_CELL_PACK_H

#include <stdbool.h>

#define CELL_NAME_SIZE         32
#define CELL_POINTS            21
#define CELL_RESISTANCE_POINTS 6

/** Of a new cell. */
struct cell_constants {
    char name[CELL_NAME_SIZE];
    double capacity_ah;
    double mass_kg;
    double charge[CELL_POINTS]; /**< from 0 to 1, rising */
    double open_circuit_v[CELL_POINTS];
    struct {
        double charge[CELL_RESISTANCE_POINTS]; /**< from 0 to 1, rising */
        double ohmic_ohm[CELL_RESISTANCE_POINTS];
        double ohmic_activation_k; /**< R₀ ~ exp(activation/T) */
        double polarisation_ohm;   /**< R₁ */
        double polarisation_s;     /**< τ */
        double polarisation_activation_k;
        double reference_c; /**< at which the resistances are as said */
    } resistance;
    struct {
        double capacity_per_cycle;   /**< lost with each full cycle, share of the new cell's */
        double resistance_per_cycle; /**< gained, share */
    } ageing;
    struct {
        double capacity_j_per_kg_k;
        double to_air_w_per_k;
    } heat;
    /* Standard deviations of single cells from the above: for the filter of the core. */
    struct {
        double capacity; /**< share */
        double capacity_per_root_h;
        double resistance; /**< share */
        double resistance_per_root_h;
        double polarisation; /**< of its resistance, share */
        double polarisation_per_root_h;
        double curve_v;
        double curve_length; /**< share of the charge after which the curve is off by something else */
        double voltage_v;    /**< of a second's mean */
        double load_share;   /**< of the voltage that a load drops */
    } spread;
};

/** How many cells, and what lies between them and the bus. */
struct cell_wiring {
    int series;
    int parallel;
    double wiring_ohm; /**< wires and switches */
    double offset_a;   /**< standard deviation of what the current sensors show without current */
};

/** In what state a pack begins. */
struct cell_condition {
    double charge;        /**< z, 0…1 */
    double temperature_c; /**< of cells and air */
    double cycles;        /**< full ones so far */
};

/** J since the start, of the whole pack: chemical = terminal + ohmic + polarisation + wiring. */
struct cell_ledger {
    double chemical;     /**< ∫ U i: falls while it is charged */
    double terminal;     /**< ∫ V i at the bus */
    double ohmic;        /**< heat in R₀ */
    double polarisation; /**< heat in R₁, and what its capacitor stores */
    double wiring;       /**< heat in wires and switches */
};

struct cell_pack {
    struct cell_constants cell;
    struct cell_wiring wiring;
    double charge;         /**< z */
    double polarisation_v; /**< v of a cell */
    double temperature_c;
    double air_c;
    double cycles;
    struct cell_ledger ledger;
};

/** What the bus sees: V = open − resistance · I. */
struct cell_source {
    double open_v;
    double resistance_ohm;
};

/** At rest: no polarisation. */
void cell_pack_init(struct cell_pack *pack, const struct cell_constants *cell, const struct cell_wiring *wiring,
                    const struct cell_condition *condition);

/** At this moment. Beyond the ends of the charge the curve goes on as it ended. */
struct cell_source cell_pack_source(const struct cell_pack *pack);

/** The bus took this current, A, below 0 charged, for so long; exact for a constant current but for what U and R₀
 * change in that time. */
void cell_pack_step(struct cell_pack *pack, double amperes, double seconds);

/** Of the whole pack as it is now, A·s. */
double cell_pack_capacity(const struct cell_pack *pack);

/** Of a cell at a charge, V. */
double cell_open_circuit(const struct cell_constants *cell, double charge);

/** Of a new cell at a charge at its reference temperature, Ω. */
double cell_ohmic(const struct cell_constants *cell, double charge);

#endif
