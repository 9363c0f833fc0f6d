#include "hal/hal.h"

void jp_hal_tick(const struct jp_hal *hal, struct jp_robot *robot, enum jp_status *written)
{
    struct jp_sensors sensors = {0};
    struct jp_actuation actuation;
    enum jp_status read = hal->read(hal->context, &sensors);

    jp_robot_control(robot, *written == JP_OK ? read : *written, &sensors, &actuation);
    *written = hal->write(hal->context, &actuation);
    jp_robot_account(robot);
}

void jp_hal_skid_tick(const struct jp_hal *hal, struct jp_skid_robot *robot, enum jp_status *written)
{
    struct jp_sensors sensors = {0};
    struct jp_actuation actuation;
    enum jp_status read = hal->read(hal->context, &sensors);

    jp_skid_robot_control(robot, *written == JP_OK ? read : *written, &sensors, &actuation);
    *written = hal->write(hal->context, &actuation);
    jp_skid_robot_account(robot);
}

void jp_hal_four_wheel_tick(const struct jp_four_wheel_hal *hal, struct jp_four_wheel_robot *robot,
                            enum jp_status *written)
{
    struct jp_four_wheel_sensors sensors = {0};
    struct jp_four_wheel_actuation actuation;
    enum jp_status read = hal->read(hal->context, &sensors);

    jp_four_wheel_robot_control(robot, *written == JP_OK ? read : *written, &sensors, &actuation);
    *written = hal->write(hal->context, &actuation);
    jp_four_wheel_robot_account(robot);
}
