/** The bus that a program's command line names. */
#ifndef JOULEPATH_SIM_BUS_BUS_OPEN_H
#define JOULEPATH_SIM_BUS_BUS_OPEN_H

#include "hal/linux/can_open.h"

/** As jp_can_link_open(), with its line on stderr. */
bool bus_open(struct jp_can_link *link, const char *name);

#endif
