/**
 * The registers of the STM32F405 that the firmware uses. Structs, registers and bits have the names of the reference
 * manual RM0090, those of the core of PM0214; tests/tools/test_stm32_registers.py compares them with the family's SVD
 * file.
 *
 * A peripheral is an object at an address that the linker gives (peripherals.ld); a test links memory of its own.
 *
 * A field of one bit is its mask, PERIPHERAL_REGISTER_FIELD; a wider one is a macro that puts its value in place.
 */
#ifndef JOULEPATH_HAL_STM32F4_STM32F405_H
#define JOULEPATH_HAL_STM32F4_STM32F405_H

#include <stdint.h>

/* ---- Reset and clock control (RM0090 §7) ---- */

struct stm32_rcc {
    uint32_t CR;
    uint32_t PLLCFGR;
    uint32_t CFGR;
    uint32_t CIR;
    uint32_t AHB1RSTR;
    uint32_t AHB2RSTR;
    uint32_t AHB3RSTR;
    uint32_t reserved_1c;
    uint32_t APB1RSTR;
    uint32_t APB2RSTR;
    uint32_t reserved_28[2];
    uint32_t AHB1ENR;
    uint32_t AHB2ENR;
    uint32_t AHB3ENR;
    uint32_t reserved_3c;
    uint32_t APB1ENR;
    uint32_t APB2ENR;
    uint32_t reserved_48[10];
    uint32_t BDCR;
    uint32_t CSR;
};

#define RCC_CR_HSION  (1U << 0)
#define RCC_CR_HSIRDY (1U << 1)
#define RCC_CR_HSEON  (1U << 16)
#define RCC_CR_HSERDY (1U << 17)
#define RCC_CR_CSSON  (1U << 19)
#define RCC_CR_PLLON  (1U << 24)
#define RCC_CR_PLLRDY (1U << 25)

#define RCC_PLLCFGR_PLLM(n) ((uint32_t)(n) << 0)
#define RCC_PLLCFGR_PLLN(n) ((uint32_t)(n) << 6)
#define RCC_PLLCFGR_PLLP(n) ((uint32_t)(n) << 16)
#define RCC_PLLCFGR_PLLSRC  (1U << 22)
#define RCC_PLLCFGR_PLLQ(n) ((uint32_t)(n) << 24)

#define RCC_CFGR_SW(n)    ((uint32_t)(n) << 0)
#define RCC_CFGR_SWS(n)   ((uint32_t)(n) << 2)
#define RCC_CFGR_HPRE(n)  ((uint32_t)(n) << 4)
#define RCC_CFGR_PPRE1(n) ((uint32_t)(n) << 10)
#define RCC_CFGR_PPRE2(n) ((uint32_t)(n) << 13)

#define RCC_CIR_CSSF (1U << 7)
#define RCC_CIR_CSSC (1U << 23)

#define RCC_AHB1ENR_GPIOAEN (1U << 0)
#define RCC_AHB1ENR_GPIOBEN (1U << 1)
#define RCC_AHB1ENR_GPIOCEN (1U << 2)
#define RCC_AHB1ENR_GPIODEN (1U << 3)
#define RCC_AHB1ENR_GPIOEEN (1U << 4)
#define RCC_AHB1ENR_DMA2EN  (1U << 22)

#define RCC_APB1ENR_TIM2EN (1U << 0)
#define RCC_APB1ENR_TIM3EN (1U << 1)
#define RCC_APB1ENR_TIM4EN (1U << 2)
#define RCC_APB1ENR_TIM5EN (1U << 3)
#define RCC_APB1ENR_CAN1EN (1U << 25)
#define RCC_APB1ENR_PWREN  (1U << 28)

#define RCC_APB2ENR_TIM1EN   (1U << 0)
#define RCC_APB2ENR_TIM8EN   (1U << 1)
#define RCC_APB2ENR_USART1EN (1U << 4)
#define RCC_APB2ENR_ADC1EN   (1U << 8)
#define RCC_APB2ENR_SPI1EN   (1U << 12)
#define RCC_APB2ENR_SYSCFGEN (1U << 14)

