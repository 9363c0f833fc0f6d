/** One-line errors of the host programs. */
#ifndef JOULEPATH_SIM_BASE_ERROR_H
#define JOULEPATH_SIM_BASE_ERROR_H

/** Exit code of a program that got wrong input. */
#define ERROR_EXIT 2

/** Prints one line on stderr: file, what, why, what to do. Control characters become '?', so that it stays one line. */
void error_line(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
