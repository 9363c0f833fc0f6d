/**
 * What the page calls of the module that this is compiled to, and how a scene shows itself: as a row of numbers whose
 * names come from the same list, so that nothing is named twice.
 */
#ifndef JOULEPATH_SIM_PAGE_PAGE_EXPORT_H
#define JOULEPATH_SIM_PAGE_PAGE_EXPORT_H

#ifdef __wasm__
#define PAGE_EXPORT(name) __attribute__((export_name(#name)))
#else
#define PAGE_EXPORT(name) __attribute__((visibility("default")))
#endif

/* Of a list VIEW(X) that says X(name) for each number of a view. */
#define PAGE_INDEX(name) VIEW_##name,
#define PAGE_NAME(name)  #name " "

#endif
