/** All of Joulepath that needs no floating-point unit. */
#ifndef JOULEPATH_ARDUINO_H
#define JOULEPATH_ARDUINO_H

#include <joulepath/navigator.h>
#include <joulepath/pilot.h>
#include <joulepath/planner.h>
#include <joulepath/skid_pilot.h>
#include <joulepath/tables.h>

#include "hal/hal.h"

#endif
