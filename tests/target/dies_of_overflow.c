/** Goes below its stack, and comes back. */
#include <stddef.h>
#include <stdint.h>

extern uint32_t target_stack_limit;

enum { WORDS = 64 };

__attribute__((noinline)) static void descend(void)
{
    volatile uint32_t frame[WORDS];

    for (size_t i = 0; i < WORDS; i++) {
        frame[i] = 0;
    }
    if ((uintptr_t)frame > (uintptr_t)&target_stack_limit) {
        descend();
    }
    frame[0] = 1;
}

int main(void)
{
    descend();
    return 0;
}
