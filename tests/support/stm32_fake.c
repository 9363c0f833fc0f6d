#include "tests/support/stm32_fake.h"

#include <string.h>

#include "hal/cortex_m/cortex_m.h"
#include "hal/stm32f4/wait.h"

volatile struct stm32_rcc RCC;
volatile struct stm32_pwr PWR;
volatile struct stm32_flash FLASH;
volatile struct stm32_gpio GPIOA;
volatile struct stm32_gpio GPIOB;
volatile struct stm32_gpio GPIOC;
volatile struct stm32_gpio GPIOD;
volatile struct stm32_gpio GPIOE;
volatile struct stm32_tim TIM1;
volatile struct stm32_tim TIM2;
volatile struct stm32_tim TIM3;
volatile struct stm32_tim TIM4;
volatile struct stm32_tim TIM5;
volatile struct stm32_tim TIM8;
volatile struct stm32_adc ADC1;
volatile struct stm32_adc_common ADC;
volatile struct stm32_dma DMA2;
volatile struct stm32_spi SPI1;
volatile struct stm32_can CAN1;
volatile struct stm32_usart USART1;
volatile struct stm32_exti EXTI;
volatile struct stm32_iwdg IWDG;
volatile struct cortex_nvic NVIC;

struct stm32_fake fake;

#define CLEAR(peripheral) memset((void *)(uintptr_t) & (peripheral), 0, sizeof(peripheral))

/* Polls since each of them began. */
static struct {
    uint32_t crystal;
    uint32_t pll;
    uint32_t flash;
    uint32_t clock_switch;
    uint32_t can;
    uint32_t conversion;
    uint32_t spi_byte;
} since;

static uint8_t imu_address;
static bool imu_addressed;

void stm32_fake_reset(void)
{
    CLEAR(RCC);
    CLEAR(PWR);
    CLEAR(FLASH);
    CLEAR(GPIOA);
    CLEAR(GPIOB);
    CLEAR(GPIOC);
    CLEAR(GPIOD);
    CLEAR(GPIOE);
    CLEAR(TIM1);
    CLEAR(TIM2);
    CLEAR(TIM3);
    CLEAR(TIM4);
    CLEAR(TIM5);
    CLEAR(TIM8);
    CLEAR(ADC1);
    CLEAR(ADC);
    CLEAR(DMA2);
    CLEAR(SPI1);
    CLEAR(CAN1);
    CLEAR(USART1);
    CLEAR(EXTI);
    CLEAR(IWDG);
    CLEAR(NVIC);
    RCC.CR = RCC_CR_HSION | RCC_CR_HSIRDY;
    GPIOE.IDR = 1U << 2; /* the strap is open */
    CAN1.MCR = 0x00010002U;
    CAN1.TSR = CAN_TSR_TME0 | CAN_TSR_TME1 | CAN_TSR_TME2;

    memset(&since, 0, sizeof since);
    imu_addressed = false;
    fake = (struct stm32_fake){.crystal = 3,
                               .pll_on_crystal = 3,
                               .pll_on_internal = 3,
                               .flash = 3,
                               .clock_switch = 3,
                               .can_init = 3,
                               .can_join = 3,
                               .conversion = 3,
                               .spi_byte = 3,
                               .readings = {2048, 2048, 2708},
                               .imu_stuck_register = -1};
    fake.imu_registers[0x75] = 0x70;
}

static void set_bits(volatile uint32_t *reg, uint32_t mask, bool on)
{
    *reg = on ? *reg | mask : *reg & ~mask;
}

/* A condition that became true `after` polls ago or more. */
static bool has_passed(uint32_t *polls, bool running, uint32_t after)
{
    if (!running) {
        *polls = 0;
        return false;
    }
    if (after == FAKE_NEVER) {
        return false;
    }
    if (*polls < after) {
        (*polls)++;
    }
    return *polls >= after;
}

static void step_clocks(void)
{
    const bool on_crystal = (RCC.PLLCFGR & RCC_PLLCFGR_PLLSRC) != 0U;
    const bool has_source = !on_crystal || (RCC.CR & RCC_CR_HSERDY) != 0U;
    const bool wants_pll = (RCC.CFGR & RCC_CFGR_SW(3)) == RCC_CFGR_SW(2);
    bool runs_from_pll;

    set_bits(&RCC.CR, RCC_CR_HSERDY, has_passed(&since.crystal, (RCC.CR & RCC_CR_HSEON) != 0U, fake.crystal));
    set_bits(&RCC.CR, RCC_CR_PLLRDY,
             has_passed(&since.pll, (RCC.CR & RCC_CR_PLLON) != 0U && has_source,
                        on_crystal ? fake.pll_on_crystal : fake.pll_on_internal));
    runs_from_pll = has_passed(&since.clock_switch, wants_pll && (RCC.CR & RCC_CR_PLLRDY) != 0U, fake.clock_switch);
    RCC.CFGR = (RCC.CFGR & ~RCC_CFGR_SWS(3)) | RCC_CFGR_SWS(runs_from_pll ? 2 : 0);
    if (wants_pll && (FLASH.ACR & FLASH_ACR_LATENCY(7)) != FLASH_ACR_LATENCY(5)) {
        fake.fast_on_slow_flash = true;
    }
}

