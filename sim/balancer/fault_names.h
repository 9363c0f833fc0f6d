/** What messages for people call the faults of a robot (joulepath/monitor.h). */
#ifndef JOULEPATH_SIM_BALANCER_FAULT_NAMES_H
#define JOULEPATH_SIM_BALANCER_FAULT_NAMES_H

#include <joulepath/monitor.h>

#define FAULTS_NAME_SIZE 256

/** All faults of a fault word, such as "IMU jump, overspeed", or "none"; FAULTS_NAME_SIZE holds any. */
void faults_name(uint16_t faults, char text[FAULTS_NAME_SIZE]);

#endif
