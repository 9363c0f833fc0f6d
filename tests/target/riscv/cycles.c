/** Counts by the counter of retired instructions, which is exact under -icount. */
#include "tests/target/cycles.h"

static void empty(void *argument)
{
    (void)argument;
}

static inline uint32_t retired(void)
{
    uint32_t count;

    __asm__ volatile(".option push\n"
                     ".option arch, +zicsr\n"
                     "csrr %0, minstret\n"
                     ".option pop"
                     : "=r"(count)
                     :
                     : "memory");
    return count;
}

__attribute__((noinline)) static uint32_t count_call(void (*volatile function)(void *), void *argument)
{
    void (*const call)(void *) = function;
    const uint32_t start = retired();

    call(argument);
    return retired() - start;
}

uint32_t target_count_instructions(void (*function)(void *), void *argument)
{
    /* The empty function's return belongs to the function. */
    return count_call(function, argument) - count_call(empty, argument) + 1;
}

uint32_t target_count_worst(uint32_t worst, void (*function)(void *), void *argument)
{
    const uint32_t count = target_count_instructions(function, argument);

    return count > worst ? count : worst;
}

uint32_t target_count_once(void (*function)(void *), void *argument)
{
    return target_count_instructions(function, argument);
}
