/* Arduino's I2C. */
#pragma once
#include <stddef.h>
#include <stdint.h>

struct TwoWire {
    void begin();
    void setClock(uint32_t hertz);
    void beginTransmission(uint8_t address);
    uint8_t endTransmission(bool stop = true);
    uint8_t requestFrom(uint8_t address, uint8_t count);
    size_t write(uint8_t value);
    int read();
};
extern TwoWire Wire;
