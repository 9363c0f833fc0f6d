#include "sim/balancer/fault_names.h"

#include <stdio.h>

static const struct {
    uint16_t fault;
    const char *name;
} names[] = {
    {JP_FAULT_IMU_RANGE, "IMU range"},
    {JP_FAULT_IMU_JUMP, "IMU jump"},
    {JP_FAULT_IMU_FROZEN, "IMU frozen"},
    {JP_FAULT_ENCODER_JUMP, "encoder jump"},
    {JP_FAULT_ENCODER_LEFT, "left encoder"},
    {JP_FAULT_ENCODER_RIGHT, "right encoder"},
    {JP_FAULT_CURRENT_RANGE, "current range"},
    {JP_FAULT_BUS_VOLTAGE, "bus voltage"},
    {JP_FAULT_HARDWARE, "hardware"},
    {JP_FAULT_OVERSPEED, "overspeed"},
    {JP_FAULT_STALLED_LEFT, "left stalled"},
    {JP_FAULT_STALLED_RIGHT, "right stalled"},
    {JP_FAULT_WHEEL_IN_AIR, "wheel in the air"},
    {JP_FAULT_WHEELS_SPIN, "wheels spin"},
    {JP_FAULT_SLOPE, "slope"},
};

void faults_name(uint16_t faults, char text[FAULTS_NAME_SIZE])
{
    size_t length = 0;

    (void)snprintf(text, FAULTS_NAME_SIZE, "none");
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        if ((faults & names[i].fault) != 0) {
            length += (size_t)snprintf(text + length, FAULTS_NAME_SIZE - length, "%s%s", length == 0 ? "" : ", ",
                                       names[i].name);
        }
    }
}
