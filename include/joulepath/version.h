/** Version of the library, by the rules of semantic versioning. */
#ifndef JOULEPATH_VERSION_H
#define JOULEPATH_VERSION_H

#define JP_VERSION_MAJOR 0
#define JP_VERSION_MINOR 4
#define JP_VERSION_PATCH 0

#endif
