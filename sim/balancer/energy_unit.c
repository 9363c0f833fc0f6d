#include "sim/balancer/energy_unit.h"

#include <math.h>

double energy_unit_joules(const struct jp_energy_model *model, jp_q16 energy)
{
    return ldexp(energy, model->unit_exponent - 16);
}

double energy_unit_number(const struct jp_energy_model *model, double joules)
{
    return ldexp(joules, 16 - model->unit_exponent);
}
