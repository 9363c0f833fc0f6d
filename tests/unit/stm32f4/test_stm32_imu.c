/* The inertial sensor: absent, mute, garbage, stuck; transfers that do not end; every value of every channel. */
#include "hal/stm32f4/imu.h"

#include <string.h>

#include "hal/stm32f4/board.h"
#include "tests/support/stm32_fake.h"

#include "unity.h"

#define WHO_AM_I   0x75
#define PWR_MGMT_1 0x6B

static struct jp_imu imu;
static struct jp_sensors sensors;

static const uint8_t wanted[][2] = {
    {0x6B, 0x01}, {0x6A, 0x10}, {0x19, 0x00}, {0x1A, 0x01}, {0x1B, 0x08}, {0x1C, 0x08}, {0x1D, 0x01},
};

#define SETTINGS (sizeof wanted / sizeof wanted[0])

void setUp(void)
{
    stm32_fake_reset();
    fake.imu_registers[PWR_MGMT_1] = 0x40; /* asleep, as after power-up */
    imu = (struct jp_imu){.state = JP_IMU_ABSENT};
    sensors = (struct jp_sensors){.pitch_rate = 1, .yaw_rate = 2, .accel_x = 3, .accel_z = 4};
}

void tearDown(void)
{
}

static void check_absent(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, jp_imu_start(&imu));
    TEST_ASSERT_EQUAL_INT(JP_IMU_ABSENT, imu.state);
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, jp_imu_request(&imu));
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, jp_imu_read(&imu, &sensors));
    TEST_ASSERT_EQUAL_HEX32(0, DMA2.S[0].CR | DMA2.S[3].CR);
}

/* ---- Start ---- */

static void test_start_resets_and_configures(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_imu_start(&imu));
    TEST_ASSERT_EQUAL_INT(JP_IMU_READY, imu.state);
    TEST_ASSERT_EQUAL_HEX8(PWR_MGMT_1, fake.imu_writes[0][0]);
    TEST_ASSERT_EQUAL_HEX8(0x80, fake.imu_writes[0][1]);
    for (unsigned i = 0; i < SETTINGS; i++) {
        TEST_ASSERT_EQUAL_HEX8(wanted[i][1], fake.imu_registers[wanted[i][0]]);
    }
    TEST_ASSERT_TRUE(fake.waited_us >= 200000U && fake.waited_us < 300000U);
}

/* After a reset of the controller alone it must be quick. */
static void test_a_sensor_that_is_configured_is_not_reset(void)
{
    for (unsigned i = 0; i < SETTINGS; i++) {
        fake.imu_registers[wanted[i][0]] = wanted[i][1];
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_imu_start(&imu));
    TEST_ASSERT_EQUAL_UINT(0, fake.imu_write_count);
    TEST_ASSERT_TRUE(fake.waited_us < 2000U);
}

static void test_one_setting_that_is_lost_makes_a_reset(void)
{
    for (unsigned lost = 0; lost < SETTINGS; lost++) {
        stm32_fake_reset();
        for (unsigned i = 0; i < SETTINGS; i++) {
            fake.imu_registers[wanted[i][0]] = wanted[i][1];
        }
        fake.imu_registers[wanted[lost][0]] ^= 0x20;
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_imu_start(&imu));
        TEST_ASSERT_EQUAL_UINT(2 + SETTINGS, fake.imu_write_count);
        TEST_ASSERT_EQUAL_HEX8(wanted[lost][1], fake.imu_registers[wanted[lost][0]]);
    }
}

static void test_the_family(void)
{
    for (unsigned identity = 0; identity <= 0xFFU; identity++) {
        stm32_fake_reset();
        fake.imu_registers[WHO_AM_I] = (uint8_t)identity;
        TEST_ASSERT_EQUAL_INT(identity == 0x70U || identity == 0x71U ? JP_OK : JP_ERR_HARDWARE, jp_imu_start(&imu));
    }
}

static void test_absent(void)
{
    fake.imu_absent = true;
    check_absent();
    TEST_ASSERT_TRUE(fake.waited_us < 300000U);
}

