/** Vector table and start-up of the emulated Cortex-M boards. */
#include "target.h"

#include <string.h>

extern uint32_t target_data_start, target_data_end, target_data_load;
extern uint32_t target_bss_start, target_bss_end;
extern uint32_t target_stack_limit, target_stack_top;

int main(void);
void target_reset(void);
void target_fault(void);

/** Stands at the limit of the stack: the boards have no guard, so an overflow is seen by its loss. */
#define STACK_MARK UINT32_C(0x5AFE57AC)

void target_reset(void)
{
    memcpy(&target_data_start, &target_data_load, (size_t)((char *)&target_data_end - (char *)&target_data_start));
    memset(&target_bss_start, 0, (size_t)((char *)&target_bss_end - (char *)&target_bss_start));
    target_stack_limit = STACK_MARK;

    int status = main();

    if (target_stack_limit != STACK_MARK) {
        target_print("stack overflow\n");
        status = 1;
    }
    target_exit(status);
}

void target_fault(void)
{
    target_print("\nhard fault\n");
    target_exit(1);
}

/** Stack, reset, then every exception of the core. */
__attribute__((section(".vectors"), used)) static const void *const vectors[16] = {
    &target_stack_top,    (void *)target_reset, (void *)target_fault, (void *)target_fault,
    (void *)target_fault, (void *)target_fault, (void *)target_fault, (void *)target_fault,
    (void *)target_fault, (void *)target_fault, (void *)target_fault, (void *)target_fault,
    (void *)target_fault, (void *)target_fault, (void *)target_fault, (void *)target_fault,
};
