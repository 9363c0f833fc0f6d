/** What gcc and clang offer beyond C11, so that another compiler needs one header. Private to the core. */
#ifndef JOULEPATH_BASE_COMPILER_H
#define JOULEPATH_BASE_COMPILER_H

/** For functions with several callers: copied to each for speed; in a build for size the callers share one. */
#if defined(__OPTIMIZE_SIZE__)
#define JP_INLINE_FOR_SPEED __attribute__((noinline))
#else
#define JP_INLINE_FOR_SPEED inline
#endif

/** Its locals are not on the stack of its caller while that calls others. */
#define JP_OWN_FRAME __attribute__((noinline))

/** Of 32 bits that are not all 0. */
#define JP_LEADING_ZEROS(word)  ((unsigned)__builtin_clz(word))
#define JP_TRAILING_ZEROS(word) ((unsigned)__builtin_ctz(word))

/** √x of a float that is not negative; one instruction where there is hardware for it. */
#define JP_SQUARE_ROOT(x) __builtin_sqrtf(x)

/** One word that the tick and the background share. What was written before the release is there after the acquire. */
#define JP_LOAD(pointer)                 __atomic_load_n(pointer, __ATOMIC_RELAXED)
#define JP_LOAD_ACQUIRE(pointer)         __atomic_load_n(pointer, __ATOMIC_ACQUIRE)
#define JP_STORE(pointer, value)         __atomic_store_n(pointer, value, __ATOMIC_RELAXED)
#define JP_STORE_RELEASE(pointer, value) __atomic_store_n(pointer, value, __ATOMIC_RELEASE)
#define JP_FENCE_ACQUIRE()               __atomic_thread_fence(__ATOMIC_ACQUIRE)
#define JP_FENCE_RELEASE()               __atomic_thread_fence(__ATOMIC_RELEASE)

#endif