static bool flash_shows_latency(void)
{
    return has_passed(&since.flash, true, fake.flash);
}

static void step_can(void)
{
    const bool wants_init = (CAN1.MCR & CAN_MCR_INRQ) != 0U;
    const bool is_init = (CAN1.MSR & CAN_MSR_INAK) != 0U;

    if (has_passed(&since.can, wants_init != is_init, wants_init ? fake.can_init : fake.can_join)) {
        set_bits(&CAN1.MSR, CAN_MSR_INAK, wants_init);
    }
}

static void convert(void)
{
    const int32_t noise = fake.noise[fake.conversions % 4U];

    ADC1.JDR1 = (uint32_t)((int32_t)fake.readings[0] + noise);
    ADC1.JDR2 = (uint32_t)((int32_t)fake.readings[1] - noise);
    ADC1.JDR3 = fake.readings[2];
    ADC1.SR |= ADC_SR_JEOC;
    ADC1.CR2 &= ~ADC_CR2_JSWSTART;
    fake.conversions++;
}

static void step_adc(void)
{
    const bool is_on = (ADC1.CR2 & ADC_CR2_ADON) != 0U && (RCC.APB2ENR & RCC_APB2ENR_ADC1EN) != 0U;

    if (has_passed(&since.conversion, is_on && (ADC1.CR2 & ADC_CR2_JSWSTART) != 0U, fake.conversion)) {
        convert();
    }
}

static uint8_t imu_data(uint8_t sent)
{
    const uint8_t reg = imu_address & 0x7FU;

    if ((imu_address & 0x80U) == 0U) {
        if (fake.imu_write_count < FAKE_WRITES) {
            fake.imu_writes[fake.imu_write_count][0] = reg;
            fake.imu_writes[fake.imu_write_count][1] = sent;
            fake.imu_write_count++;
        }
        if (reg != fake.imu_stuck_register) {
            fake.imu_registers[reg] = sent;
        }
        return 0;
    }
    if (reg == 0x75U && fake.identity_reads++ < fake.imu_mute_reads) {
        return 0;
    }
    return fake.imu_registers[reg];
}

/* Every access is two bytes: address and data. */
static uint8_t imu_answer(uint8_t sent)
{
    const bool is_selected = GPIOA.BSRR == 1U << (15 + 16);

    if (fake.imu_absent || !is_selected || (SPI1.CR1 & SPI_CR1_SPE) == 0U) {
        return 0xFF;
    }
    imu_addressed = !imu_addressed;
    if (imu_addressed) {
        imu_address = sent;
        return 0xFF;
    }
    return imu_data(sent);
}

/* The driver waits for TXE, writes, waits for RXNE, reads. */
static void step_spi(uint32_t mask)
{
    if (mask == SPI_SR_TXE) {
        SPI1.SR = fake.spi_stays_full ? 0 : SPI_SR_TXE;
        since.spi_byte = 0;
        return;
    }
    if (mask == SPI_SR_BSY) {
        set_bits(&SPI1.SR, SPI_SR_BSY, fake.spi_stays_busy);
        return;
    }
    if (has_passed(&since.spi_byte, true, fake.spi_byte) && (SPI1.SR & SPI_SR_RXNE) == 0U) {
        SPI1.DR = imu_answer((uint8_t)SPI1.DR);
        SPI1.SR |= SPI_SR_RXNE;
    }
}

static uint32_t poll(const volatile uint32_t *reg, uint32_t mask)
{
    fake.polls++;
    step_clocks();
    step_can();
    step_adc();
    if (reg == &SPI1.SR) {
        step_spi(mask);
    }
    if (reg == &FLASH.ACR && !flash_shows_latency()) {
        return *reg & ~FLASH_ACR_LATENCY(7);
    }
    return *reg;
}

bool jp_wait_for(const volatile uint32_t *reg, uint32_t mask, uint32_t value, uint32_t polls)
{
    for (uint32_t i = 0; i < polls; i++) {
        if ((poll(reg, mask) & mask) == value) {
            return true;
        }
    }
    fake.failed_waits++;
    if (polls > fake.longest_wait) {
        fake.longest_wait = polls;
    }
    return false;
}

void jp_wait_us(uint32_t us)
{
    TIM5.CNT += us;
    fake.waited_us += us;
}
