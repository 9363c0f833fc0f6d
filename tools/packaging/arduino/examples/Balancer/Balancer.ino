/*
 * A balancing robot with an MPU-6050 or MPU-6500 on I2C, two encoders and two H-bridges, on an ESP32 or RP2040. It
 * stands up when held upright with the switch closed, drives 1 m and back, and says over the serial line what each
 * route will take.
 *
 * The tables are those of courier24: make your robot's from its file (make gains, identify and learning) and name them
 * in `tables`, correct the constants below, and try it first with its wheels in the air.
 */
#include <Arduino.h>
#include <Wire.h>
#include <joulepath.h>

// ---- Your robot ----

static const struct jp_robot_config &tables = jp_robot_courier24;
static const struct jp_pilot_config driving = {.model = &jp_energy_model_courier24, .learning = &jp_learning_courier24};

enum Pins {
    ENCODER_LEFT_A = 2, ENCODER_LEFT_B = 3, ENCODER_RIGHT_A = 4, ENCODER_RIGHT_B = 5,
    LEFT_FORWARD = 6, LEFT_BACKWARD = 7, RIGHT_FORWARD = 8, RIGHT_BACKWARD = 9,
    ON_SWITCH = 10, // closed to ground: on
    CURRENT_LEFT = A0, CURRENT_RIGHT = A1, BUS_VOLTAGE = A2
};

static const float AMPERES_A_COUNT = 16.0f / 4096; // ±8 A about the middle
static const float VOLTS_A_COUNT = 36.0f / 4096;
enum { ADC_MIDDLE = 2048, PWM_BITS = 10, IMU_ADDRESS = 0x68 };

// ---- Encoders: four edges a line ----

struct Encoder {
    uint8_t a, b;
    volatile uint32_t count;
    volatile uint8_t before;
};

static Encoder left = {ENCODER_LEFT_A, ENCODER_LEFT_B, 0, 0};
static Encoder right = {ENCODER_RIGHT_A, ENCODER_RIGHT_B, 0, 0};

static void step(Encoder &encoder)
{
    static const int8_t moves[16] = {0, 1, -1, 0, -1, 0, 0, 1, 1, 0, 0, -1, 0, -1, 1, 0};
    const uint8_t now = (uint8_t)(digitalRead(encoder.a) << 1 | digitalRead(encoder.b));

    encoder.count = encoder.count + (uint32_t)(int32_t)moves[encoder.before << 2 | now];
    encoder.before = now;
}

static void step_left()
{
    step(left);
}

static void step_right()
{
    step(right);
}

static void begin_encoder(const Encoder &encoder, void (*handler)())
{
    pinMode(encoder.a, INPUT_PULLUP);
    pinMode(encoder.b, INPUT_PULLUP);
    attachInterrupt(digitalPinToInterrupt(encoder.a), handler, CHANGE);
    attachInterrupt(digitalPinToInterrupt(encoder.b), handler, CHANGE);
}

// ---- Inertial sensor: x forward, y left, z up; ±500 °/s, ±4 g ----

enum { IMU_GYRO_CONFIG = 0x1B, IMU_ACCEL_CONFIG = 0x1C, IMU_DATA = 0x3B, IMU_POWER = 0x6B, IMU_BYTES = 14 };

static bool write_imu(uint8_t address, uint8_t value)
{
    Wire.beginTransmission(IMU_ADDRESS);
    Wire.write(address);
    Wire.write(value);
    return Wire.endTransmission() == 0;
}

static bool begin_imu()
{
    Wire.begin();
    Wire.setClock(400000);
    return write_imu(IMU_POWER, 1) && write_imu(IMU_GYRO_CONFIG, 0x08) && write_imu(IMU_ACCEL_CONFIG, 0x08);
}

static bool read_imu(struct jp_sensors *sensors)
{
    int16_t values[IMU_BYTES / 2];

    Wire.beginTransmission(IMU_ADDRESS);
    Wire.write((uint8_t)IMU_DATA);
    if (Wire.endTransmission(false) != 0 || Wire.requestFrom((uint8_t)IMU_ADDRESS, (uint8_t)IMU_BYTES) != IMU_BYTES) {
        return false;
    }
    for (int16_t &value : values) {
        const int high = Wire.read();
        value = (int16_t)(high << 8 | Wire.read());
    }
    sensors->accel_x = values[0] * (JP_Q24_ONE / 8192); // g
    sensors->accel_z = values[2] * (JP_Q24_ONE / 8192);
    sensors->pitch_rate = (jp_q24)((int64_t)values[5] * JP_Q24_ONE * 500 / (360 * 32768)); // turns a second
    sensors->yaw_rate = (jp_q24)((int64_t)values[6] * JP_Q24_ONE * 500 / (360 * 32768));
    return true;
}

