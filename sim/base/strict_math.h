/** Elementary functions with the same bits on every machine: C libraries differ in the last one, by which simulated
 * drives would differ between machines, and between the programs and the page in the browser. They are built of IEEE
 * 754 operations that are exact or correctly rounded: +, −, ×, ÷, sqrt, rint, ldexp. Not for microcontrollers.
 *
 * Each error is at most that many units in the last place; tests/property/prop_strict_math.c measures it. NaN gives
 * NaN.
 */
#ifndef JOULEPATH_SIM_BASE_STRICT_MATH_H
#define JOULEPATH_SIM_BASE_STRICT_MATH_H

#include <math.h>

/** x in rad, |x| < 10⁶: 1, or 2⁻⁹⁰ where the sine is smaller. Beyond, accuracy is lost. */
double strict_sin(double x);

/** As strict_sin: 1. */
double strict_cos(double x);

struct strict_turn {
    double sine;
    double cosine;
};

/** The bits of both strict_sin and strict_cos, for little more than the time of one. */
struct strict_turn strict_sin_cos(double x);

/** As strict_sin: 3. */
double strict_tan(double x);

/** −π/2…π/2 rad; NaN for |x| > 1: 3. */
double strict_asin(double x);

/** −π/2…π/2 rad: 2. */
double strict_atan(double x);

/** −π…π rad, of finite x and y; the signs of zeros count as in C: 2. */
double strict_atan2(double y, double x);

/** 0 below about −745, infinite above about 709.8: 1, or 2⁻¹⁰⁷⁴ where the result is subnormal. */
double strict_exp(double x);

/** Natural; −infinity for 0, NaN below: 1. */
double strict_log(double x);

/** 4. */
double strict_tanh(double x);

/** √(x² + y²), where the squares neither overflow nor underflow: 2. */
static inline double strict_hypot(double x, double y)
{
    return sqrt(x * x + y * y);
}

#endif
