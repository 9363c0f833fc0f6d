/** A mark for functions that the compiler copies to each use although one copy would be smaller. Private to the core.
 */
#ifndef JOULEPATH_SHARED_H
#define JOULEPATH_SHARED_H

/** In place of `inline`: in a build for size its callers share one copy. */
#if defined(__OPTIMIZE_SIZE__)
#define JP_SHARED __attribute__((noinline))
#else
#define JP_SHARED inline
#endif

#endif