// ---- What the library asks of a board ----

static jp_q16 scaled(int counts, float unit)
{
    return (jp_q16)((float)counts * unit * JP_Q16_ONE);
}

static enum jp_status board_read(void *, struct jp_sensors *sensors)
{
    sensors->encoder_left = left.count;
    sensors->encoder_right = right.count;
    sensors->current_left = scaled(analogRead(CURRENT_LEFT) - ADC_MIDDLE, AMPERES_A_COUNT);
    sensors->current_right = scaled(analogRead(CURRENT_RIGHT) - ADC_MIDDLE, AMPERES_A_COUNT);
    sensors->bus_voltage = scaled(analogRead(BUS_VOLTAGE), VOLTS_A_COUNT);
    return read_imu(sensors) ? JP_OK : JP_ERR_HARDWARE;
}

static void drive_bridge(uint8_t forward, uint8_t backward, jp_q31 duty)
{
    const int32_t level = duty >> (31 - PWM_BITS);

    analogWrite(forward, level > 0 ? (int)level : 0);
    analogWrite(backward, level < 0 ? (int)-level : 0);
}

static enum jp_status board_write(void *, const struct jp_actuation *actuation)
{
    drive_bridge(LEFT_FORWARD, LEFT_BACKWARD, actuation->enabled ? actuation->duty_left : 0);
    drive_bridge(RIGHT_FORWARD, RIGHT_BACKWARD, actuation->enabled ? actuation->duty_right : 0);
    return JP_OK;
}

// ---- The robot ----

static const struct jp_hal hal = {NULL, board_read, board_write};
static struct jp_robot robot;
static struct jp_pilot pilot;
static bool is_ready = false;
static bool is_asked = false; // what the route takes, which the pilot has not said yet

static void tell_forecast()
{
    struct jp_forecast forecast;

    if (is_asked && jp_pilot_answer(&pilot, &forecast) == JP_OK) {
        Serial.print("forecast J: ");
        Serial.println((double)forecast.energy / JP_Q16_ONE);
        is_asked = false;
    }
}

// Out and back, again and again, while it is on and stands.
static void command()
{
    static const struct jp_point out[] = {{JP_Q16(1), JP_Q16(0)}};
    static const struct jp_point home[] = {{JP_Q16(0), JP_Q16(0)}};
    static bool goes_out = true;
    const struct jp_pilot_route route = {.targets = goes_out ? out : home, .count = 1, .end = JP_PILOT_STAND};

    if (digitalRead(ON_SWITCH) != LOW) {
        jp_robot_disable(&robot);
        return;
    }
    (void)jp_robot_enable(&robot); // refused unless idle, upright and with good sensors
    if (pilot.phase == JP_PILOT_RESTING && jp_pilot_follow(&pilot, &route) == JP_OK) {
        goes_out = !goes_out;
        is_asked = true;
    }
}

void setup()
{
    const char *field = "";

    Serial.begin(115200);
    pinMode(ON_SWITCH, INPUT_PULLUP);
    analogReadResolution(12);
    begin_encoder(left, step_left);
    begin_encoder(right, step_right);
    is_ready = begin_imu() && jp_robot_init(&robot, &tables, &field) == JP_OK &&
               jp_pilot_init(&pilot, &driving, &robot, &field) == JP_OK;
    if (!is_ready) {
        Serial.print("not ready: the inertial sensor does not answer, or out of range: ");
        Serial.println(field);
    }
}

// Ticks at the robot's rate; what is left of the time is the pilot's.
void loop()
{
    static enum jp_status written = JP_OK;
    static uint32_t next = micros();
    static uint32_t ticks = 0;

    if (!is_ready || (int32_t)(micros() - next) < 0) {
        return;
    }
    next += 1000000U / tables.estimator.tick_rate;
    jp_hal_tick(&hal, &robot, &written);
    if (ticks++ % 10 == 0) { // 100 a second
        command();
        (void)jp_pilot_work(&pilot);
        tell_forecast();
    }
}
