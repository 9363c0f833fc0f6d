/** The one-line errors of the simulator, kept for Python's exceptions. */
#ifndef JOULEPATH_PYTHON_ERRORS_H
#define JOULEPATH_PYTHON_ERRORS_H

/** The last line of this thread; empty: none since errors_forget(). */
const char *errors_last(void);
void errors_forget(void);

#endif
