/** Start-up of a program on an emulated board. */
#include "tests/target/board.h"
#include "tests/target/target.h"

#include <string.h>

extern uint32_t target_data_start, target_data_end, target_data_load;
extern uint32_t target_bss_start, target_bss_end;
extern uint32_t target_stack_limit;

int main(void);

/** Stands at the limit of the stack: the boards have no guard, so an overflow is seen by its loss. */
#define STACK_MARK UINT32_C(0x5AFE57AC)

_Noreturn void target_start(void)
{
    target_core_start();
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

_Noreturn void target_fault(void)
{
    target_print("\nfault\n");
    target_exit(1);
}
