/** Work for all cores, with a progress bar. */
#ifndef JOULEPATH_SIM_BASE_PARALLEL_H
#define JOULEPATH_SIM_BASE_PARALLEL_H

#include <stddef.h>

/** Does task(context, index) for each index below `count`, in any order. Exits where no thread can be made. */
void in_parallel(const char *name, void (*task)(void *context, size_t index), void *context, size_t count);

#endif
