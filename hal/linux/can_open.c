#include "hal/linux/can_open.h"

#include <string.h>

#include "hal/linux/error_text.h"
#include "hal/linux/serial_can.h"
#include "hal/linux/socketcan.h"

static const struct {
    const char *prefix;
    bool (*open)(struct jp_can_link *link, const char *name, char *error, unsigned size);
} kinds[] = {
    {"can:", jp_socketcan_open},
    {"slcan:", jp_serial_can_open},
    {"pty:", jp_serial_can_open_pty},
};

bool jp_can_link_open(struct jp_can_link *link, const char *name, char *error, unsigned size)
{
    for (unsigned i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        const size_t length = strlen(kinds[i].prefix);

        if (strncmp(name, kinds[i].prefix, length) == 0) {
            return kinds[i].open(link, name + length, error, size);
        }
    }
    return jp_error_text(error, size,
                         "%.80s: not a CAN bus; give can:<interface>, slcan:<serial line> or pty:<new name>", name);
}
