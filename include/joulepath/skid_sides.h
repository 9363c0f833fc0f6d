/** The two sides that steer a skid-steered or differential-drive robot. */
#ifndef JOULEPATH_SKID_SIDES_H
#define JOULEPATH_SKID_SIDES_H

/** Index of what each side has. */
enum { JP_SKID_LEFT, JP_SKID_RIGHT };

#define JP_SKID_SIDES 2

#endif
