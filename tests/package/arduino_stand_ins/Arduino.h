/* The least of Arduino's core that the example sketch uses: names and types as ArduinoCore-API declares them. */
#pragma once
#include <stddef.h>
#include <stdint.h>

enum { LOW = 0, HIGH = 1, CHANGE = 1, INPUT_PULLUP = 2, A0 = 26, A1 = 27, A2 = 28 };

extern "C" {
uint32_t micros(void);
void pinMode(uint8_t pin, int mode);
int digitalRead(uint8_t pin);
int analogRead(uint8_t pin);
void analogReadResolution(int bits);
void analogWrite(uint8_t pin, int value);
int digitalPinToInterrupt(int pin);
void attachInterrupt(int interrupt, void (*handler)(void), int mode);
}

struct HardwareSerial {
    void begin(unsigned long baud);
    size_t print(const char *text);
    size_t println(const char *text);
    size_t println(double number);
};
extern HardwareSerial Serial;
