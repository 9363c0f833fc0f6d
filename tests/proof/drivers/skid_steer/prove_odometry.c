/** Any configuration that passes, any frames, for ever. */
#include <joulepath/skid_odometry.h>

#include "tests/proof/any.h"

static void look(const struct jp_skid_odometry *odometry, const struct jp_skid_odometry_config *config)
{
    struct jp_skid_estimate estimate;
    struct jp_gyro_scale scale;
    struct jp_path_slide slide;
    struct jp_point position;
    jp_angle heading;

    jp_skid_odometry_now(odometry, config, &position, &heading);
    jp_skid_odometry_slide(odometry, config, &slide);
    jp_skid_odometry_estimate(odometry, config, &estimate);
    jp_skid_odometry_scale(odometry, config, &scale);
}

int main(void)
{
    struct jp_skid_odometry_config config;
    struct jp_skid_odometry odometry;
    struct jp_sensors sensors;
    const struct jp_gyro_scale scale = {any_between(-JP_GYRO_SCALE_MAX, JP_GYRO_SCALE_MAX),
                                        any_between(0, JP_GYRO_SCALE_DEVIATION_MAX)};
    const char *field;

    ANY(config);
    ANY(sensors);
    if (jp_skid_odometry_check(&config, &field) != JP_OK) {
        return 0;
    }
    jp_skid_odometry_start(&odometry, &config, &sensors);
    jp_skid_odometry_know_scale(&odometry, &config, &scale);
    ANY_TIMES
    {
        ANY(sensors);
        jp_skid_odometry_update(&odometry, &config, &sensors);
        look(&odometry, &config);
    }
    ARRIVED();
    return 0;
}
