#include "hal/stm32f4/imu.h"

#include "hal/stm32f4/board.h"
#include "hal/stm32f4/stm32f405.h"
#include "hal/stm32f4/wait.h"

/* Registers of the sensor (RM-MPU-6500A). */
#define SMPLRT_DIV        0x19U
#define CONFIG            0x1AU
#define GYRO_CONFIG       0x1BU
#define ACCEL_CONFIG      0x1CU
#define ACCEL_CONFIG_2    0x1DU
#define ACCEL_XOUT_H      0x3BU
#define SIGNAL_PATH_RESET 0x68U
#define USER_CTRL         0x6AU
#define PWR_MGMT_1        0x6BU
#define WHO_AM_I          0x75U

#define READ 0x80U /* in the address byte */

#define DEVICE_RESET     0x80U
#define RESET_ALL_PATHS  0x07U
#define RESET_US         100000U
#define IDENTITY_MPU6500 0x70U
#define IDENTITY_MPU9250 0x71U

#define ATTEMPTS   10U
#define ATTEMPT_US 1000U
#define BYTE_POLLS 10000U /* a byte at 125 kHz is 64 µs */

/* Fields of the registers. */
#define BR_128        6U /* 656 kHz; other registers than samples take up to 1 MHz */
#define BR_8          2U /* 10.5 MHz; samples take up to 20 MHz */
#define DMA_CHANNEL_3 3U
#define DIR_FROM_SPI  0U
#define DIR_TO_SPI    1U
#define PRIORITY_HIGH 2U
#define MASTER        (SPI_CR1_MSTR | SPI_CR1_SSM | SPI_CR1_SSI | SPI_CR1_CPOL | SPI_CR1_CPHA)
#define STREAM_IN     DMA2.S[0]
#define STREAM_OUT    DMA2.S[3]
#define STREAM_IN_MODE                                                                                                 \
    (DMA_CR_CHSEL(DMA_CHANNEL_3) | DMA_CR_PL(PRIORITY_HIGH) | DMA_CR_MINC | DMA_CR_TCIE | DMA_CR_TEIE)
#define STREAM_OUT_MODE (DMA_CR_CHSEL(DMA_CHANNEL_3) | DMA_CR_DIR(DIR_TO_SPI) | DMA_CR_MINC)
#define FLAGS_OF_BOTH                                                                                                  \
    (DMA_LIFCR_CFEIF0 | DMA_LIFCR_CDMEIF0 | DMA_LIFCR_CTEIF0 | DMA_LIFCR_CHTIF0 | DMA_LIFCR_CTCIF0 |                   \
     DMA_LIFCR_CFEIF3 | DMA_LIFCR_CDMEIF3 | DMA_LIFCR_CTEIF3 | DMA_LIFCR_CHTIF3 | DMA_LIFCR_CTCIF3)

struct setting {
    uint8_t address;
    uint8_t value;
};

static const struct setting settings[] = {
    {PWR_MGMT_1, 0x01},     /* awake, clock from the gyroscope */
    {USER_CTRL, 0x10},      /* SPI only */
    {SMPLRT_DIV, 0x00},     /* 1 kHz */
    {CONFIG, 0x01},         /* gyroscope filtered to 184 Hz */
    {GYRO_CONFIG, 0x08},    /* ±500 °/s */
    {ACCEL_CONFIG, 0x08},   /* ±4 g */
    {ACCEL_CONFIG_2, 0x01}, /* accelerometer filtered to 184 Hz */
};

/* Byte by byte, for the configuration. */

static void select(bool selected)
{
    jp_pin_set(BOARD_IMU_SELECT, !selected);
}

static bool exchange(uint8_t sent, uint8_t *received)
{
    if (!jp_wait_for(&SPI1.SR, SPI_SR_TXE, SPI_SR_TXE, BYTE_POLLS)) {
        return false;
    }
    SPI1.DR = sent;
    if (!jp_wait_for(&SPI1.SR, SPI_SR_RXNE, SPI_SR_RXNE, BYTE_POLLS)) {
        return false;
    }
    *received = (uint8_t)SPI1.DR;
    return true;
}

