/** src/base/compiler.h in C11 alone, for the analyser and one thread. */
#ifndef JOULEPATH_BASE_COMPILER_H
#define JOULEPATH_BASE_COMPILER_H

#define JP_INLINE_FOR_SPEED inline
#define JP_OWN_FRAME

/*@ requires not_zero: word != 0; */
static inline unsigned leading_zeros_of(unsigned word)
{
    unsigned zeros = 0U;

    /*@ loop unroll 32; */
    while (word < 0x80000000U) {
        word <<= 1;
        zeros++;
    }
    return zeros;
}

/*@ requires not_zero: word != 0; */
static inline unsigned trailing_zeros_of(unsigned word)
{
    unsigned zeros = 0U;

    /*@ loop unroll 32; */
    while (zeros < 31U && (word >> zeros & 1U) == 0U) {
        zeros++;
    }
    return zeros;
}

#define JP_LEADING_ZEROS(word)  leading_zeros_of(word)
#define JP_TRAILING_ZEROS(word) trailing_zeros_of(word)

#define JP_LOAD(pointer)                 (*(pointer))
#define JP_LOAD_ACQUIRE(pointer)         (*(pointer))
#define JP_STORE(pointer, value)         ((void)(*(pointer) = (value)))
#define JP_STORE_RELEASE(pointer, value) ((void)(*(pointer) = (value)))
#define JP_FENCE_ACQUIRE()               ((void)0)
#define JP_FENCE_RELEASE()               ((void)0)

#endif