#define RCC_CSR_LSION    (1U << 0)
#define RCC_CSR_LSIRDY   (1U << 1)
#define RCC_CSR_RMVF     (1U << 24)
#define RCC_CSR_BORRSTF  (1U << 25)
#define RCC_CSR_PADRSTF  (1U << 26)
#define RCC_CSR_PORRSTF  (1U << 27)
#define RCC_CSR_SFTRSTF  (1U << 28)
#define RCC_CSR_WDGRSTF  (1U << 29)
#define RCC_CSR_WWDGRSTF (1U << 30)
#define RCC_CSR_LPWRRSTF (1U << 31)

/* ---- Power control (§5) ---- */

struct stm32_pwr {
    uint32_t CR;
    uint32_t CSR;
};

#define PWR_CR_PVDE   (1U << 4)
#define PWR_CR_PLS(n) ((uint32_t)(n) << 5)
#define PWR_CR_VOS    (1U << 14)

#define PWR_CSR_PVDO (1U << 2)

/* ---- Flash interface (§3) ---- */

struct stm32_flash {
    uint32_t ACR;
    uint32_t KEYR;
    uint32_t OPTKEYR;
    uint32_t SR;
    uint32_t CR;
    uint32_t OPTCR;
};

#define FLASH_ACR_LATENCY(n) ((uint32_t)(n) << 0)
#define FLASH_ACR_PRFTEN     (1U << 8)
#define FLASH_ACR_ICEN       (1U << 9)
#define FLASH_ACR_DCEN       (1U << 10)
#define FLASH_ACR_ICRST      (1U << 11)
#define FLASH_ACR_DCRST      (1U << 12)

#define FLASH_SR_EOP    (1U << 0)
#define FLASH_SR_OPERR  (1U << 1)
#define FLASH_SR_WRPERR (1U << 4)
#define FLASH_SR_PGAERR (1U << 5)
#define FLASH_SR_PGPERR (1U << 6)
#define FLASH_SR_PGSERR (1U << 7)
#define FLASH_SR_BSY    (1U << 16)

#define FLASH_CR_PG       (1U << 0)
#define FLASH_CR_SER      (1U << 1)
#define FLASH_CR_MER      (1U << 2)
#define FLASH_CR_SNB(n)   ((uint32_t)(n) << 3)
#define FLASH_CR_PSIZE(n) ((uint32_t)(n) << 8)
#define FLASH_CR_STRT     (1U << 16)
#define FLASH_CR_EOPIE    (1U << 24)
#define FLASH_CR_LOCK     (1U << 31)

/* ---- Pins (§8) ---- */

struct stm32_gpio {
    uint32_t MODER;
    uint32_t OTYPER;
    uint32_t OSPEEDR;
    uint32_t PUPDR;
    uint32_t IDR;
    uint32_t ODR;
    uint32_t BSRR;
    uint32_t LCKR;
    uint32_t AFRL;
    uint32_t AFRH;
};

/* ---- Timers (§17 TIM1 and TIM8, §18 TIM2 to TIM5) ---- */

struct stm32_tim {
    uint32_t CR1;
    uint32_t CR2;
    uint32_t SMCR;
    uint32_t DIER;
    uint32_t SR;
    uint32_t EGR;
    uint32_t CCMR1;
    uint32_t CCMR2;
    uint32_t CCER;
    uint32_t CNT;
    uint32_t PSC;
    uint32_t ARR;
    uint32_t RCR;
    uint32_t CCR1;
    uint32_t CCR2;
    uint32_t CCR3;
    uint32_t CCR4;
    uint32_t BDTR;
    uint32_t DCR;
    uint32_t DMAR;
};

#define TIM_CR1_CEN    (1U << 0)
#define TIM_CR1_UDIS   (1U << 1)
#define TIM_CR1_CMS(n) ((uint32_t)(n) << 5)
#define TIM_CR1_ARPE   (1U << 7)

#define TIM_CR2_MMS(n) ((uint32_t)(n) << 4)

#define TIM_SMCR_SMS(n) ((uint32_t)(n) << 0)
#define TIM_SMCR_TS(n)  ((uint32_t)(n) << 4)

#define TIM_SR_BIF (1U << 7)

#define TIM_EGR_UG (1U << 0)

