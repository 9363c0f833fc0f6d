/** The compiler's atomic accesses in C11 alone, for the analyser and one thread. */
#ifndef JOULEPATH_TESTS_PROOF_ATOMICS_H
#define JOULEPATH_TESTS_PROOF_ATOMICS_H

#define __atomic_load_n(pointer, order)         (*(pointer))
#define __atomic_store_n(pointer, value, order) ((void)(*(pointer) = (value)))

#endif