static void test_line_to_ground(void)
{
    fake.imu_registers[WHO_AM_I] = 0;
    check_absent();
}

static void test_attempts_are_bounded(void)
{
    fake.imu_mute_reads = FAKE_NEVER;
    check_absent();
    TEST_ASSERT_EQUAL_UINT(20, fake.identity_reads);
}

static void test_a_sensor_that_answers_late(void)
{
    for (unsigned reads = 0; reads < 20U; reads++) {
        stm32_fake_reset();
        fake.imu_mute_reads = reads;
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_imu_start(&imu));
    }
    stm32_fake_reset();
    fake.imu_mute_reads = 20;
    check_absent();
}

static void test_a_register_that_does_not_take_its_value(void)
{
    for (unsigned i = 0; i < SETTINGS; i++) {
        stm32_fake_reset();
        fake.imu_stuck_register = wanted[i][0];
        fake.imu_registers[wanted[i][0]] = (uint8_t)~wanted[i][1];
        check_absent();
    }
}

/* 10 attempts to find the sensor, then one to reset it. */
static void check_spi_fails(void)
{
    check_absent();
    TEST_ASSERT_EQUAL_UINT(11, fake.failed_waits);
    TEST_ASSERT_EQUAL_HEX32(1U << 15, GPIOA.BSRR); /* deselected */
}

static void test_spi_that_never_ends(void)
{
    fake.spi_byte = FAKE_NEVER;
    check_spi_fails();
}

static void test_spi_that_takes_nothing(void)
{
    fake.spi_stays_full = true;
    check_spi_fails();
}

static void test_spi_that_stays_busy(void)
{
    fake.spi_stays_busy = true;
    check_spi_fails();
}

static void test_spi_is_slow_for_registers_and_fast_for_samples(void)
{
    fake.imu_absent = true;
    (void)jp_imu_start(&imu);
    TEST_ASSERT_TRUE(84000000U / (2U << ((SPI1.CR1 >> 3) & 7U)) <= 1000000U);

    stm32_fake_reset();
    (void)jp_imu_start(&imu);
    TEST_ASSERT_TRUE(84000000U / (2U << ((SPI1.CR1 >> 3) & 7U)) <= 20000000U);
    CHECK_SET(SPI_CR1_MSTR | SPI_CR1_SSM | SPI_CR1_SSI | SPI_CR1_CPOL | SPI_CR1_CPHA | SPI_CR1_SPE, SPI1.CR1);
    CHECK_SET(SPI_CR2_RXDMAEN | SPI_CR2_TXDMAEN, SPI1.CR2);
}

/* ---- Transfers ---- */

static void started(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_imu_start(&imu));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_imu_request(&imu));
}

static const uint8_t upright[JP_IMU_SAMPLE_BYTES] = {0, 0, 0, 0, 0x20, 0x00, 0x0B, 0xB8, 0, 1, 0, 2, 0, 3};

static void transfer(const uint8_t bytes[JP_IMU_SAMPLE_BYTES])
{
    imu.received[0] = 0xFF;
    memcpy(&imu.received[1], bytes, JP_IMU_SAMPLE_BYTES);
    DMA2.LISR = DMA_LISR_TCIF0;
    jp_imu_on_transfer(&imu);
    DMA2.LISR = 0;
}

static uint32_t address_of(const volatile void *memory)
{
    return (uint32_t)(uintptr_t)memory;
}