#define TIM_CCMR1_CC1S(n) ((uint32_t)(n) << 0)
#define TIM_CCMR1_CC2S(n) ((uint32_t)(n) << 8)
#define TIM_CCMR1_OC1PE   (1U << 3)
#define TIM_CCMR1_OC1M(n) ((uint32_t)(n) << 4)
#define TIM_CCMR1_OC2PE   (1U << 11)
#define TIM_CCMR1_OC2M(n) ((uint32_t)(n) << 12)
#define TIM_CCMR1_IC1F(n) ((uint32_t)(n) << 4)
#define TIM_CCMR1_IC2F(n) ((uint32_t)(n) << 12)
#define TIM_CCMR2_OC4M(n) ((uint32_t)(n) << 12)

#define TIM_CCER_CC1E  (1U << 0)
#define TIM_CCER_CC1P  (1U << 1)
#define TIM_CCER_CC1NE (1U << 2)
#define TIM_CCER_CC2E  (1U << 4)
#define TIM_CCER_CC2NE (1U << 6)
#define TIM_CCER_CC4E  (1U << 12)

#define TIM_BDTR_DTG(n)  ((uint32_t)(n) << 0)
#define TIM_BDTR_LOCK(n) ((uint32_t)(n) << 8)
#define TIM_BDTR_OSSI    (1U << 10)
#define TIM_BDTR_BKE     (1U << 12)
#define TIM_BDTR_MOE     (1U << 15)

/* ---- Analog-to-digital converter (§13) ---- */

struct stm32_adc {
    uint32_t SR;
    uint32_t CR1;
    uint32_t CR2;
    uint32_t SMPR1;
    uint32_t SMPR2;
    uint32_t JOFR1;
    uint32_t JOFR2;
    uint32_t JOFR3;
    uint32_t JOFR4;
    uint32_t HTR;
    uint32_t LTR;
    uint32_t SQR1;
    uint32_t SQR2;
    uint32_t SQR3;
    uint32_t JSQR;
    uint32_t JDR1;
    uint32_t JDR2;
    uint32_t JDR3;
    uint32_t JDR4;
    uint32_t DR;
};

struct stm32_adc_common {
    uint32_t CSR;
    uint32_t CCR;
    uint32_t CDR;
};

#define ADC_SR_JEOC  (1U << 2)
#define ADC_SR_JSTRT (1U << 3)

#define ADC_CR1_JEOCIE (1U << 7)
#define ADC_CR1_SCAN   (1U << 8)

#define ADC_CR2_ADON       (1U << 0)
#define ADC_CR2_JEXTSEL(n) ((uint32_t)(n) << 16)
#define ADC_CR2_JEXTEN(n)  ((uint32_t)(n) << 20)
#define ADC_CR2_JSWSTART   (1U << 22)

#define ADC_SMPR1_SMP10(n) ((uint32_t)(n) << 0)
#define ADC_SMPR1_SMP11(n) ((uint32_t)(n) << 3)
#define ADC_SMPR1_SMP12(n) ((uint32_t)(n) << 6)

#define ADC_JSQR_JSQ2(n) ((uint32_t)(n) << 5)
#define ADC_JSQR_JSQ3(n) ((uint32_t)(n) << 10)
#define ADC_JSQR_JSQ4(n) ((uint32_t)(n) << 15)
#define ADC_JSQR_JL(n)   ((uint32_t)(n) << 20)

#define ADC_CCR_ADCPRE(n) ((uint32_t)(n) << 16)

/* ---- DMA controller (§10) ---- */

struct stm32_dma_stream {
    uint32_t CR;
    uint32_t NDTR;
    uint32_t PAR;
    uint32_t M0AR;
    uint32_t M1AR;
    uint32_t FCR;
};

struct stm32_dma {
    uint32_t LISR;
    uint32_t HISR;
    uint32_t LIFCR;
    uint32_t HIFCR;
    struct stm32_dma_stream S[8];
};

#define DMA_LISR_FEIF0  (1U << 0)
#define DMA_LISR_DMEIF0 (1U << 2)
#define DMA_LISR_TEIF0  (1U << 3)
#define DMA_LISR_HTIF0  (1U << 4)
#define DMA_LISR_TCIF0  (1U << 5)