static bool access_register(uint8_t address, uint8_t sent, uint8_t *received)
{
    bool done;

    select(true);
    done = exchange(address, received) && exchange(sent, received) && jp_wait_for(&SPI1.SR, SPI_SR_BSY, 0, BYTE_POLLS);
    select(false);
    return done;
}

static bool write_register(uint8_t address, uint8_t value)
{
    uint8_t ignored;

    return access_register(address, value, &ignored);
}

static bool read_register(uint8_t address, uint8_t *value)
{
    return access_register(address | READ, 0, value);
}

static bool has(struct setting setting)
{
    uint8_t value;

    return read_register(setting.address, &value) && value == setting.value;
}

static bool has_settings(void)
{
    for (unsigned i = 0; i < sizeof settings / sizeof settings[0]; i++) {
        if (!has(settings[i])) {
            return false;
        }
    }
    return true;
}

static bool takes_settings(void)
{
    for (unsigned i = 0; i < sizeof settings / sizeof settings[0]; i++) {
        if (!write_register(settings[i].address, settings[i].value)) {
            return false;
        }
    }
    return has_settings();
}

static bool is_known(uint8_t identity)
{
    return identity == IDENTITY_MPU6500 || identity == IDENTITY_MPU9250;
}

static bool answers(void)
{
    uint8_t identity;

    for (unsigned i = 0; i < ATTEMPTS; i++) {
        if (read_register(WHO_AM_I, &identity) && is_known(identity)) {
            return true;
        }
        jp_wait_us(ATTEMPT_US);
    }
    return false;
}

static bool resets(void)
{
    if (!write_register(PWR_MGMT_1, DEVICE_RESET)) {
        return false;
    }
    jp_wait_us(RESET_US);
    if (!write_register(SIGNAL_PATH_RESET, RESET_ALL_PATHS)) {
        return false;
    }
    jp_wait_us(RESET_US);
    return true;
}

static void start_spi(void)
{
    jp_pin_output(BOARD_IMU_SELECT);
    jp_pin_drive(BOARD_IMU_CLOCK);
    jp_pin_listen(BOARD_IMU_DATA_OUT);
    jp_pin_drive(BOARD_IMU_DATA_IN);
    RCC.APB2ENR |= RCC_APB2ENR_SPI1EN;
    SPI1.CR1 = MASTER | SPI_CR1_BR(BR_128);
    SPI1.CR1 = MASTER | SPI_CR1_BR(BR_128) | SPI_CR1_SPE;
}

/* Sample by sample, by DMA. */

static uint32_t address_of(const volatile void *memory)
{
    return (uint32_t)(uintptr_t)memory;
}

static void start_transfers(struct jp_imu *imu)
{
    imu->sent[0] = ACCEL_XOUT_H | READ;
    RCC.AHB1ENR |= RCC_AHB1ENR_DMA2EN;
    STREAM_IN.PAR = address_of(&SPI1.DR);
    STREAM_IN.M0AR = address_of(imu->received);
    STREAM_OUT.PAR = address_of(&SPI1.DR);
    STREAM_OUT.M0AR = address_of(imu->sent);
    SPI1.CR1 = MASTER | SPI_CR1_BR(BR_8);
    SPI1.CR2 = SPI_CR2_RXDMAEN | SPI_CR2_TXDMAEN;
    SPI1.CR1 = MASTER | SPI_CR1_BR(BR_8) | SPI_CR1_SPE;
}

enum jp_status jp_imu_start(struct jp_imu *imu)
{
    *imu = (struct jp_imu){.state = JP_IMU_ABSENT};
    start_spi();
    /* After a reset in motion there is no time for one of the sensor, which goes on as it was. */
    if (!(answers() && has_settings()) && !(resets() && answers() && takes_settings())) {
        return JP_ERR_HARDWARE;
    }
    start_transfers(imu);
    imu->state = JP_IMU_READY;
    return JP_OK;
}