static void test_a_request_starts_both_streams(void)
{
    started();
    TEST_ASSERT_EQUAL_INT(JP_IMU_BUSY, imu.state);
    TEST_ASSERT_EQUAL_HEX32(0x10000U << 15, GPIOA.BSRR); /* selected */
    CHECK_SET(RCC_AHB1ENR_DMA2EN, RCC.AHB1ENR);

    TEST_ASSERT_EQUAL_HEX32(DMA_CR_CHSEL(3) | DMA_CR_PL(2) | DMA_CR_MINC | DMA_CR_TCIE | DMA_CR_TEIE | DMA_CR_EN,
                            DMA2.S[0].CR);
    TEST_ASSERT_EQUAL_HEX32(DMA_CR_CHSEL(3) | DMA_CR_DIR(1) | DMA_CR_MINC | DMA_CR_EN, DMA2.S[3].CR);
    for (unsigned stream = 0; stream <= 3U; stream += 3U) {
        TEST_ASSERT_EQUAL_UINT32(15, DMA2.S[stream].NDTR);
        TEST_ASSERT_EQUAL_HEX32(address_of(&SPI1.DR), DMA2.S[stream].PAR);
    }
    TEST_ASSERT_EQUAL_HEX32(address_of(imu.received), DMA2.S[0].M0AR);
    TEST_ASSERT_EQUAL_HEX32(address_of(imu.sent), DMA2.S[3].M0AR);
    TEST_ASSERT_EQUAL_HEX8(0x80 | 0x3B, imu.sent[0]);
}

static void test_old_flags_are_cleared_before_the_streams_start(void)
{
    started();
    TEST_ASSERT_EQUAL_HEX32(0x0F40003DU, DMA2.LIFCR);
}

static void test_a_sample_is_read_once(void)
{
    started();
    transfer(upright);
    TEST_ASSERT_EQUAL_INT(JP_IMU_FRESH, imu.state);
    TEST_ASSERT_EQUAL_HEX32(1U << 15, GPIOA.BSRR);
    CHECK_CLEAR(DMA_CR_EN, DMA2.S[0].CR | DMA2.S[3].CR);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_imu_read(&imu, &sensors));
    TEST_ASSERT_EQUAL_INT32(JP_Q24_ONE, sensors.accel_z);
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, jp_imu_read(&imu, &sensors));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_imu_request(&imu));
}

static void test_a_sample_that_nobody_read_is_replaced(void)
{
    started();
    transfer(upright);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_imu_request(&imu));
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, jp_imu_read(&imu, &sensors));
    transfer(upright);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_imu_read(&imu, &sensors));
}

static void check_untouched(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, jp_imu_read(&imu, &sensors));
    TEST_ASSERT_EQUAL_INT32(1, sensors.pitch_rate);
    TEST_ASSERT_EQUAL_INT32(2, sensors.yaw_rate);
    TEST_ASSERT_EQUAL_INT32(3, sensors.accel_x);
    TEST_ASSERT_EQUAL_INT32(4, sensors.accel_z);
}

static void test_no_sample_before_the_transfer_ends(void)
{
    (void)jp_imu_start(&imu);
    check_untouched();
    (void)jp_imu_request(&imu);
    check_untouched();
    TEST_ASSERT_EQUAL_INT(JP_IMU_BUSY, imu.state);
}

static void test_an_interrupt_that_software_pended_changes_nothing(void)
{
    (void)jp_imu_start(&imu);
    DMA2.LISR = DMA_LISR_TCIF0;
    jp_imu_on_transfer(&imu);
    TEST_ASSERT_EQUAL_INT(JP_IMU_READY, imu.state);

    (void)jp_imu_request(&imu);
    DMA2.LISR = 0;
    jp_imu_on_transfer(&imu);
    TEST_ASSERT_EQUAL_INT(JP_IMU_BUSY, imu.state);
    CHECK_SET(DMA_CR_EN, DMA2.S[0].CR);
}

static void test_an_error_of_the_transfer_loses_one_sample(void)
{
    started();
    DMA2.LISR = DMA_LISR_TEIF0;
    jp_imu_on_transfer(&imu);
    check_untouched();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_imu_request(&imu));
    transfer(upright);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_imu_read(&imu, &sensors));
}

static void test_a_transfer_that_never_ends_makes_the_sensor_absent(void)
{
    started();
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, jp_imu_request(&imu));
    TEST_ASSERT_EQUAL_INT(JP_IMU_ABSENT, imu.state);
    CHECK_CLEAR(DMA_CR_EN, DMA2.S[0].CR | DMA2.S[3].CR);
    TEST_ASSERT_EQUAL_HEX32(1U << 15, GPIOA.BSRR);
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, jp_imu_request(&imu));
    check_untouched();
}