#define DMA_LIFCR_CFEIF0  (1U << 0)
#define DMA_LIFCR_CDMEIF0 (1U << 2)
#define DMA_LIFCR_CTEIF0  (1U << 3)
#define DMA_LIFCR_CHTIF0  (1U << 4)
#define DMA_LIFCR_CTCIF0  (1U << 5)
#define DMA_LIFCR_CFEIF3  (1U << 22)
#define DMA_LIFCR_CDMEIF3 (1U << 24)
#define DMA_LIFCR_CTEIF3  (1U << 25)
#define DMA_LIFCR_CHTIF3  (1U << 26)
#define DMA_LIFCR_CTCIF3  (1U << 27)

#define DMA_CR_EN       (1U << 0)
#define DMA_CR_TEIE     (1U << 2)
#define DMA_CR_TCIE     (1U << 4)
#define DMA_CR_DIR(n)   ((uint32_t)(n) << 6)
#define DMA_CR_MINC     (1U << 10)
#define DMA_CR_PL(n)    ((uint32_t)(n) << 16)
#define DMA_CR_CHSEL(n) ((uint32_t)(n) << 25)

/* ---- SPI (§28) ---- */

struct stm32_spi {
    uint32_t CR1;
    uint32_t CR2;
    uint32_t SR;
    uint32_t DR;
};

#define SPI_CR1_CPHA  (1U << 0)
#define SPI_CR1_CPOL  (1U << 1)
#define SPI_CR1_MSTR  (1U << 2)
#define SPI_CR1_BR(n) ((uint32_t)(n) << 3)
#define SPI_CR1_SPE   (1U << 6)
#define SPI_CR1_SSI   (1U << 8)
#define SPI_CR1_SSM   (1U << 9)

#define SPI_CR2_RXDMAEN (1U << 0)
#define SPI_CR2_TXDMAEN (1U << 1)

#define SPI_SR_RXNE (1U << 0)
#define SPI_SR_TXE  (1U << 1)
#define SPI_SR_BSY  (1U << 7)

/* ---- bxCAN (§32) ---- */

struct stm32_can_mailbox {
    uint32_t IR;  /* TIxR, RIxR */
    uint32_t DTR; /* TDTxR, RDTxR */
    uint32_t DLR; /* TDLxR, RDLxR */
    uint32_t DHR; /* TDHxR, RDHxR */
};

struct stm32_can_filter {
    uint32_t R1; /* FiR1 */
    uint32_t R2; /* FiR2 */
};

struct stm32_can {
    uint32_t MCR;
    uint32_t MSR;
    uint32_t TSR;
    uint32_t RF0R;
    uint32_t RF1R;
    uint32_t IER;
    uint32_t ESR;
    uint32_t BTR;
    uint32_t reserved_020[88];
    struct stm32_can_mailbox T[3];
    struct stm32_can_mailbox R[2];
    uint32_t reserved_1d0[12];
    uint32_t FMR;
    uint32_t FM1R;
    uint32_t reserved_208;
    uint32_t FS1R;
    uint32_t reserved_210;
    uint32_t FFA1R;
    uint32_t reserved_218;
    uint32_t FA1R;
    uint32_t reserved_220[8];
    struct stm32_can_filter F[28];
};

#define CAN_MCR_INRQ  (1U << 0)
#define CAN_MCR_SLEEP (1U << 1)
#define CAN_MCR_TXFP  (1U << 2)
#define CAN_MCR_RFLM  (1U << 3)
#define CAN_MCR_ABOM  (1U << 6)

#define CAN_MSR_INAK (1U << 0)
#define CAN_MSR_SLAK (1U << 1)
#define CAN_MSR_ERRI (1U << 2)

#define CAN_TSR_RQCP0   (1U << 0)
#define CAN_TSR_ABRQ0   (1U << 7)
#define CAN_TSR_RQCP1   (1U << 8)
#define CAN_TSR_ABRQ1   (1U << 15)
#define CAN_TSR_RQCP2   (1U << 16)
#define CAN_TSR_ABRQ2   (1U << 23)
#define CAN_TSR_CODE(n) ((uint32_t)(n) << 24)
#define CAN_TSR_TME0    (1U << 26)
#define CAN_TSR_TME1    (1U << 27)
#define CAN_TSR_TME2    (1U << 28)

#define CAN_RF0R_FMP0(n) ((uint32_t)(n) << 0)
#define CAN_RF0R_FOVR0   (1U << 4)
#define CAN_RF0R_RFOM0   (1U << 5)

