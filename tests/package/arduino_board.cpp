// A board on which the example sketch runs: an upright robot that stands still, and what the sketch does with it.
#include <cstdio>
#include <cstring>

#include "Arduino.h"
#include "Wire.h"

void setup();
void loop();

HardwareSerial Serial;
TwoWire Wire;

namespace
{
enum { IMU_DATA = 0x3B, ON_SWITCH = 10, SECOND = 1000000, TICK = 1000 };

uint32_t now;
uint8_t imu_address, imu_byte;
int duties[32];
bool imu_answers = true, is_on = false, was_driven = false;
char said[4096];

void say(const char *text)
{
    std::strncat(said, text, sizeof said - std::strlen(said) - 1);
}

bool is_driven()
{
    for (int duty : duties) {
        if (duty != 0) {
            return true;
        }
    }
    return false;
}

void run(uint32_t seconds)
{
    for (uint32_t end = now + seconds * SECOND; now != end; now += TICK / 4) {
        loop();
    }
}
} // namespace

extern "C" {
uint32_t micros(void) { return now; }
void pinMode(uint8_t, int) {}
int digitalRead(uint8_t pin) { return pin == ON_SWITCH && is_on ? LOW : HIGH; }
int analogRead(uint8_t pin) { return pin == A2 ? 24 * 4096 / 36 : 2048; }
void analogReadResolution(int) {}
void analogWrite(uint8_t pin, int value)
{
    duties[pin] = value;
    was_driven = was_driven || value != 0;
}
int digitalPinToInterrupt(int pin) { return pin; }
void attachInterrupt(int, void (*)(void), int) {}
}

void HardwareSerial::begin(unsigned long) {}
size_t HardwareSerial::print(const char *text) { say(text); return 0; }
size_t HardwareSerial::println(const char *text) { say(text); say("\n"); return 0; }
size_t HardwareSerial::println(double) { say("number\n"); return 0; }

// 1 g along z, no turning, and the noise without which a sensor is taken for frozen.
void TwoWire::begin() {}
void TwoWire::setClock(uint32_t) {}
void TwoWire::beginTransmission(uint8_t) { imu_byte = 0; }
uint8_t TwoWire::endTransmission(bool) { return imu_answers ? 0 : 2; }
uint8_t TwoWire::requestFrom(uint8_t, uint8_t count) { return imu_answers ? count : 0; }
size_t TwoWire::write(uint8_t value) { imu_address = value; return 1; }
int TwoWire::read()
{
    static uint32_t noise = 1;
    const uint8_t byte = imu_byte++;

    noise = noise * 1664525U + 1013904223U;
    if (byte % 2 != 0) {
        return (int)(noise >> 28);
    }
    return imu_address == IMU_DATA && byte == 4 ? 8192 >> 8 : 0;
}

#define CHECK(condition) \
    if (!(condition)) { \
        std::fprintf(stderr, "arduino_board.cpp:%d: %s\n", __LINE__, #condition); \
        return 1; \
    }

int main()
{
    imu_answers = false;
    setup();
    run(1);
    CHECK(std::strstr(said, "not ready") != nullptr && !is_driven());
    imu_answers = true;
    said[0] = '\0';
    setup();
    CHECK(said[0] == '\0');
    run(2);
    CHECK(!is_driven());
    CHECK(!was_driven);
    is_on = true;
    run(3); // it cannot move here, which it notices
    CHECK(was_driven && std::strstr(said, "forecast J: number") != nullptr);
    is_on = false;
    run(1);
    CHECK(!is_driven());
    was_driven = false;
    is_on = true;
    run(3);
    CHECK(was_driven);
    imu_answers = false;
    run(1);
    CHECK(!is_driven());
    return 0;
}
