/**
 * The fault handler on the core: each test crashes the program in one way, and after the reset the record must say how.
 * What the program knows across the resets is in memory that start-up leaves alone.
 */
#include <stdbool.h>
#include <string.h>

#include "hal/cortex_m/cortex_m.h"
#include "hal/cortex_m/fault.h"
#include "tests/target/target.h"

#define KEEP __attribute__((section(".noinit")))

#define MAGIC 0x4A504654U

/** Not the next one, whose read ahead the core may have cached. */
#define FAR_AWAY ((volatile uint32_t *)0x90000000U)

/** An interrupt that nobody uses on either board: of pins. */
#define UNUSED_IRQ 6U

KEEP static uint32_t magic;
KEEP static uint32_t stage;
KEEP static uint32_t failures;
KEEP static uint32_t switched_off;

/** Stands for the bridges. */
void jp_bridges_off(void)
{
    switched_off++;
}

void jp_crash_by_instruction(void);
__attribute__((naked)) void jp_crash_by_instruction(void)
{
    __asm__ volatile("udf #0");
}

static void write_through_null(void)
{
    volatile uint32_t *volatile null = NULL;

    null[4] = 1;
}

static void call_null(void)
{
    void (*volatile null)(void) = NULL;

    null();
}

static void divide_by_zero(void)
{
    volatile uint32_t dividend = 7;
    volatile uint32_t zero = 0;
    volatile uint32_t quotient = dividend / zero;

    (void)quotient;
}

static void read_where_nothing_is(void)
{
    (void)*FAR_AWAY;
}

static void crash_with_interrupts_off(void)
{
    jp_interrupts_off();
    jp_crash_by_instruction();
}

static void raise_unused_interrupt(void)
{
    jp_nvic_enable(UNUSED_IRQ, 2);
    jp_nvic_pend(UNUSED_IRQ);
    jp_finish_writes();
}

/** Not a loop to the compiler, and deeper than any stack. */
static uint32_t descend(volatile uint32_t *depth)
{
    volatile uint32_t here[16] = {0};

    here[*depth % 16U] = ++*depth;
    return *depth == UINT32_MAX ? 0U : descend(depth) + here[0];
}

static void overflow_main_stack(void)
{
    volatile uint32_t depth = 0;

    (void)descend(&depth);
}

void SVC_Handler(void)
{
    overflow_main_stack();
}

static void overflow_handler_stack(void)
{
    __asm__ volatile("svc #0");
}

static void crash_in_handler(void)
{
    SCB.ICSR = ICSR_PENDSVSET;
    jp_finish_writes();
}

void PendSV_Handler(void)
{
    jp_crash_by_instruction();
}

enum { HARD = 3, MEMORY = 4, BUS = 5, USAGE = 6 };

static const struct test {
    const char *name;
    void (*crash)(void);
    enum jp_reset_cause cause;
    uint32_t exception;
    uint32_t status; /* bits of CFSR that must be set */
    bool at_instruction;
    int line;
} tests[] = {
    {"an_undefined_instruction", jp_crash_by_instruction, JP_RESET_FAULT, USAGE, 1U << 16, true, __LINE__},
    {"a_write_through_a_null_pointer", write_through_null, JP_RESET_FAULT, MEMORY, CFSR_DACCVIOL, false, __LINE__},
    {"a_call_of_a_null_pointer", call_null, JP_RESET_FAULT, MEMORY, 1U << 0, false, __LINE__},
    {"a_division_by_zero", divide_by_zero, JP_RESET_FAULT, USAGE, 1U << 25, false, __LINE__},
    {"a_read_where_nothing_is", read_where_nothing_is, JP_RESET_FAULT, BUS, 1U << 9, false, __LINE__},
    {"a_crash_with_interrupts_off", crash_with_interrupts_off, JP_RESET_FAULT, HARD, 1U << 16, true, __LINE__},
    {"a_crash_in_a_handler", crash_in_handler, JP_RESET_FAULT, USAGE, 1U << 16, true, __LINE__},
    {"an_interrupt_that_nobody_uses", raise_unused_interrupt, JP_RESET_FAULT, 16 + UNUSED_IRQ, 0, false, __LINE__},
    {"an_overflow_of_the_main_stack", overflow_main_stack, JP_RESET_STACK, MEMORY, 0, false, __LINE__},
    {"an_overflow_of_the_handlers_stack", overflow_handler_stack, JP_RESET_STACK, MEMORY, 0, false, __LINE__},
};
#define TESTS (sizeof tests / sizeof tests[0])

static void print_result(const struct test *test, const char *problem)
{
    target_print("tests/firmware/test_faults.c:");
    target_print_number((uint32_t)test->line);
    target_print(":");
    target_print(test->name);
    target_print(problem == NULL ? ":PASS" : ":FAIL: ");
    target_print(problem == NULL ? "" : problem);
    target_print("\n");
    failures += problem == NULL ? 0U : 1U;
}

/** What is wrong with the record; NULL: nothing. */
static const char *problem_of(const struct test *test, const struct jp_reset_report *report)
{
    const struct jp_crash *crash = &report->crash;

    if (report->cause != test->cause) {
        return "another cause";
    }
    if (crash->exception != test->exception) {
        return "another exception";
    }
    if ((crash->status & test->status) != test->status) {
        return "another fault status";
    }
    /* Without the bit for Thumb code. */
    if (test->at_instruction && crash->pc != ((uint32_t)(uintptr_t)jp_crash_by_instruction & ~1U)) {
        return "another instruction";
    }
    if (crash->tick != stage) {
        return "another tick";
    }
    if (switched_off != stage) {
        return "the bridges were not switched off once";
    }
    if (report->crashes != stage || report->may_go_on != (stage < JP_CRASHES_MAX)) {
        return "another count of crashes";
    }
    return NULL;
}

/** Below the faults, as the firmware's own handlers are. */
static void lower_handlers(void)
{
    SCB.SHPR[7] = NVIC_PRIORITY(2); /* SVC */
    SCB.SHPR[SHPR_PENDSV] = NVIC_PRIORITY(2);
}

static void start(void)
{
    magic = MAGIC;
    stage = 0;
    failures = 0;
    switched_off = 0;
}

int main(void)
{
    struct jp_reset_report report;

    lower_handlers();
    jp_post_mortem_open(&jp_post_mortem, magic == MAGIC ? JP_RESET_SOFTWARE : JP_RESET_POWER_ON, &report);
    if (magic != MAGIC) {
        start();
    } else {
        print_result(&tests[stage - 1U], problem_of(&tests[stage - 1U], &report));
    }
    if (stage < TESTS) {
        stage++;
        jp_fault_tick = stage;
        tests[stage - 1U].crash();
        print_result(&tests[stage - 1U], "nothing happened");
        target_exit(1);
    }
    target_print_number(TESTS);
    target_print(" Tests ");
    target_print_number(failures);
    target_print(" Failures 0 Ignored\n");
    target_print(failures == 0U ? "OK\n" : "FAIL\n");
    target_exit(failures == 0U ? 0 : 1);
}
