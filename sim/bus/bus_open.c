#include "sim/bus/bus_open.h"

#include "hal/linux/can_open.h"
#include "sim/base/error.h"

bool bus_open(struct jp_can_link *link, const char *name)
{
    char error[256];

    if (!jp_can_link_open(link, name, error, sizeof error)) {
        error_line("%s", error);
        return false;
    }
    return true;
}