static void check_silent(uint8_t level)
{
    uint8_t bytes[JP_IMU_SAMPLE_BYTES];

    memset(bytes, level, sizeof bytes);
    (void)jp_imu_request(&imu);
    transfer(bytes);
    check_untouched();
}

/* Unplugged, or asleep after a brown-out of its own. */
static void test_a_line_that_nobody_drives(void)
{
    (void)jp_imu_start(&imu);
    check_silent(0x00);
    check_silent(0xFF);
}

static void test_one_channel_that_moves_is_enough(void)
{
    static const unsigned used[] = {1, 5, 11, 13}; /* low bytes of acceleration x and z, rate y and z */

    (void)jp_imu_start(&imu);
    for (unsigned i = 0; i < 4U; i++) {
        uint8_t bytes[JP_IMU_SAMPLE_BYTES] = {0};

        bytes[used[i]] = 1;
        (void)jp_imu_request(&imu);
        transfer(bytes);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_imu_read(&imu, &sensors));
    }
}

/* ---- Values ---- */

static void put(uint8_t *bytes, unsigned index, int32_t value)
{
    bytes[2U * index] = (uint8_t)((uint32_t)value >> 8);
    bytes[2U * index + 1U] = (uint8_t)value;
}

/* 500/32768 °/s are 6400/9 of 2⁻²⁴ turn/s; 0.62 ulp. */
static void check_rate(int32_t steps, jp_q24 rate)
{
    const int32_t error = 9 * rate - 6400 * steps;

    TEST_ASSERT_TRUE(100 * error <= 9 * 62 && 100 * error >= -9 * 62);
}

/* Each channel has another value, so that one taken for another shows. */
static void test_every_value_of_every_channel(void)
{
    uint8_t bytes[JP_IMU_SAMPLE_BYTES];

    for (int32_t value = INT16_MIN; value <= INT16_MAX; value++) {
        const int16_t numbers[7] = {(int16_t)value,         (int16_t)(value ^ 1), (int16_t)(value ^ 0x5555),
                                    (int16_t)(value ^ 2),   (int16_t)(value ^ 4), (int16_t)(value ^ 0x3333),
                                    (int16_t)(value ^ 0xF0)};

        for (unsigned i = 0; i < 7U; i++) {
            put(bytes, i, numbers[i]);
        }
        jp_imu_decode(bytes, &sensors);
        TEST_ASSERT_EQUAL_INT32(BOARD_IMU_X_SIGN * 2048 * numbers[BOARD_IMU_X_AXIS], sensors.accel_x);
        TEST_ASSERT_EQUAL_INT32(BOARD_IMU_Z_SIGN * 2048 * numbers[BOARD_IMU_Z_AXIS], sensors.accel_z);
        check_rate(BOARD_IMU_Y_SIGN * numbers[4 + BOARD_IMU_Y_AXIS], sensors.pitch_rate);
        check_rate(BOARD_IMU_Z_SIGN * numbers[4 + BOARD_IMU_Z_AXIS], sensors.yaw_rate);
    }
}

/* ±500 °/s is 1.39 turn/s, ±4 g is beyond what the monitor takes. */
static void test_full_scale(void)
{
    uint8_t bytes[JP_IMU_SAMPLE_BYTES] = {0};

    put(bytes, BOARD_IMU_Z_AXIS, INT16_MAX);
    put(bytes, 4 + BOARD_IMU_Y_AXIS, INT16_MIN);
    jp_imu_decode(bytes, &sensors);
    TEST_ASSERT_EQUAL_INT32(BOARD_IMU_Z_SIGN * (4 * JP_Q24_ONE - 2048), sensors.accel_z);
    TEST_ASSERT_INT32_WITHIN(1, -BOARD_IMU_Y_SIGN * 23301689, sensors.pitch_rate); /* 500/360 turn/s */
}