#define CAN_IER_TMEIE  (1U << 0)
#define CAN_IER_FMPIE0 (1U << 1)
#define CAN_IER_FOVIE0 (1U << 3)
#define CAN_IER_BOFIE  (1U << 10)
#define CAN_IER_ERRIE  (1U << 15)

#define CAN_ESR_BOFF (1U << 2)

#define CAN_BTR_BRP(n) ((uint32_t)(n) << 0)
#define CAN_BTR_TS1(n) ((uint32_t)(n) << 16)
#define CAN_BTR_TS2(n) ((uint32_t)(n) << 20)
#define CAN_BTR_SJW(n) ((uint32_t)(n) << 24)

#define CAN_TIR_TXRQ    (1U << 0)
#define CAN_TIR_STID(n) ((uint32_t)(n) << 21)
#define CAN_RIR_RTR     (1U << 1)
#define CAN_RIR_IDE     (1U << 2)
#define CAN_RIR_STID(n) ((uint32_t)(n) << 21)
#define CAN_TDTR_DLC(n) ((uint32_t)(n) << 0)
#define CAN_RDTR_DLC(n) ((uint32_t)(n) << 0)

#define CAN_FMR_FINIT (1U << 0)

/* ---- USART (§30) ---- */

struct stm32_usart {
    uint32_t SR;
    uint32_t DR;
    uint32_t BRR;
    uint32_t CR1;
    uint32_t CR2;
    uint32_t CR3;
    uint32_t GTPR;
};

#define USART_SR_ORE  (1U << 3)
#define USART_SR_RXNE (1U << 5)
#define USART_SR_TC   (1U << 6)
#define USART_SR_TXE  (1U << 7)

#define USART_CR1_RE     (1U << 2)
#define USART_CR1_TE     (1U << 3)
#define USART_CR1_RXNEIE (1U << 5)
#define USART_CR1_TCIE   (1U << 6)
#define USART_CR1_TXEIE  (1U << 7)
#define USART_CR1_UE     (1U << 13)

/* ---- External interrupts (§12) ---- */

struct stm32_exti {
    uint32_t IMR;
    uint32_t EMR;
    uint32_t RTSR;
    uint32_t FTSR;
    uint32_t SWIER;
    uint32_t PR;
};

/** The supply's voltage detector is line 16. */
#define EXTI_LINE_SUPPLY (1U << 16)

/* ---- Independent watchdog (§21) ---- */

struct stm32_iwdg {
    uint32_t KR;
    uint32_t PR;
    uint32_t RLR;
    uint32_t SR;
};

#define IWDG_SR_PVU (1U << 0)
#define IWDG_SR_RVU (1U << 1)

/** Positions in the vector table (RM0090 table 62). */
enum stm32_irq {
    PVD_IRQn = 1,
    ADC_IRQn = 18,
    CAN1_TX_IRQn = 19,
    CAN1_RX0_IRQn = 20,
    CAN1_SCE_IRQn = 22,
    USART1_IRQn = 37,
    DMA2_Stream0_IRQn = 56
};

/* ---- The peripherals; their addresses are in peripherals.ld ---- */

extern volatile struct stm32_rcc RCC;
extern volatile struct stm32_pwr PWR;
extern volatile struct stm32_flash FLASH;
extern volatile struct stm32_gpio GPIOA;
extern volatile struct stm32_gpio GPIOB;
extern volatile struct stm32_gpio GPIOC;
extern volatile struct stm32_gpio GPIOD;
extern volatile struct stm32_gpio GPIOE;
extern volatile struct stm32_tim TIM1;
extern volatile struct stm32_tim TIM2;
extern volatile struct stm32_tim TIM3;
extern volatile struct stm32_tim TIM4;
extern volatile struct stm32_tim TIM5;
extern volatile struct stm32_tim TIM8;
extern volatile struct stm32_adc ADC1;
extern volatile struct stm32_adc_common ADC;
extern volatile struct stm32_dma DMA2;
extern volatile struct stm32_spi SPI1;
extern volatile struct stm32_can CAN1;
extern volatile struct stm32_usart USART1;
extern volatile struct stm32_exti EXTI;
extern volatile struct stm32_iwdg IWDG;

#endif
