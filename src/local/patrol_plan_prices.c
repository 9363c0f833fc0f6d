#include "src/local/patrol_plan_prices.h"

#include "src/base/plane.h"
#include "src/local/patrol_room.h"
#include "src/local/patrol_yield.h"

/* More joules than any price of a metre may be. */
#define MOST 32767.0f

static jp_q16 to_q16(float value)
{
    return (jp_q16)(jp_plane_clamp(value, 0.0f, MOST) * (float)JP_Q16_ONE);
}

static jp_q24 to_q24(float value)
{
    return (jp_q24)(jp_plane_clamp(value, 0.0f, 127.0f) * (float)JP_Q24_ONE);
}

/* J for each second in which something is at a distance. */
static float clearance_price(const struct jp_patrol_config *config, float distance)
{
    const struct jp_teb_config *const band = &config->teb;
    const float missing = jp_plane_larger(band->clearance - distance, 0.0f);
    const float joule = band->weights.second / config->price.second;

    return joule > 0.0f ? 0.5f * band->weights.obstacle * missing * missing / (band->interval * joule) : 0.0f;
}

/* What a metre costs more at a distance from something, J. The robot has a price, so creeping has one too. */
static float near_price(const struct jp_patrol_config *config, const struct jp_four_wheel_energy_model *model,
                        float distance, jp_q16 level)
{
    const float speed = jp_patrol_speed_beside(config, distance);
    jp_q16 energy = 0;

    (void)jp_four_wheel_energy_metre(model, to_q24(speed), 0, &energy);
    return ((float)energy - (float)level) / (float)JP_Q16_ONE +
           (config->price.worth + clearance_price(config, distance)) / speed;
}

/* A ring is at least a cell wide, and the last one is beyond what costs anything. */
static float ring_of(const struct jp_patrol_config *config, float clearance, float cell)
{
    const float reach = jp_plane_larger(config->teb.clearance, JP_PATROL_CLEARANCE) - clearance;

    return jp_plane_larger(cell, reach / (float)JP_GRID_RINGS);
}

enum jp_status jp_patrol_plan_prices(const struct jp_patrol_config *config,
                                     const struct jp_four_wheel_energy_model *model, float clearance, float cell,
                                     struct jp_grid_prices *prices)
{
    const float ring = ring_of(config, clearance, cell);
    const enum jp_status status =
        jp_grid_prices_set(model, to_q24(config->teb.speed_max), to_q16(config->price.worth), prices);

    if (status == JP_OK) {
        prices->ring = to_q16(ring);
        for (unsigned i = 0; i < JP_GRID_RINGS; i++) {
            prices->near[i] = to_q16(near_price(config, model, clearance + ((float)i + 0.5f) * ring, prices->metre));
        }
    }
    return status;
}