static void stop_transfer(void)
{
    STREAM_OUT.CR = STREAM_OUT_MODE;
    STREAM_IN.CR = STREAM_IN_MODE;
    select(false);
}

enum jp_status jp_imu_request(struct jp_imu *imu)
{
    if (imu->state == JP_IMU_ABSENT) {
        return JP_ERR_HARDWARE;
    }
    if (imu->state == JP_IMU_BUSY) {
        stop_transfer();
        imu->state = JP_IMU_ABSENT;
        return JP_ERR_HARDWARE;
    }
    imu->state = JP_IMU_BUSY;
    select(true);
    DMA2.LIFCR = FLAGS_OF_BOTH;
    STREAM_IN.NDTR = sizeof imu->received;
    STREAM_OUT.NDTR = sizeof imu->sent;
    STREAM_IN.CR = STREAM_IN_MODE | DMA_CR_EN;
    STREAM_OUT.CR = STREAM_OUT_MODE | DMA_CR_EN;
    return JP_OK;
}

void jp_imu_on_transfer(struct jp_imu *imu)
{
    const uint32_t flags = DMA2.LISR;

    if (imu->state != JP_IMU_BUSY || (flags & (DMA_LISR_TCIF0 | DMA_LISR_TEIF0)) == 0U) {
        return;
    }
    stop_transfer();
    DMA2.LIFCR = FLAGS_OF_BOTH;
    imu->state = (flags & DMA_LISR_TEIF0) == 0U ? JP_IMU_FRESH : JP_IMU_READY;
}

/* Bytes to measurements. */

static int32_t number_at(const uint8_t *raw)
{
    return (int16_t)(uint16_t)((raw[0] << 8) | raw[1]);
}

static int32_t acceleration(const uint8_t *raw, unsigned axis)
{
    return number_at(&raw[2U * axis]);
}

static int32_t rate(const uint8_t *raw, unsigned axis)
{
    return number_at(&raw[8U + 2U * axis]);
}

/** A step is 500/32768 °/s: 711 1/9 of 2⁻²⁴ turn/s. */
static jp_q24 turns_per_second(int32_t steps)
{
    const int32_t ninth = 7282; /* of 2¹⁶ */

    return steps * 711 + ((steps * ninth + (1 << 15)) >> 16);
}

/** A step is 4/32768 g: 2048 of 2⁻²⁴ g. */
static jp_q24 gravities(int32_t steps)
{
    return steps * 2048;
}

void jp_imu_decode(const uint8_t raw[JP_IMU_SAMPLE_BYTES], struct jp_sensors *sensors)
{
    sensors->accel_x = gravities(BOARD_IMU_X_SIGN * acceleration(raw, BOARD_IMU_X_AXIS));
    sensors->accel_z = gravities(BOARD_IMU_Z_SIGN * acceleration(raw, BOARD_IMU_Z_AXIS));
    sensors->pitch_rate = turns_per_second(BOARD_IMU_Y_SIGN * rate(raw, BOARD_IMU_Y_AXIS));
    sensors->yaw_rate = turns_per_second(BOARD_IMU_Z_SIGN * rate(raw, BOARD_IMU_Z_AXIS));
}

/** Nobody drives the line, or the sensor sleeps: all bits of what is used are alike. */
static bool is_silent(const uint8_t *raw)
{
    const int32_t first = acceleration(raw, BOARD_IMU_X_AXIS);

    return (first == 0 || first == -1) && acceleration(raw, BOARD_IMU_Z_AXIS) == first &&
           rate(raw, BOARD_IMU_Y_AXIS) == first && rate(raw, BOARD_IMU_Z_AXIS) == first;
}

enum jp_status jp_imu_read(struct jp_imu *imu, struct jp_sensors *sensors)
{
    const uint8_t *raw = &imu->received[1];

    if (imu->state != JP_IMU_FRESH) {
        return JP_ERR_HARDWARE;
    }
    imu->state = JP_IMU_READY;
    if (is_silent(raw)) {
        return JP_ERR_HARDWARE;
    }
    jp_imu_decode(raw, sensors);
    return JP_OK;
}
