/**
 * Registers and instructions of a Cortex-M3, M4 or M7 that firmware itself uses; names as in Arm's manuals. Addresses
 * are in cortex_m.ld.
 */
#ifndef JOULEPATH_HAL_CORTEX_M_CORTEX_M_H
#define JOULEPATH_HAL_CORTEX_M_CORTEX_M_H

#include <stdint.h>

/** System control block. */
struct cortex_scb {
    uint32_t CPUID;
    uint32_t ICSR;
    uint32_t VTOR;
    uint32_t AIRCR;
    uint32_t SCR;
    uint32_t CCR;
    uint8_t SHPR[12]; /**< priorities of the system exceptions 4 to 15 */
    uint32_t SHCSR;
    uint32_t CFSR;
    uint32_t HFSR;
    uint32_t DFSR;
    uint32_t MMFAR;
    uint32_t BFAR;
    uint32_t AFSR;
};

#define ICSR_VECTACTIVE   0x1FFU
#define ICSR_PENDSVSET    (1U << 28)
#define AIRCR_VECTKEY     (0x5FAU << 16)
#define AIRCR_SYSRESETREQ (1U << 2)
#define CCR_DIV_0_TRP     (1U << 4)
#define SHCSR_MEMFAULTENA (1U << 16)
#define SHCSR_BUSFAULTENA (1U << 17)
#define SHCSR_USGFAULTENA (1U << 18)
#define CFSR_DACCVIOL     (1U << 1)
#define CFSR_MSTKERR      (1U << 4)
#define CFSR_MMARVALID    (1U << 7)
#define CFSR_STKERR       (1U << 12)
#define CFSR_BFARVALID    (1U << 15)

struct cortex_systick {
    uint32_t CSR;
    uint32_t RVR;
    uint32_t CVR;
};

#define SYSTICK_ENABLE    (1U << 0)
#define SYSTICK_TICKINT   (1U << 1)
#define SYSTICK_CLKSOURCE (1U << 2)

/** Memory protection unit. */
struct cortex_mpu {
    uint32_t TYPE;
    uint32_t CTRL;
    uint32_t RNR;
    uint32_t RBAR;
    uint32_t RASR;
};

#define MPU_ENABLE     (1U << 0)
#define MPU_PRIVDEFENA (1U << 2)
#define RBAR_VALID     (1U << 4)
#define RASR_ENABLE    (1U << 0)
#define RASR_SIZE_POS  1U
#define RASR_XN        (1U << 28)

/** Interrupt controller. */
struct cortex_nvic {
    uint32_t ISER[8];
    uint32_t reserved_080[24];
    uint32_t ICER[8];
    uint32_t reserved_100[24];
    uint32_t ISPR[8];
    uint32_t reserved_180[24];
    uint32_t ICPR[8];
    uint32_t reserved_200[24];
    uint32_t IABR[8];
    uint32_t reserved_280[56];
    uint8_t IPR[240];
};

#define CPACR_FPU (0xFU << 20)

extern volatile struct cortex_nvic NVIC;
extern volatile uint32_t CPACR;
extern volatile struct cortex_scb SCB;
extern volatile struct cortex_systick SYSTICK;
extern volatile struct cortex_mpu MPU;

_Static_assert(sizeof(struct cortex_scb) == 0x40, "SCB");

/** SCB.SHPR of these exceptions. */
#define SHPR_PENDSV  10U
#define SHPR_SYSTICK 11U

/** Of many parts only the upper 4 bits of a priority count, of the others they are the upper ones too. */
#define NVIC_PRIORITY(level) ((uint8_t)((level) << 4))

void jp_interrupts_off(void);
void jp_interrupts_on(void);

/** Sleeps until an interrupt comes; one that comes while they are off ends it too. */
void jp_wait_for_interrupt(void);

/** What was written has its effect, also an interrupt that it pends. */
void jp_finish_writes(void);

/** Level 0 is the most urgent, 15 the least. */
void jp_nvic_enable(unsigned irq, unsigned level);

void jp_nvic_pend(unsigned irq);

_Noreturn void jp_system_reset(void);

#endif
